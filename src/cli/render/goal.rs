//! How many samples the wanted error takes.

use std::time::Instant;

use etalon::plan::Plan;
use etalon::render::goal::{Chosen, Goal, Target, choose};
use etalon::render::{Instructions, Request, render};
use etalon::study::seeds::seed;

use super::super::args::Render;
use super::super::error::CommandError;
use super::super::values::GoalTarget;
use super::job::{Job, MOST_SAMPLES};
use super::progress::Watch;

/// What is asked for, if anything is.
pub fn wanted(arguments: &Render) -> Option<Goal> {
    arguments.target_error.map(|error| Goal {
        error,
        target: match arguments.target {
            GoalTarget::Image => Target::Image,
            GoalTarget::Block => Target::Block,
        },
    })
}

/// The job with the number of samples that the goal takes, and how that was chosen; `None` where
/// the user stopped it.
pub fn aim(
    arguments: &Render,
    job: &mut Job,
    goal: Goal,
    instructions: Instructions,
) -> Result<Option<(Chosen, f64)>, CommandError> {
    let start = Instant::now();
    let mut failed = None;
    let mut watch = Watch::new(job, None, !arguments.quiet);
    let base = job.scene.image.seed;
    let strata = job.scene.image.sampler.needs_count();
    let chosen = choose(
        goal,
        job.window.pixels(),
        MOST_SAMPLES,
        |samples, number| {
            job.scene.image.spp = samples;
            // Strata are cut for a number of samples.
            if strata {
                match Plan::new(&job.scene, arguments.plan.is_full()) {
                    Ok(plan) => job.plan = plan,
                    Err(error) => failed = Some(error),
                }
            }
            job.plan.reseed(seed(base, "pilot", number));
            let request = Request {
                window: job.window,
                samples,
                time: None,
                instructions,
            };
            let rendered = render(&job.plan, &request, &mut watch);
            (rendered.samples == samples && failed.is_none()).then_some(rendered)
        },
    );
    watch.finish();
    if let Some(error) = failed {
        return Err(error.into());
    }
    let Some(chosen) = chosen else {
        return Ok(None);
    };
    job.scene.image.spp = chosen.samples;
    job.plan = Plan::new(&job.scene, arguments.plan.is_full())?;
    super::memory::check(arguments, job)?;
    Ok(Some((chosen, start.elapsed().as_secs_f64())))
}
