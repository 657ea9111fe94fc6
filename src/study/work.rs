//! The points of a study, ready to be rendered.

use std::path::PathBuf;

use super::StudyError;
use super::budget::{Cost, Costs};
use super::choice::{self, Found};
use super::clock::Clock;
use super::grid::Grid;
use super::journal::Journal;
use super::own::{self, Own};
use super::reference::Reference;
use super::run::Request;
use super::subject::Ready;
use crate::chart::{Key, Row};
use crate::film::{Picture, exr, names};
use crate::render::Rendered;
use crate::render::seeds::seed;

/// Share of the budget that the pilot takes, and the least and the most that it takes of a point,
/// seconds.
const PILOT_SHARE: f64 = 0.02;
const PILOT: [f64; 2] = [0.02, 0.1];

/// A point of the grid.
struct Point {
    ready: Ready,
    /// Its settings as they stand in the table.
    values: [String; Key::ALL.len()],
}

impl Point {
    fn samples(&self) -> u32 {
        self.ready.scene.image.spp
    }
}

/// All points of a grid, loaded and planned.
pub struct Work<'a> {
    request: &'a Request,
    pub grid: Grid,
    /// Curve by curve.
    points: Vec<Point>,
    /// Number of points of a curve.
    length: usize,
    /// The scene as the study's own reference renders it.
    own: Option<Ready>,
    /// Settings that replace the scene's at every point, `key=value`.
    set: String,
}

impl<'a> Work<'a> {
    /// Loads and plans all points.
    ///
    /// # Errors
    /// [`StudyError`] where one is not valid.
    pub fn new(request: &'a Request, grid: Grid, found: &Found) -> Result<Self, StudyError> {
        let point = |choices| {
            let ready = request.subject.at(choices)?;
            let values = ready.values(choices);
            Ok(Point { ready, values })
        };
        let points = grid.points();
        let points = points.iter().map(point);
        let points: Vec<Point> = points.collect::<Result<_, StudyError>>()?;
        let own = match found.reference {
            Some(_) => None,
            None => {
                let points = points.iter().map(|point| &point.ready);
                Some(choice::own(&request.subject, points)?)
            }
        };
        let set = request.subject.overrides.set.iter();
        let set = set.map(|(key, value)| format!("{key}={}", value.replace(' ', "")));
        Ok(Self {
            request,
            length: grid.abscissa.values.len(),
            grid,
            points,
            own,
            set: set.collect::<Vec<_>>().join(" "),
        })
    }

    /// The point that needs the most memory.
    pub fn largest(&self) -> &Ready {
        let all = self.points.iter().map(|point| &point.ready);
        let sums = |r: &&Ready| r.plan.choices.replicates.count(r.scene.image.spp);
        // A grid has at least one point.
        all.max_by_key(sums).unwrap_or(&self.points[0].ready)
    }

    /// How many neighbouring points differ only in their samples.
    fn alike(&self) -> usize {
        if self.grid.abscissa.key == Key::Spp {
            self.length
        } else {
            1
        }
    }

    /// Times renders; points that differ only in their samples are timed once.
    pub fn pilot(&mut self) -> Costs {
        let alike = self.alike();
        let each = self.request.budget * PILOT_SHARE / (self.points.len() / alike + 1) as f64;
        let each = each.clamp(PILOT[0], PILOT[1]);
        // The last of them is timed: its plan has the most samples.
        let last = self.points.iter_mut().skip(alike - 1).step_by(alike);
        Costs {
            points: last
                .map(|point| Cost::pilot(&mut point.ready, each))
                .collect(),
            reference: self.own.as_mut().map(|own| Cost::pilot(own, each)),
            replicates: self.request.replicates,
        }
    }

    /// Cost and samples a pixel of each point.
    pub fn priced(&self, costs: &Costs) -> Vec<(Cost, u32)> {
        let points = self.points.iter().enumerate();
        let priced =
            |(i, point): (usize, &Point)| (costs.points[i / self.alike()], point.samples());
        points.map(priced).collect()
    }

    /// Planned seconds of all renders that are not in the table yet.
    pub fn remaining(&self, costs: &Costs, journal: &Journal) -> f64 {
        let missing = |point: &Point| {
            let renders = 0..self.request.replicates;
            renders.filter(|r| !journal.has(&point.values, *r)).count() as f64
        };
        let points = self.points.iter().zip(self.priced(costs));
        let seconds = points.map(|(point, (cost, spp))| missing(point) * cost.seconds(spp));
        let written = self.own_path().exists();
        let own = self.own.as_ref().zip(costs.reference);
        let reference = own.filter(|_| !written).map_or(0.0, |(own, cost)| {
            f64::from(own::FIRST) * cost.seconds(own.scene.image.spp)
        });
        seconds.sum::<f64>() + reference
    }

    fn own_path(&self) -> PathBuf {
        self.request.directory.join("reference.exr")
    }

    /// The reference that was found, or the study's own, and its origin in words; `None` when
    /// stopped before it was finished.
    ///
    /// # Errors
    /// [`StudyError`] where the study's own cannot be written or read.
    pub fn reference(
        &mut self,
        found: Found,
        clock: &mut Clock<'_>,
    ) -> Result<Option<(Reference, String)>, StudyError> {
        let Some(mut own) = self.own.take() else {
            return Ok(found.reference.map(|reference| (reference, found.about)));
        };
        let path = self.own_path();
        let size = own.size();
        if !path.exists() {
            let mut sums = Own::new(size[0] * size[1]);
            let mut target = own::FIRST;
            while sums.count < target {
                let what = format!("reference, render {} of {target}", sums.count + 1);
                let whole = clock.time(&what, |watched| sums.add(&mut own, watched));
                if !whole {
                    return Ok(None);
                }
                if sums.count == target && target == own::FIRST {
                    let reference = sums.reference(size);
                    let Some(best) = self.best(&reference, clock) else {
                        return Ok(None);
                    };
                    // A reference that needs far more than planned stays short of its aim, and
                    // the results say so.
                    let most = 4 * own::FIRST;
                    target = own::needed(target, reference.mse(), best).min(most);
                }
            }
            own::write(&path, &sums.reference(size), &sums, &own, &self.set)?;
        }
        let reference = Reference {
            name: "own".to_owned(),
            ..Reference::of_picture(&path, &exr::read(&path)?, size)?
        };
        let about = format!(
            "a reference rendered by the study itself with its own seeds ({}), {} samples a pixel a render",
            own.name, own.scene.image.spp
        );
        Ok(Some((reference, about)))
    }

    /// The least mean squared error of the last points of the curves, from one render each.
    fn best(&mut self, reference: &Reference, clock: &mut Clock<'_>) -> Option<f64> {
        let mut best = f64::INFINITY;
        for i in (self.length - 1..self.points.len()).step_by(self.length) {
            let ready = &mut self.points[i].ready;
            let seed = seed(ready.scene.image.seed, "probe", i as u32);
            let spp = ready.scene.image.spp;
            let what = format!("probe of {}", ready.name);
            let rendered = clock.time(&what, |w| ready.render_for(seed, spp, None, w));
            if rendered.samples < spp {
                return None;
            }
            best = best.min(reference.measure(&rendered.rgb()).mse);
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
        reference: &Reference,
        costs: &Costs,
        journal: &mut Journal,
        clock: &mut Clock<'_>,
    ) -> Result<bool, StudyError> {
        let priced = self.priced(costs);
        let replicates = self.request.replicates;
        for replicate in 0..replicates {
            for (i, (cost, samples)) in priced.iter().enumerate() {
                let Point { ready, values } = &mut self.points[i];
                if journal.has(values, replicate) {
                    continue;
                }
                let what = format!("{}, render {} of {replicates}", ready.name, replicate + 1);
                clock.expect(cost.seconds(*samples));
                let rendered = clock.time(&what, |watched| ready.render(replicate, watched));
                if rendered.samples < *samples {
                    return Ok(false);
                }
                let row = self.row(i, replicate, &rendered, reference);
                if replicate == 0 && (i + 1) % self.length == 0 {
                    self.keep(i / self.length, &rendered)?;
                }
                journal.add(row)?;
            }
        }
        Ok(true)
    }

    fn row(&self, i: usize, replicate: u32, rendered: &Rendered, reference: &Reference) -> Row {
        let Point { ready, values } = &self.points[i];
        let measured = reference.measure(&rendered.rgb());
        Row {
            renderer: "etalon".to_owned(),
            scene: choice::stem(&self.request.subject.path),
            panel: ready.scene.panel.clone().unwrap_or_default(),
            settings: self.set.clone(),
            values: values.clone(),
            replicate: replicate.into(),
            seed: ready.seed(replicate),
            threads: self.request.threads.into(),
            seconds: rendered.seconds,
            samples: u64::from(rendered.samples) * rendered.window.pixels() as u64,
            // The root of what may be below 0, with its sign.
            rmse: measured.mse.abs().sqrt().copysign(measured.mse),
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
    fn keep(&self, curve: usize, rendered: &Rendered) -> Result<(), StudyError> {
        let window = rendered.window;
        let mut picture = Picture::new(window.width() as usize, window.height() as usize);
        let estimates = rendered.rgb();
        let colours: Vec<_> = estimates.iter().map(|e| e.mean.map(|v| v as f32)).collect();
        picture.push_triple(names::BEAUTY, names::RGB, &colours);
        let path = self.request.directory.join(picture_name(curve));
        Ok(exr::write(&path, &picture)?)
    }
}

/// The file that keeps a curve's picture.
pub fn picture_name(curve: usize) -> String {
    format!("curve-{}.exr", curve + 1)
}
