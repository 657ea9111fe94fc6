//! Whether a picture fits into memory, before it is begun.

use etalon::render::tile::Window;
use etalon::scene::Scene;

use super::super::args::Render;
use super::super::error::CommandError;
use super::layers;

/// Assumed where the system does not tell how much there is: what any machine has.
const UNKNOWN: u64 = 1 << 32;

/// Bytes a pixel needs: its sums, an estimate made of them, and what goes to the file, which the
/// writer copies once.
fn bytes_per_pixel(arguments: &Render, scene: &Scene) -> u64 {
    let slots = u64::from(scene.image.replicates.unwrap_or(8));
    let bins = layers::bin_count(&arguments.layers) as u64;
    let sums = slots * 24 + bins * 8;
    let estimate = 48;
    let channels = 7 + layers::channel_count(&arguments.layers) as u64 + bins;
    sums + estimate + 2 * 4 * channels
}

/// An estimate of the bytes that a render will hold at its end.
pub fn estimate(arguments: &Render, scene: &Scene, window: Window) -> u64 {
    let pixels = u64::from(window.width()) * u64::from(window.height());
    pixels.saturating_mul(bytes_per_pixel(arguments, scene))
}

/// Checks that there is room.
///
/// # Errors
/// [`CommandError::Memory`] when more is needed than the system says it can give.
pub fn check(arguments: &Render, scene: &Scene, window: Window) -> Result<(), CommandError> {
    let needed = estimate(arguments, scene, window);
    let available = available().unwrap_or(UNKNOWN);
    if needed > available {
        return Err(CommandError::Memory { needed, available });
    }
    Ok(())
}

/// Bytes that can be had without swapping, as Linux estimates them; `None` elsewhere.
fn available() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
