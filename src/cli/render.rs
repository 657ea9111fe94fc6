//! `etalon render`: a scene to a picture.

use etalon::scene;

use super::Answer;
use super::args::Render;
use super::error::CommandError;

/// Renders the scene as asked for.
pub fn run(arguments: &Render) -> Result<Answer, CommandError> {
    scene::load(&arguments.scene.scene, &arguments.overrides(None))?;
    Err(CommandError::NotAvailable("render"))
}
