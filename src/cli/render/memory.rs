//! Whether a picture fits into memory, before it is begun.

use etalon::film::pixels::{Estimate, Pixels};
use etalon::render::bins::Bins;
use etalon::render::memory::available;

use super::super::args::Render;
use super::super::error::CommandError;
use super::job::Job;
use super::layers;

/// R, G, B, their standard errors, and the count of samples.
const CHANNELS: usize = 7;

/// Bytes a pixel needs at the end: its sums, the estimate made of them, and what goes to the
/// file, of which the writer makes a copy.
fn bytes_per_pixel(arguments: &Render, job: &Job) -> usize {
    let bins = job.bins.as_ref().map_or(0, |grid| grid.centres().len());
    let (replicates, samples) = (job.plan.choices.replicates, job.scene.image.spp);
    let pixel = Pixels::bytes_per_pixel(replicates, samples);
    let sums = pixel + bins * Bins::bytes_per_pixel(replicates, samples);
    let channels = CHANNELS + layers::channel_count(&arguments.layers) + 2 * bins;
    sums + size_of::<Estimate>() + 2 * channels * size_of::<f32>()
}

/// Checks that there is room.
///
/// # Errors
/// [`CommandError::Memory`] when more is needed than the system says it can give.
pub fn check(arguments: &Render, job: &Job) -> Result<(), CommandError> {
    let pixels = u64::from(job.window.width()) * u64::from(job.window.height());
    let needed = pixels.saturating_mul(bytes_per_pixel(arguments, job) as u64);
    let available = available();
    if needed > available {
        return Err(CommandError::Memory { needed, available });
    }
    Ok(())
}
