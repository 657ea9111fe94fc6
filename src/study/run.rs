//! A study from request to table: plan, reference, and then render after render.

use std::path::PathBuf;
use std::time::Instant;

use super::StudyError;
use super::axis::Axis;
use super::budget::{self, Costs};
use super::choice::{self, Choice, Found};
use super::clock::Clock;
use super::grid::Grid;
use super::journal::{self, Journal};
use super::reference::Reference;
use super::subject::{Ready, Subject};
use super::work::Work;
use crate::chart::{Key, Row};
use crate::film::{hash, whole};
use crate::render::memory;
use crate::scene::SamplerKind;

/// A study to be carried out.
#[derive(Debug, Clone)]
pub struct Request {
    pub subject: Subject,
    /// The settings to vary.
    pub axes: Vec<Axis>,
    /// Independent renders of each point, at least 2.
    pub replicates: u32,
    pub reference: Choice,
    /// Seconds that the study may take.
    pub budget: f64,
    /// Number of threads.
    pub threads: u32,
    /// Directory of the results.
    pub directory: PathBuf,
    /// The command that asked for it.
    pub command: String,
}

/// Follows the progress of a study, and can stop it.
pub trait Watch {
    /// Takes a line about a decision, such as the planned axis.
    fn note(&mut self, line: &str);
    /// Takes what is being rendered, the share of all work that is done, and the seconds left.
    fn at(&mut self, what: &str, share: f64, left: f64);
    fn stops(&self) -> bool;
}

/// A study, complete or interrupted.
#[derive(Debug)]
pub struct Study {
    pub grid: Grid,
    pub rows: Vec<Row>,
    pub reference: Reference,
    /// Where the reference comes from, in words.
    pub about_reference: String,
    /// Whether all points are there.
    pub complete: bool,
    /// Seconds since the beginning, and those of them spent rendering.
    pub seconds: [f64; 2],
}

/// Samplers that a study compares where no axis is given.
const SAMPLERS: [&str; 3] = ["independent", "stratified", "sobol"];

/// Carries a study out, or continues it.
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
    // Before a reference as large as the picture is made.
    budget::check_memory(&base, memory::available())?;
    let found = choice::find(request, &base.scene)?;
    for note in &found.notes {
        watch.note(note);
    }
    let said = said(request, &base, &found);
    let record = request.directory.join("study.toml");
    let resumed = journal::resume(&record, &said)?;
    let goes_on = resumed.is_some();
    let axes = axes(request, &base)?;
    let (grid, costs) = match resumed {
        Some(grid) => (grid, None),
        None => planned(request, &axes, &found, watch)?,
    };
    let mut work = Work::new(request, grid, &found)?;
    budget::check_memory(work.largest(), memory::available())?;
    let costs = costs.unwrap_or_else(|| work.pilot());
    if !goes_on {
        let abscissa = work.grid.abscissa.key;
        costs.check(abscissa, &work.priced(&costs), request.budget)?;
    }
    let directory = &request.directory;
    std::fs::create_dir_all(directory)
        .map_err(|error| StudyError::file("make the directory", directory, &error))?;
    let record_text = journal::record(&said, &work.grid, &request.command);
    whole::write(&record, |file| {
        use std::io::Write as _;
        file.write_all(record_text.as_bytes())
    })?;
    let mut journal = Journal::open(directory.join("study.csv"))?;
    let mut clock = Clock::new(watch, work.remaining(&costs, &journal));
    let Some((reference, about_reference)) = work.reference(found, &mut clock)? else {
        return Err(StudyError::Interrupted);
    };
    let complete = work.go(&reference, &costs, &mut journal, &mut clock)?;
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

/// The axes asked for, or the samplers where none is.
fn axes(request: &Request, base: &Ready) -> Result<Vec<Axis>, StudyError> {
    let mut axes = request.axes.clone();
    if axes.is_empty() && !base.scene.image.sampler.is_centred() {
        axes.push(Axis {
            key: Key::Sampler,
            values: SAMPLERS.map(str::to_owned).to_vec(),
        });
    }
    let mixes_centres = |axis: &Axis| {
        let is_centre = |value: &String| {
            let mut kinds = SamplerKind::ALL.iter();
            kinds.any(|kind| kind.is_centred() && kind.name() == value)
        };
        axis.values.iter().any(is_centre) && !axis.values.iter().all(is_centre)
    };
    let mut samplers = axes.iter().filter(|axis| axis.key == Key::Sampler);
    if samplers.any(mixes_centres) {
        return Err(StudyError::TwoPictures);
    }
    Ok(axes)
}

/// The grid over these axes, its samples planned from a pilot where no axis is a number, and what
/// that pilot measured.
fn planned(
    request: &Request,
    axes: &[Axis],
    found: &Found,
    watch: &mut dyn Watch,
) -> Result<(Grid, Option<Costs>), StudyError> {
    if let Some(grid) = Grid::new(axes)? {
        return Ok((grid, None));
    }
    // One point a curve, for the pilot.
    let grid = Grid {
        abscissa: Axis {
            key: Key::Spp,
            values: vec!["64".to_owned()],
        },
        others: axes.to_vec(),
    };
    let mut work = Work::new(request, grid.clone(), found)?;
    budget::check_memory(work.largest(), memory::available())?;
    let costs = work.pilot();
    let abscissa = costs.plan(request.budget)?;
    watch.note(&format!(
        "planned from a pilot for {:.0} s: {} samples a pixel, {} renders each",
        request.budget,
        abscissa.values.join(", "),
        request.replicates
    ));
    Ok((Grid { abscissa, ..grid }, Some(costs)))
}

/// Names and values of everything that the numbers of a study depend on.
fn said(request: &Request, base: &Ready, found: &Found) -> Vec<(&'static str, String)> {
    let source = &base.scene.source;
    let reference = found.reference.as_ref().map_or("own", |r| &r.name);
    let over: Vec<_> = request.axes.iter().map(Axis::to_string).collect();
    let overrides = &request.subject.overrides;
    vec![
        ("scene", source.path.clone()),
        ("scene_hash", hash(&source.text)),
        ("panel", overrides.panel.clone().unwrap_or_default()),
        ("set", request.subject.settings()),
        ("finder", overrides.finder.clone().unwrap_or_default()),
        ("over", over.join(" ")),
        ("replicates", request.replicates.to_string()),
        ("reference", reference.to_owned()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
    ]
}
