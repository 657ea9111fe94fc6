//! `etalon render`: a scene to a picture.

mod goal;
mod job;
mod layers;
mod memory;
mod picture;
pub mod progress;
mod report;

use std::io::Write as _;
use std::num::NonZeroUsize;
use std::path::Path;

use etalon::film::{exr, png, whole};
use etalon::plan::explain;
use etalon::render::{Instructions, Request, render, render_binned};
use etalon::scene;
use rayon::ThreadPool;

use super::args::Render;
use super::error::CommandError;
use super::values::Panels;
use super::{Answer, tell};
use job::Job;
use progress::Watch;

/// Renders the scene as asked for.
pub fn run(arguments: &Render) -> Result<Answer, CommandError> {
    let instructions = arguments.instructions;
    let mut jobs = jobs(arguments)?;
    for job in &jobs {
        job.probe()?;
    }
    let threads = threads(arguments.threads)?;
    progress::listen();
    for job in &mut jobs {
        if let Some(report) = threads.install(|| carry_out(arguments, job, instructions))? {
            say(&report)?;
        }
        if progress::interrupted() {
            break;
        }
    }
    Ok(Answer::Good)
}

/// One job a panel, each checked before any is begun.
fn jobs(arguments: &Render) -> Result<Vec<Job>, CommandError> {
    let path = &arguments.scene.scene;
    let panels = match &arguments.panel {
        None => vec![None],
        Some(Panels::Named(name)) => vec![Some(name.clone())],
        Some(Panels::All) => {
            let names = scene::panel_names(&path.display().to_string(), &scene::read(path)?)?;
            if names.is_empty() {
                return Err(CommandError::NoPanels(path.clone()));
            }
            names.into_iter().map(Some).collect()
        }
    };
    let jobs: Vec<Job> = panels
        .iter()
        .map(|panel| Job::new(arguments, panel.as_deref()))
        .collect::<Result<_, _>>()?;
    job::distinct(&jobs)?;
    Ok(jobs)
}

/// The threads to work with.
pub fn threads(count: Option<NonZeroUsize>) -> Result<ThreadPool, CommandError> {
    // 0 stands for one a thread of the machine.
    let count = count.map_or(0, NonZeroUsize::get);
    rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .build()
        .map_err(|reason| CommandError::Threads(reason.to_string()))
}

/// Renders and writes one picture, on the threads of the current pool; the answer is the report,
/// `None` where the user stopped before the picture was begun.
fn carry_out(
    arguments: &Render,
    job: &mut Job,
    instructions: Instructions,
) -> Result<Option<String>, CommandError> {
    if !arguments.quiet && !job.plan.left_out.is_empty() {
        let names = job.plan.left_out.join(", ");
        tell(&format!("note: light left out: {names}"));
    }
    if let Some(doubt) = explain::doubt(&job.plan).filter(|_| !arguments.quiet) {
        tell(&format!("note: single precision: {doubt}"));
    }
    let goal = goal::wanted(arguments);
    let mut chosen = None;
    if let Some(goal) = goal {
        chosen = goal::aim(arguments, job, goal, instructions)?;
        if chosen.is_none() {
            return Ok(None);
        }
    }
    let request = Request {
        window: job.window,
        samples: job.scene.image.spp,
        time: arguments.time.map(|time| time.0),
        instructions,
    };
    let mut watch = Watch::new(job, request.time, !arguments.quiet);
    let rendered = match &job.bins {
        Some(grid) => render_binned(&job.plan, &request, grid, &mut watch),
        None => render(&job.plan, &request, &mut watch),
    };
    watch.finish();
    let outcome = report::Outcome {
        rendered: &rendered,
        interrupted: progress::interrupted(),
        goal: goal.zip(chosen),
    };
    let picture = picture::assemble(arguments, job, &outcome, instructions)?;
    exr::write(&job.output, &picture)?;
    if let (Some(preview), Some(rgb)) = (&job.preview, picture.rgb()) {
        png::write_preview(preview, picture.width, picture.height, &rgb)?;
    }
    Ok(Some(report::lines(arguments, job, &outcome)))
}

/// Lines on stdout.
pub fn say(text: &str) -> Result<(), CommandError> {
    let mut output = std::io::stdout().lock();
    writeln!(output, "{text}")
        .and_then(|()| output.flush())
        .map_err(CommandError::Output)
}

/// Whether a path names a device or pipe, which has no place beside it.
fn is_stream(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Checks that a file can be written.
fn probe(path: &Path) -> Result<(), CommandError> {
    Ok(whole::probe(path)?)
}
