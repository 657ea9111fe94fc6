//! `etalon info`: what a scene needs, in words.

use etalon::scene;

use super::Answer;
use super::args::Info;
use super::error::CommandError;

/// Describes the scene.
pub fn run(arguments: &Info) -> Result<Answer, CommandError> {
    scene::load(&arguments.scene.scene, &arguments.overrides())?;
    Err(CommandError::NotAvailable("info"))
}
