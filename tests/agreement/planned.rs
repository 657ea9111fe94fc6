//! How many samples, and what they can show.

use super::ROUNDS;
use super::case::Case;
use etalon::inside::compare::{Channel, Side, mean_over};
use etalon::inside::film::names;
use etalon::inside::stats::estimate::POWER;
use etalon::inside::stats::{Estimate, student};

/// Tolerance of image means, relative, where samples and reference can show that much.
pub const DELTA: f64 = 1e-3;
/// Largest relative standard error wanted of the difference of image means.
pub const SHARP: f64 = 5e-4;
/// Share of the error wanted that a pilot must promise: rare paths may have been missed by it.
const TRUSTED: f64 = 0.8;
/// Probability with which all of a case's questions are answered in the first round, if everything
/// is right and their tolerances can be chosen.
const FIRST_ROUND: f64 = 0.99;

/// Camera paths of a first round, at most.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Paths {
    /// To show that image means are within [`DELTA`].
    pub to_show: u64,
    /// To bring the standard error of their differences down to [`SHARP`].
    pub to_sharpen: u64,
}

/// A number of the picture: the mean of a channel over a region, or all pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    pub channel: String,
    /// Index of the region, or the whole picture.
    pub region: Option<usize>,
    /// Largest difference to be called none, relative to the reference.
    pub tolerance: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Camera paths per pixel of the first round.
    pub spp: u32,
    pub questions: Vec<Question>,
}

impl Question {
    /// The picture's mean minus the reference's, and the reference's; `None` where a variance is
    /// unknown or the reference is black.
    pub fn ask(&self, case: &Case, picture: &Side, reference: &Side) -> Option<(Estimate, f64)> {
        let pixels = self
            .region
            .map(|index| case.regions[index].pixels.as_slice());
        let mean = |side: &Side| {
            let channel: &Channel = side.channel(&self.channel)?;
            mean_over(channel, side.freedom?, pixels)
        };
        let (own, others) = (mean(picture)?, mean(reference)?);
        (others.value > 0.0).then(|| (own.minus(&others), others.value))
    }

    /// The channel and the place.
    pub fn name(&self, case: &Case) -> String {
        let whole = "whole picture";
        let place = self.region.map_or(whole, |i| case.regions[i].name.as_str());
        format!("{}, {place}", self.channel)
    }
}

/// Plans a case from a pilot of `pilot_spp` paths per pixel, which is not used again. At most
/// as many camera paths are spent on the first round as `most` says, fewer where those show all image
/// means of R, G, B to be within [`DELTA`] or are as sharp as is wanted; every other tolerance is what these samples allow at `level`.
pub fn plan(
    case: &Case,
    (pilot, pilot_spp): (&Side, u32),
    reference: &Side,
    most: Paths,
    level: f64,
) -> Planned {
    let questions = questions(case, pilot, reference);
    let missed = (1.0 - FIRST_ROUND) / questions.len() as f64;
    // The squared error of a mean falls at least as 1/N.
    let standard_error = |question: &Question, spp: u32| {
        let (difference, mean) = question.ask(case, pilot, reference)?;
        let (twice, _) = question.ask(case, reference, reference)?;
        let fixed = twice.standard_error * twice.standard_error / 2.0;
        let own = difference.standard_error * difference.standard_error - fixed;
        let own = own.max(0.0) * f64::from(pilot_spp) / f64::from(spp);
        Some(((own + fixed).sqrt() / mean, difference.freedom))
    };
    let error = |question: &Question, spp: u32, missed: f64| {
        let (error, freedom) = standard_error(question, spp)?;
        let needed = student::critical(level / f64::from(ROUNDS), freedom)
            + student::critical(missed, freedom);
        Some(needed * error)
    };
    // A question whose tolerance is given may need a second round with the usual probability.
    let shown = |question: &Question, spp: u32| {
        error(question, spp, 1.0 - POWER).is_none_or(|error| error <= DELTA)
    };
    let pixels = reference.width as u64 * reference.height as u64;
    let mut spp = pilot_spp;
    let is_mean = |q: &&Question| q.region.is_none() && names::RGB.contains(&q.channel.as_str());
    let sharp = |question: &Question, spp: u32| {
        standard_error(question, spp).is_none_or(|(error, _)| error <= TRUSTED * SHARP)
    };
    loop {
        let next = 2 * u64::from(spp) * pixels;
        let means = || questions.iter().filter(is_mean);
        let to_show = next <= most.to_show && !means().all(|q| shown(q, spp));
        let to_sharpen = next <= most.to_sharpen && !means().all(|q| sharp(q, spp));
        if !(to_show || to_sharpen) {
            break;
        }
        spp *= 2;
    }
    let judged = questions.into_iter().filter_map(|question| {
        let tolerance = if shown(&question, spp) {
            DELTA
        } else {
            error(&question, spp, missed)?
        };
        Some(Question {
            tolerance,
            ..question
        })
    });
    Planned {
        spp,
        questions: judged.collect(),
    }
}

/// All questions that both sides can answer.
fn questions(case: &Case, picture: &Side, reference: &Side) -> Vec<Question> {
    let mut questions = Vec::new();
    for channel in &reference.channels {
        let is_colour = names::RGB.contains(&channel.name.as_str());
        let regions = (0..case.regions.len()).filter(|_| is_colour).map(Some);
        for region in std::iter::once(None).chain(regions) {
            let question = Question {
                channel: channel.name.clone(),
                region,
                tolerance: DELTA,
            };
            if question.ask(case, picture, reference).is_some() {
                questions.push(question);
            }
        }
    }
    questions
}
