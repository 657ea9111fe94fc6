//! Layers of the picture that are asked for.

use etalon::film::Picture;
use etalon::render::Rendered;

use super::super::args::Render;
use super::super::error::CommandError;
use super::super::values::Layer;
use super::job::Job;

/// Spectral bins asked for.
pub fn bin_count(_layers: &[Layer]) -> usize {
    0
}

/// Channels of the other layers.
pub fn channel_count(layers: &[Layer]) -> usize {
    3 * layers.len()
}

/// Adds the layers asked for.
pub fn push(
    _picture: &mut Picture,
    arguments: &Render,
    _job: &Job,
    _rendered: &Rendered,
) -> Result<(), CommandError> {
    if arguments.layers.is_empty() {
        Ok(())
    } else {
        Err(CommandError::NotAvailable("--layers"))
    }
}
