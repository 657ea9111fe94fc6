//! A study from request to table: plan, reference, and then render after render.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::StudyError;
use super::axis::{Axis, Key};
use super::budget::{self, Cost, Estimated};
use super::choice::{self, Choice, Found};
use super::grid::{Grid, Point};
use super::journal::Journal;
use super::measure::measure;
use super::own::{self, Own};
use super::record::Record;
use super::reference::Reference;
use super::row::Row;
use super::subject::{Ready, Subject};
use crate::film::{Picture, exr, names, provenance, whole};
use crate::render::{Progress, Rendered, memory};
use crate::scene::SamplerKind;

/// What is asked for.
#[derive(Debug, Clone)]
pub struct Request {
    /// The scene and what is laid over it.
    pub subject: Subject,
    /// What to go over.
    pub axes: Vec<Axis>,
    /// Independent renders of each point, at least 2.
    pub replicates: u32,
    /// What to compare with.
    pub reference: Choice,
    /// Seconds that all may take.
    pub budget: f64,
    /// Threads that work.
    pub threads: u32,
    /// Where the results go.
    pub directory: PathBuf,
    /// The command that asked for it.
    pub command: String,
}

/// Who is told how far a study is, and says whether it goes on.
pub trait Watch {
    /// A line about what was decided.
    fn note(&mut self, line: &str);
    /// What is being rendered, the share of all work that is done, and the seconds left.
    fn at(&mut self, what: &str, share: f64, left: f64);
    /// Whether to stop.
    fn stops(&self) -> bool;
}

/// A study as far as it has come.
#[derive(Debug)]
pub struct Study {
    /// The grid.
    pub grid: Grid,
    /// Its rows.
    pub rows: Vec<Row>,
    /// What they were compared with.
    pub reference: Reference,
    /// Where the reference comes from, in words.
    pub about_reference: String,
    /// Whether all points are there.
    pub complete: bool,
    /// Seconds since the beginning, and those of them spent rendering.
    pub seconds: [f64; 2],
}

/// Samplers that a study goes over where nothing is said.
const SAMPLERS: [&str; 3] = ["independent", "stratified", "sobol"];
/// Share of the budget that the pilot takes, and the most and the least that it takes of a point,
/// seconds.
const PILOT_SHARE: f64 = 0.05;
const PILOT: [f64; 2] = [0.02, 0.2];

/// Carries a study out, or goes on with it.
///
/// # Errors
/// [`StudyError`], before anything is rendered except where the disk fails later.
pub fn run(request: &Request, watch: &mut dyn Watch) -> Result<Study, StudyError> {
    let start = Instant::now();
    if request.replicates < 2 {
        return Err(StudyError::OneReplicate);
    }
    let base = request
        .subject
        .ready(&request.subject.overrides, String::new())?;
    // Before there is a reference as large as the picture.
    budget::check_memory(&base, memory::available())?;
    let directory = |source| StudyError::Directory {
        path: request.directory.clone(),
        source,
    };
    let found = choice::find(request, &base.scene)?;
    for note in &found.notes {
        watch.note(note);
    }
    let said = said(request, &base, &found);
    let record = request.directory.join("study.toml");
    let resumed = Record::resume(&record, &said)?;
    let goes_on = resumed.is_some();
    let axes = axes(request, &base)?;
    let grid = match resumed {
        Some(grid) => grid,
        None => planned(request, &axes, &found, watch)?,
    };
    let mut work = Work::new(request, grid, &found)?;
    budget::check_memory(work.largest(), memory::available())?;
    let cost = work.pilot(request.budget);
    if !goes_on {
        let grid = &work.grid;
        budget::check(grid, &work.points, &work.samples, &cost, request.budget)?;
    }
    std::fs::create_dir_all(&request.directory).map_err(directory)?;
    let record_text = Record {
        request: said,
        grid: work.grid.clone(),
        command: request.command.clone(),
    }
    .text();
    whole::write(&record, |file| {
        use std::io::Write as _;
        let written = file.write_all(record_text.as_bytes());
        written.map_err(|source| crate::film::Error::Write {
            path: record.clone(),
            source,
        })
    })?;
    let mut journal = Journal::open(&request.directory.join("study.csv"))?;
    let mut clock = Clock::new(watch, work.remaining(&cost, &journal));
    let Some((reference, about_reference)) = work.reference(found, &mut clock)? else {
        return Err(StudyError::Interrupted);
    };
    let complete = work.go(request, &reference, &cost, &mut journal, &mut clock)?;
    let rendering = clock.rendering;
    Ok(Study {
        grid: work.grid,
        rows: journal.rows,
        reference,
        about_reference,
        complete,
        seconds: [start.elapsed().as_secs_f64(), rendering],
    })
}

/// The axes asked for; the samplers where none is.
fn axes(request: &Request, base: &Ready) -> Result<Vec<Axis>, StudyError> {
    let mut axes = request.axes.clone();
    let centre = base.scene.image.sampler == SamplerKind::Center;
    if axes.is_empty() && !centre {
        axes.push(Axis {
            key: Key::Sampler,
            values: SAMPLERS.map(str::to_owned).to_vec(),
        });
    }
    let samplers = axes.iter().find(|axis| axis.key == Key::Sampler);
    let centres = samplers.map_or([centre, !centre], |axis| {
        let is_centre = |value: &String| value == "center";
        [
            axis.values.iter().any(is_centre),
            !axis.values.iter().all(is_centre),
        ]
    });
    if centres == [true, true] {
        return Err(StudyError::TwoPictures);
    }
    Ok(axes)
}

/// The grid over these axes, its samples planned from a pilot where no axis is a number.
fn planned(
    request: &Request,
    axes: &[Axis],
    found: &Found,
    watch: &mut dyn Watch,
) -> Result<Grid, StudyError> {
    if let Some(grid) = Grid::new(axes)? {
        return Ok(grid);
    }
    // One point a curve, to be timed.
    let short = Axis {
        key: Key::Spp,
        values: vec!["64".to_owned()],
    };
    let grid = Grid {
        abscissa: short,
        others: axes.to_vec(),
    };
    let mut work = Work::new(request, grid.clone(), found)?;
    budget::check_memory(work.largest(), memory::available())?;
    let cost = work.pilot(request.budget);
    let abscissa = budget::plan(&cost, request.budget)?;
    watch.note(&format!(
        "planned from a pilot for {:.0} s: {} samples a pixel, {} renders each",
        request.budget,
        abscissa.values.join(", "),
        request.replicates
    ));
    Ok(Grid { abscissa, ..grid })
}

/// What names the study: nothing that leaves the numbers as they are.
fn said(request: &Request, base: &Ready, found: &Found) -> Vec<(String, String)> {
    let source = &base.scene.source;
    let set = request.subject.overrides.set.iter();
    let set: Vec<_> = set.map(|(key, value)| format!("{key}={value}")).collect();
    let over: Vec<_> = request.axes.iter().map(Axis::to_string).collect();
    let overrides = &request.subject.overrides;
    let pairs = [
        ("scene", source.path.clone()),
        ("scene_hash", provenance::hash(&source.text)),
        ("panel", overrides.panel.clone().unwrap_or_default()),
        ("set", set.join(" ")),
        ("finder", overrides.finder.clone().unwrap_or_default()),
        ("over", over.join(" ")),
        ("replicates", request.replicates.to_string()),
        ("reference", found.name()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    pairs.map(|(key, value)| (key.to_owned(), value)).to_vec()
}

/// Everything needed to render a grid.
struct Work {
    grid: Grid,
    points: Vec<Point>,
    ready: Vec<Ready>,
    samples: Vec<u32>,
    /// The scene as the study's own reference renders it.
    own: Option<Ready>,
    directory: PathBuf,
    replicates: u32,
    set: String,
}

impl Work {
    fn new(request: &Request, grid: Grid, found: &Found) -> Result<Self, StudyError> {
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
    fn largest(&self) -> &Ready {
        let sums = |r: &&Ready| r.plan.choices.replicates.count(r.scene.image.spp);
        let largest = self.ready.iter().max_by_key(sums);
        // A grid has at least one point.
        largest.unwrap_or(&self.ready[0])
    }

    /// Costs of all points; those that differ only in their samples are timed once.
    fn pilot(&mut self, budget: f64) -> Estimated {
        let without_samples = |point: &Point| {
            let choices = point.choices.iter().filter(|(key, _)| *key != Key::Spp);
            choices.cloned().collect::<Vec<_>>()
        };
        // The last of a curve's points stands for it: its plan has the most samples.
        let mut timed: Vec<(Vec<(Key, String)>, usize)> = Vec::new();
        for (i, point) in self.points.iter().enumerate() {
            let choices = without_samples(point);
            match timed.iter_mut().find(|(other, _)| *other == choices) {
                Some((_, at)) => *at = i,
                None => timed.push((choices, i)),
            }
        }
        let each = budget * PILOT_SHARE / (timed.len() + 1) as f64;
        let each = each.clamp(PILOT[0], PILOT[1]);
        let costs: Vec<Cost> = timed
            .iter()
            .map(|(_, at)| budget::pilot(&mut self.ready[*at], each))
            .collect();
        let cost = |point: &Point| {
            let choices = without_samples(point);
            let at = timed.iter().position(|(other, _)| *other == choices);
            costs[at.unwrap_or(0)]
        };
        Estimated {
            points: self.points.iter().map(cost).collect(),
            reference: self.own.as_mut().map(|own| budget::pilot(own, each)),
            replicates: self.replicates,
        }
    }

    /// Seconds of all that is not in the table yet.
    fn remaining(&self, cost: &Estimated, journal: &Journal) -> f64 {
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

    /// The reference that was found, or the study's own; `None` when stopped on the way.
    fn reference(
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
            "rendered by the study itself with its own seeds ({}), {} samples a pixel a render",
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
    fn go(
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

/// The file that keeps a curve's picture.
pub fn picture_name(curve: usize) -> String {
    format!("curve-{}.exr", curve + 1)
}

fn seconds_of(cost: Cost, samples: u32) -> f64 {
    cost.render + cost.sample * f64::from(samples)
}

/// Time spent, and what is left of the plan.
struct Clock<'a> {
    watch: &'a mut dyn Watch,
    start: Instant,
    planned: f64,
    /// Planned seconds of what is done, and of what is under way.
    done: [f64; 2],
    rendering: f64,
}

impl<'a> Clock<'a> {
    fn new(watch: &'a mut dyn Watch, planned: f64) -> Self {
        Self {
            watch,
            start: Instant::now(),
            planned,
            done: [0.0; 2],
            rendering: 0.0,
        }
    }

    /// What comes next should take so many seconds.
    fn expect(&mut self, seconds: f64) {
        self.done[1] = seconds;
    }

    /// Does a part of the work, and tells of it.
    fn time<T>(&mut self, what: &str, work: impl FnOnce(&mut dyn Progress) -> T) -> T {
        let start = Instant::now();
        self.tell(what, 0.0);
        let result = work(&mut Part { clock: self, what });
        let taken = start.elapsed().as_secs_f64();
        self.rendering += taken;
        self.done[0] += if self.done[1] > 0.0 {
            self.done[1]
        } else {
            taken
        };
        self.done[1] = 0.0;
        result
    }

    fn tell(&mut self, what: &str, part: f64) {
        let done = self.done[0] + part * self.done[1];
        let share = (done / self.planned.max(done)).clamp(0.0, 1.0);
        // As fast as so far, once there is a so far; as planned before.
        let pace = if done > 0.0 {
            self.start.elapsed().as_secs_f64() / done
        } else {
            1.0
        };
        let left = (self.planned - done).max(0.0) * pace;
        self.watch.at(what, share, left);
    }
}

/// One render within a study.
struct Part<'a, 'b> {
    clock: &'a mut Clock<'b>,
    what: &'a str,
}

impl Progress for Part<'_, '_> {
    fn passed(&mut self, done: u32, wanted: u32, _: Duration, _: Option<f64>) -> bool {
        self.clock
            .tell(self.what, f64::from(done) / f64::from(wanted));
        !self.clock.watch.stops()
    }
}
