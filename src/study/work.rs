//! The points of a study, ready to be rendered.

use std::path::PathBuf;

use super::StudyError;
use super::budget::{self, Cost, Estimated};
use super::choice::{self, Found};
use super::clock::Clock;
use super::grid::{Grid, Point};
use super::journal::Journal;
use super::measure::measure;
use super::own::{self, Own};
use super::reference::Reference;
use super::run::Request;
use super::subject::Ready;
use crate::chart::Key;
use crate::chart::Row;
use crate::film::{Picture, exr, names};
use crate::render::Rendered;

/// Share of the budget that the pilot takes, and the least and the most that it takes of a point,
/// seconds.
const PILOT_SHARE: f64 = 0.02;
const PILOT: [f64; 2] = [0.02, 0.1];

/// What renders cost, by choices other than the number of samples.
#[derive(Debug, Clone, Default)]
pub struct Timed {
    points: Vec<(Choices, Cost)>,
    reference: Option<Cost>,
}

/// Choices other than the number of samples.
type Choices = Vec<(Key, String)>;

/// Everything needed to render a grid.
pub struct Work {
    pub grid: Grid,
    pub points: Vec<Point>,
    ready: Vec<Ready>,
    /// Samples a pixel of each.
    pub samples: Vec<u32>,
    /// The scene as the study's own reference renders it.
    own: Option<Ready>,
    directory: PathBuf,
    replicates: u32,
    set: String,
}

impl Work {
    /// Loads and plans all points.
    ///
    /// # Errors
    /// [`StudyError::Subject`] where one is not valid.
    pub fn new(request: &Request, grid: Grid, found: &Found) -> Result<Self, StudyError> {
        let points = grid.points();
        let ready: Vec<Ready> = points
            .iter()
            .map(|point| request.subject.at(point))
            .collect::<Result<_, _>>()?;
        let samples: Vec<u32> = ready.iter().map(|r| r.scene.image.spp).collect();
        let most = samples.iter().copied().max().unwrap_or(1);
        let own = match found.reference {
            Some(_) => None,
            None => Some(choice::own(&request.subject, &ready, most)?),
        };
        let set = request.subject.overrides.set.iter();
        Ok(Self {
            grid,
            points,
            samples,
            own,
            directory: request.directory.clone(),
            replicates: request.replicates,
            set: set
                .map(|(key, value)| format!("{key}={}", value.replace(' ', "")))
                .collect::<Vec<_>>()
                .join(" "),
            ready,
        })
    }

    /// The point that needs the most memory.
    pub fn largest(&self) -> &Ready {
        let sums = |r: &&Ready| r.plan.choices.replicates.count(r.scene.image.spp);
        let largest = self.ready.iter().max_by_key(sums);
        // A grid has at least one point.
        largest.unwrap_or(&self.ready[0])
    }

    /// Times renders; points that differ only in their samples are timed once.
    pub fn pilot(&mut self, budget: f64) -> Timed {
        // The last of a curve's points stands for it: its plan has the most samples.
        let mut kinds: Vec<(Choices, usize)> = Vec::new();
        for (i, point) in self.points.iter().enumerate() {
            let choices = without_samples(point);
            match kinds.iter_mut().find(|(other, _)| *other == choices) {
                Some((_, at)) => *at = i,
                None => kinds.push((choices, i)),
            }
        }
        let each = budget * PILOT_SHARE / (kinds.len() + 1) as f64;
        let each = each.clamp(PILOT[0], PILOT[1]);
        let time = |(choices, at)| (choices, budget::pilot(&mut self.ready[at], each));
        Timed {
            points: kinds.into_iter().map(time).collect(),
            reference: self.own.as_mut().map(|own| budget::pilot(own, each)),
        }
    }

    /// What the study costs by these times.
    pub fn cost(&self, timed: &Timed) -> Estimated {
        let cost = |point: &Point| {
            let choices = without_samples(point);
            let found = timed.points.iter().find(|(other, _)| *other == choices);
            found.map_or_else(Cost::default, |(_, cost)| *cost)
        };
        Estimated {
            points: self.points.iter().map(cost).collect(),
            reference: timed.reference,
            replicates: self.replicates,
        }
    }

    /// Seconds of all that is not in the table yet.
    pub fn remaining(&self, cost: &Estimated, journal: &Journal) -> f64 {
        let missing = |i: usize| {
            let values = self.ready[i].values(&self.points[i]);
            let has = |replicate| journal.has(&(values.clone(), replicate));
            (0..self.replicates).filter(|r| !has(*r)).count() as f64
        };
        let points: f64 = (0..self.points.len())
            .map(|i| missing(i) * seconds_of(cost.points[i], self.samples[i]))
            .sum();
        let written = self.own_path().exists();
        let own = self.own.as_ref().zip(cost.reference);
        let reference = own.filter(|_| !written).map_or(0.0, |(own, cost)| {
            f64::from(own::FIRST) * seconds_of(cost, own.scene.image.spp)
        });
        points + reference
    }

    fn own_path(&self) -> PathBuf {
        self.directory.join("reference.exr")
    }

    /// The reference that was found, or the study's own, with where it comes from in words; `None`
    /// when stopped on the way.
    ///
    /// # Errors
    /// [`StudyError`] where the study's own cannot be written or read.
    pub fn reference(
        &mut self,
        found: Found,
        clock: &mut Clock<'_>,
    ) -> Result<Option<(Reference, String)>, StudyError> {
        let Some(mut own) = self.own.take() else {
            let about = found.about.clone();
            return Ok(found.reference.map(|reference| (reference, about)));
        };
        let path = self.own_path();
        let size = own.scene.image.size.map(|n| n as usize);
        if !path.exists() {
            let mut sums = Own::new(size[0] * size[1]);
            let mut target = own::FIRST;
            while sums.count() < target {
                let what = format!("reference, render {} of {target}", sums.count() + 1);
                let whole = clock.time(&what, |watched| sums.add(&mut own, watched));
                if !whole {
                    return Ok(None);
                }
                if sums.count() == target && target == own::FIRST {
                    let reference = sums.reference(size);
                    let Some(best) = self.best(&reference, clock) else {
                        return Ok(None);
                    };
                    // A reference that would need far more than planned is said to be short of it.
                    let most = 4 * own::FIRST;
                    target = own::needed(target, reference.mse(), best).min(most);
                }
            }
            own::write(&path, &sums.reference(size), &sums, &own, &self.set)?;
        }
        let reference = own::read(&path, size)?;
        let about = format!(
            "a reference rendered by the study itself with its own seeds ({}), {} samples a pixel a render",
            own.name, own.scene.image.spp
        );
        Ok(Some((reference, about)))
    }

    /// The least mean squared error of the last points of the curves, from one render each.
    fn best(&mut self, reference: &Reference, clock: &mut Clock<'_>) -> Option<f64> {
        let last = self.grid.abscissa.values.len();
        let mut best = f64::INFINITY;
        for i in (last - 1..self.ready.len()).step_by(last) {
            let ready = &mut self.ready[i];
            let seed = super::seeds::seed(ready.scene.image.seed, "probe", i as u32);
            let spp = ready.scene.image.spp;
            let what = format!("probe of {}", ready.name);
            let rendered = clock.time(&what, |w| ready.render_for(seed, spp, None, w));
            if rendered.samples < spp {
                return None;
            }
            best = best.min(measure(&rendered.rgb(), reference).mse);
        }
        Some(best)
    }

    /// Renders what is not in the table yet, replicate by replicate, so that what slows the
    /// machine down for a while is spread over all points; whether all was done.
    ///
    /// # Errors
    /// [`StudyError`] where a result cannot be written.
    pub fn go(
        &mut self,
        request: &Request,
        reference: &Reference,
        cost: &Estimated,
        journal: &mut Journal,
        clock: &mut Clock<'_>,
    ) -> Result<bool, StudyError> {
        let last = self.grid.abscissa.values.len();
        for replicate in 0..self.replicates {
            for i in 0..self.points.len() {
                let values = self.ready[i].values(&self.points[i]);
                if journal.has(&(values, replicate)) {
                    continue;
                }
                let ready = &mut self.ready[i];
                let what = format!(
                    "{}, render {} of {}",
                    ready.name,
                    replicate + 1,
                    self.replicates
                );
                clock.expect(seconds_of(cost.points[i], self.samples[i]));
                let rendered = clock.time(&what, |watched| ready.render(replicate, watched));
                if rendered.samples < self.samples[i] {
                    return Ok(false);
                }
                let row = self.row(request, i, replicate, &rendered, reference);
                if replicate == 0 && i % last == last - 1 {
                    self.keep(i, &rendered)?;
                }
                journal.add(row)?;
            }
        }
        Ok(true)
    }

    fn row(
        &self,
        request: &Request,
        i: usize,
        replicate: u32,
        rendered: &Rendered,
        reference: &Reference,
    ) -> Row {
        let (ready, point) = (&self.ready[i], &self.points[i]);
        let measured = measure(&rendered.rgb(), reference);
        Row {
            renderer: "etalon".to_owned(),
            scene: choice::stem(&request.subject.path),
            panel: ready.scene.panel.clone().unwrap_or_default(),
            settings: self.set.clone(),
            values: ready.values(point),
            replicate,
            seed: ready.seed(replicate),
            threads: request.threads,
            seconds: rendered.seconds,
            samples: u64::from(rendered.samples) * rendered.window.pixels() as u64,
            rmse: measured.rmse(),
            relmse: measured.relmse,
            bias: measured.bias.value,
            bias_standard_error: measured.bias.standard_error,
            estimated_rmse: measured.estimated_mse.sqrt(),
            reference: reference.name.clone(),
            reference_rmse: reference.rmse(),
            reference_relmse: reference.relmse(),
        }
    }

    /// Keeps the first render of a curve's last point, for the report.
    fn keep(&self, i: usize, rendered: &Rendered) -> Result<(), StudyError> {
        let window = rendered.window;
        let mut picture = Picture::new(window.width() as usize, window.height() as usize);
        let estimates = rendered.rgb();
        let colours: Vec<_> = estimates.iter().map(|e| e.mean.map(|v| v as f32)).collect();
        picture.push_triple(names::BEAUTY, names::RGB, &colours);
        let path = self.directory.join(picture_name(self.points[i].curve));
        Ok(exr::write(&path, &picture)?)
    }
}

fn without_samples(point: &Point) -> Choices {
    let choices = point.choices.iter();
    choices
        .filter(|(key, _)| *key != Key::Spp)
        .cloned()
        .collect()
}

/// The file that keeps a curve's picture.
pub fn picture_name(curve: usize) -> String {
    format!("curve-{}.exr", curve + 1)
}

fn seconds_of(cost: Cost, samples: u32) -> f64 {
    cost.render + cost.sample * f64::from(samples)
}
