//! `etalon render`: a scene to a picture.

mod job;
mod report;

use std::time::Instant;

use etalon::inside::film::png;
use etalon::inside::plan::explain;
use etalon::{Goal, Scene, Target};

use super::args::Render;
use super::progress::{Rendering, interrupted, listen};
use super::{Answer, Failure, say, scene_words, tell, threads};
pub use job::Job;
pub use report::percent;

pub fn run(arguments: &Render) -> Result<Answer, Failure> {
    let mut jobs = jobs(arguments)?;
    for job in &jobs {
        job.probe()?;
    }
    let threads = threads(arguments.threads)?;
    listen();
    for job in &mut jobs {
        if let Some(report) = threads.install(|| carry_out(arguments, job))? {
            say(&report)?;
        }
        if interrupted() {
            break;
        }
    }
    Ok(Answer::Good)
}

/// One job a panel, each checked before any is begun.
fn jobs(arguments: &Render) -> Result<Vec<Job>, Failure> {
    let path = &arguments.scene.scene;
    let panels = match arguments.scene.panel.as_deref() {
        Some("all") => {
            let names = Scene::panels(path).map_err(|error| scene_words(&error))?;
            if names.is_empty() {
                return Err(format!("{} has no panels", path.display()).into());
            }
            names.into_iter().map(Some).collect()
        }
        panel => vec![panel.map(str::to_owned)],
    };
    let jobs = panels.iter();
    let jobs = jobs.map(|panel| Job::new(arguments, panel.as_deref()));
    let jobs: Vec<Job> = jobs.collect::<Result<_, _>>()?;
    job::distinct(&jobs)?;
    Ok(jobs)
}

/// Renders and writes one picture, on the threads of the current pool; the answer is the report,
/// `None` where the user stopped before the picture was begun.
fn carry_out(arguments: &Render, job: &mut Job) -> Result<Option<String>, Failure> {
    let plan = job.render.plan();
    if !arguments.quiet && !plan.left_out.is_empty() {
        let names = plan.left_out.join(", ");
        tell(&format!("note: light left out: {names}"));
    }
    if let Some(doubt) = explain::doubt(plan).filter(|_| !arguments.quiet) {
        tell(&format!("note: single precision: {doubt}"));
    }
    let mut chosen = None;
    if let Some(error) = arguments.target_error {
        let target = match arguments.target.as_str() {
            "block" => Target::Block,
            _ => Target::Image,
        };
        let start = Instant::now();
        let mut watch = Rendering::new(job, None, arguments.quiet);
        let Some(aimed) = job.render.aim(Goal { target, error }, &mut watch)? else {
            return Ok(None);
        };
        job.check_memory()?;
        chosen = Some((aimed, start.elapsed().as_secs_f64()));
    }
    let mut watch = Rendering::new(job, job.render.time, arguments.quiet);
    let rendered = job.render.run_watched(&mut watch);
    drop(watch);
    let picture = job.render.picture(&rendered)?;
    picture.write(&job.output)?;
    if let (Some(preview), Some(rgb)) = (&job.preview, picture.rgb()) {
        png::write_preview(preview, picture.width, picture.height, &rgb)?;
    }
    Ok(Some(report::lines(job, &rendered, chosen)))
}
