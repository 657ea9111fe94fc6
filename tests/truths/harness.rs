//! Measuring numbers in pictures, and judging them.

use etalon::inside::render::session::{Request, Unwatched, render as run};
use etalon::inside::stats::student;
use etalon::{Estimate, Plan, Rendered, Scene, Window};
use rayon::prelude::*;

use super::scenes::Text;

/// Largest standard error that a number may be judged with, relative to the truth.
pub const LARGEST_ERROR: f64 = 1e-3;
/// What the sample count is chosen for.
const WANTED_ERROR: f64 = 5e-4;
/// Probability of rejecting any number although all are right.
const FALSE_ALARM: f64 = 1e-3;
/// Roundings of single precision, 2⁻²⁴ each, that a number may be off by besides its noise: about
/// four a segment over a dozen segments, were they all to go the same way.
const ROUNDING: f64 = 48.0 / 16_777_216.0;
/// Samples a pixel of the first pilot; a second one takes 16 times as many.
const PILOT: u32 = 64;
/// The squared error of low-discrepancy points falls a little faster than 1/N.
const SLOPE: f64 = 1.2;
/// Error over the wanted one from which a measurement is repeated, and the last round of all.
const SHARP: f64 = 1.5;
const LAST_ROUND: u64 = 5;
/// Most samples a pixel to begin with, at the usual sharpness.
const MOST: f64 = 131_072.0;

/// What each number is shown to be within by the long run, relative to the truth.
pub const CLOSE: f64 = 2e-4;
/// Confidence intervals of the long run miss the truth with this probability.
const MISSED: f64 = 0.05;
/// Rounds of it, each with fresh samples and half the error of the one before.
const ROUNDS: u32 = 3;
/// Samples from which pixels have more than two replicates, which then cost nothing: an interval is
/// wide where its error is hardly known.
const PLENTY: u32 = 1 << 16;

/// A number to be measured: (mean of a channel + offset) × factor.
#[derive(Debug, Clone)]
pub struct Case {
    pub name: String,
    pub text: Text,
    pub truth: f64,
    window: Option<Window>,
    channel: usize,
    offset: f64,
    factor: f64,
    /// Known relative error of the set-up, such as the size of the spot that is looked at.
    systematic: f64,
    /// Relative standard error that the sample count is chosen for.
    wanted: f64,
}

impl Case {
    /// The mean luminance of the picture, which is its radiance where nothing depends on the
    /// wavelength.
    pub fn new(name: impl Into<String>, text: Text, truth: f64) -> Self {
        Self {
            name: name.into(),
            text,
            truth,
            window: None,
            channel: 1,
            offset: 0.0,
            factor: 1.0,
            systematic: 0.0,
            wanted: WANTED_ERROR,
        }
    }

    pub fn window(mut self, window: Window) -> Self {
        self.window = Some(window);
        self
    }

    /// Measures X, Y or Z.
    pub fn channel(mut self, channel: usize) -> Self {
        self.channel = channel;
        self
    }

    /// Measures (mean + offset) × factor.
    pub fn mapped(mut self, offset: f64, factor: f64) -> Self {
        (self.offset, self.factor) = (offset, factor);
        self
    }

    pub fn wanted(mut self, relative: f64) -> Self {
        self.wanted = relative;
        self
    }

    pub fn systematic(mut self, relative: f64) -> Self {
        self.systematic = relative;
        self
    }
}

/// What is measured, from so many camera samples.
#[derive(Debug, Clone, Copy)]
pub struct Measurement {
    pub estimate: Estimate,
    pub samples: u64,
}

impl Case {
    /// What rounding and set-up explain of a difference from a truth.
    fn explained(&self, truth: f64) -> f64 {
        (ROUNDING + self.systematic) * truth.abs()
    }

    /// Whether an estimate's confidence interval lies within [`CLOSE`] of the truth, less what is
    /// explained.
    fn is_close(&self, estimate: &Estimate) -> bool {
        let distance = (estimate.value - self.truth).abs() - self.explained(self.truth);
        let margin = student::critical(MISSED, estimate.freedom) * estimate.standard_error;
        distance.max(0.0) + margin <= CLOSE * self.truth.abs()
    }
}

/// Renders a scene file; no sample may be anything but a number.
pub fn render(text: &Text, spp: u32, seed: u64, window: Option<Window>) -> Rendered {
    let file = text.file(spp, seed);
    let scene = Scene::parse(&file).unwrap_or_else(|error| panic!("{error}\n{file}"));
    let plan = Plan::new(&scene, false).unwrap();
    let request = Request {
        window: window.unwrap_or(Window::whole(scene.image.size)),
        ..Request::whole(scene.image.size, spp)
    };
    let rendered = run(&plan, &request, &mut Unwatched);
    assert_eq!(rendered.not_a_number, 0, "{file}");
    rendered
}

/// Mean of a channel over some pixels, with its standard error from their replicates: pixels are
/// scrambled independently.
pub fn mean(estimates: &[[f64; 2]], spp: u32) -> Estimate {
    let values: Vec<f64> = estimates.iter().map(|[value, _]| *value).collect();
    let variances: Vec<f64> = estimates.iter().map(|[_, error]| error * error).collect();
    Estimate::mean_of(&values, &variances, f64::from(replicates(spp) - 1))
}

pub fn replicates(spp: u32) -> u32 {
    if spp < PLENTY { 2 } else { 8 }
}

fn measure_at(case: &Case, spp: u32, seed: u64) -> Measurement {
    let rendered = render(&case.text, spp, seed, case.window);
    let estimates: Vec<[f64; 2]> = rendered
        .xyz()
        .iter()
        .map(|e| [e.mean[case.channel], e.standard_error[case.channel]])
        .collect();
    let mean = mean(&estimates, spp);
    let estimate = Estimate {
        value: (mean.value + case.offset) * case.factor,
        standard_error: mean.standard_error * case.factor.abs(),
        ..mean
    };
    let samples = u64::from(spp) * estimates.len() as u64;
    Measurement { estimate, samples }
}

/// Measures with as many samples as pilots that are thrown away ask for, so that the count
/// favours no outcome. Where few samples see the light the pilots can be wrong about the error;
/// what is still not sharp is thrown away as well and measured afresh with four times as many.
/// `wanted`: relative standard error.
fn measure(case: &Case, wanted: f64, seed: u64) -> Measurement {
    let goal = (wanted * case.truth).abs();
    let sharpness = WANTED_ERROR / wanted;
    // Points are counted in 24 bits.
    let most = (MOST * sharpness * sharpness).min(f64::from(1 << 23));
    let mut spp = PILOT;
    for pilot in 0..2 {
        let m = measure_at(case, spp, seed + pilot);
        let wanted = f64::from(spp) * (m.estimate.standard_error / goal).powf(2.0 / SLOPE);
        let last = pilot == 1 || wanted <= f64::from(16 * spp);
        spp = (wanted.clamp(f64::from(PILOT), most) as u32).next_power_of_two();
        if last {
            break;
        }
        spp = 16 * PILOT;
    }
    let mut round = 2;
    loop {
        let m = measure_at(case, spp, seed + round);
        if m.estimate.standard_error <= SHARP * goal || round == LAST_ROUND || spp > 1 << 22 {
            return m;
        }
        spp *= 4;
        round += 1;
    }
}

/// Seeds of a number by its place in the list.
const SEEDS_EACH: u64 = 1000;

/// Measures all, on the threads of the pool.
pub fn measure_all(cases: Vec<Case>) -> Vec<(Case, Measurement)> {
    cases
        .into_par_iter()
        .enumerate()
        .map(|(i, case)| {
            let m = measure(&case, case.wanted, SEEDS_EACH * i as u64);
            (case, m)
        })
        .collect()
}

/// The long run can fail: a number that is off is not close, nor one that is hardly known.
#[test]
fn what_is_off_or_hardly_known_is_not_close() {
    let text = Text::perspective(glam::DVec3::ZERO, glam::DVec3::Z, 40.0);
    let case = Case::new("one", text, 1.0);
    let is_close = |off: f64, standard_error: f64| {
        case.is_close(&Estimate {
            value: 1.0 + off,
            standard_error,
            freedom: 64.0,
        })
    };
    assert!(is_close(0.25 * CLOSE, 0.25 * CLOSE));
    assert!(!is_close(CLOSE, 0.05 * CLOSE) && !is_close(-CLOSE, 0.05 * CLOSE));
    assert!(!is_close(0.0, CLOSE));
}

/// What the long run says of a number.
pub struct Shown {
    pub measurement: Measurement,
    pub close: bool,
    pub round: u32,
}

/// Measures a number until its confidence interval lies within [`CLOSE`] of the truth, with fresh and
/// more samples in every round, and none in common with those of [`measure_all`].
pub fn show(case: &Case, place: usize) -> Shown {
    // Half of the interval, and as much again for what the estimate is off itself.
    let first = CLOSE / (2.0 * student::critical(MISSED, f64::INFINITY));
    let mut round = 0;
    loop {
        let wanted = first / f64::from(1 << round);
        round += 1;
        let seed = (u64::from(round) << 32) | (SEEDS_EACH * place as u64);
        let measurement = measure(case, wanted, seed);
        let close = case.is_close(&measurement.estimate);
        if close || round == ROUNDS {
            return Shown {
                measurement,
                close,
                round,
            };
        }
    }
}

/// The numbers that Holm's step-down procedure (Holm 1979) rejects, their truths multiplied by `bias`.
pub fn judge<'a>(
    numbers: impl Iterator<Item = (&'a Case, &'a Measurement)>,
    bias: f64,
) -> Vec<String> {
    let all: Vec<(f64, String)> = numbers
        .map(|(case, m)| {
            let (truth, estimate) = (bias * case.truth, m.estimate);
            let words = format!(
                "{}: {} ± {} instead of {truth}",
                case.name, estimate.value, estimate.standard_error
            );
            (estimate.p_value(truth, case.explained(truth)), words)
        })
        .collect();
    holm(&all)
}

/// Holm's procedure for (p-value, description).
pub fn holm(all: &[(f64, String)]) -> Vec<String> {
    let p_values: Vec<f64> = all.iter().map(|(p, _)| *p).collect();
    let rejected = crate::statistics_support::holm(&p_values, FALSE_ALARM);
    let words = |index: usize| format!("{} (p = {:.1e})", all[index].1, all[index].0);
    rejected.into_iter().map(words).collect()
}
