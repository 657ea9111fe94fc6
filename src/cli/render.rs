//! `etalon render`: a scene to a picture.

mod job;
pub mod progress;
mod report;

use std::io::Write as _;
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Instant;

use etalon::inside::film::{png, whole};
use etalon::inside::plan::explain;
use etalon::inside::render::Instructions;
use etalon::{Goal, Scene, Target};
use rayon::ThreadPool;

use super::args::Render;
use super::error::CommandError;
use super::values::{GoalTarget, Panels};
use super::{Answer, tell};
use job::Job;
use progress::Watch;

/// Renders the scene as asked for.
pub fn run(arguments: &Render) -> Result<Answer, CommandError> {
    let instructions = arguments.instructions;
    let mut jobs = jobs(arguments, instructions)?;
    for job in &jobs {
        job.probe()?;
    }
    let threads = threads(arguments.threads)?;
    progress::listen();
    for job in &mut jobs {
        if let Some(report) = threads.install(|| carry_out(arguments, job))? {
            say(&report)?;
        }
        if progress::interrupted() {
            break;
        }
    }
    Ok(Answer::Good)
}

/// One job a panel, each checked before any is begun.
fn jobs(arguments: &Render, instructions: Instructions) -> Result<Vec<Job>, CommandError> {
    let path = &arguments.scene.scene;
    let panels = match &arguments.panel {
        None => vec![None],
        Some(Panels::Named(name)) => vec![Some(name.clone())],
        Some(Panels::All) => {
            let names = Scene::panels(path)?;
            if names.is_empty() {
                return Err(CommandError::NoPanels(path.clone()));
            }
            names.into_iter().map(Some).collect()
        }
    };
    let jobs: Vec<Job> = panels
        .iter()
        .map(|panel| Job::new(arguments, panel.as_deref(), instructions))
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
fn carry_out(arguments: &Render, job: &mut Job) -> Result<Option<String>, CommandError> {
    let plan = job.render.plan();
    if !arguments.quiet && !plan.left_out.is_empty() {
        let names = plan.left_out.join(", ");
        tell(&format!("note: light left out: {names}"));
    }
    if let Some(doubt) = explain::doubt(plan).filter(|_| !arguments.quiet) {
        tell(&format!("note: single precision: {doubt}"));
    }
    let mut chosen = None;
    if let Some(goal) = wanted(arguments) {
        let start = Instant::now();
        let mut watch = Watch::new(job, None, !arguments.quiet);
        let aimed = job.render.aim(goal, &mut watch);
        watch.finish();
        let Some(aimed) = aimed? else {
            return Ok(None);
        };
        job.render.check_memory()?;
        chosen = Some((goal, aimed, start.elapsed().as_secs_f64()));
    }
    let mut watch = Watch::new(job, job.render.time, !arguments.quiet);
    let rendered = job.render.run_watched(&mut watch);
    watch.finish();
    let interrupted = progress::interrupted();
    let picture = job.render.picture(&rendered)?;
    picture.write(&job.output)?;
    if let (Some(preview), Some(rgb)) = (&job.preview, picture.rgb()) {
        png::write_preview(preview, picture.width, picture.height, &rgb)?;
    }
    let outcome = report::Outcome {
        rendered: &rendered,
        interrupted,
        chosen,
    };
    Ok(Some(report::lines(job, &outcome)))
}

/// The error that is asked for, if any is.
fn wanted(arguments: &Render) -> Option<Goal> {
    arguments.target_error.map(|error| Goal {
        error,
        target: match arguments.target {
            GoalTarget::Image => Target::Image,
            GoalTarget::Block => Target::Block,
        },
    })
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
