//! `etalon info`: what a scene needs, in words.

use std::io::Write as _;

use etalon::inside::plan::explain;
use etalon::{Plan, Scene};

use super::Answer;
use super::args::Info;
use super::error::CommandError;

/// Describes the scene.
pub fn run(arguments: &Info) -> Result<Answer, CommandError> {
    let scene = Scene::load_with(&arguments.scene.scene, &arguments.overrides())?;
    let plan = Plan::new(&scene, arguments.plan.is_full())?;
    let lines = explain::explain(&scene, &plan);
    let mut output = std::io::stdout().lock();
    writeln!(output, "{}", lines.join("\n"))
        .and_then(|()| output.flush())
        .map_err(CommandError::Output)?;
    Ok(Answer::Good)
}
