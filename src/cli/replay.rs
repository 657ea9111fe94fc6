//! `etalon replay`: one camera path, step by step.

use etalon::scene;

use super::Answer;
use super::args::Replay;
use super::error::CommandError;

/// Follows the path asked for.
pub fn run(arguments: &Replay) -> Result<Answer, CommandError> {
    scene::load(&arguments.scene.scene, &arguments.overrides())?;
    Err(CommandError::NotAvailable("replay"))
}
