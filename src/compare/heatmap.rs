//! A picture of where two pictures differ, and which way.

use std::path::Path;

use super::Side;
use crate::film::{Error, png};
use crate::spectrum::observer::luminance;

/// Part of the pixels that may lie beyond the ends of the scale.
const BEYOND: f64 = 0.01;

/// Paints the difference of luminance over the reference's, both about the reference's mean where
/// it is dark: red where the first picture is too bright, blue where it is too dark, white where
/// they agree. Returns the relative difference at the ends of the scale, which one pixel in a
/// hundred exceeds; `None` where a side has no R, G, B.
///
/// # Errors
/// [`Error`] where the file cannot be written.
pub fn write_heatmap(path: &Path, a: &Side, b: &Side) -> Result<Option<f64>, Error> {
    let (Some(x), Some(r)) = (luminances(a), luminances(b)) else {
        return Ok(None);
    };
    let mean = r.iter().sum::<f64>() / r.len() as f64;
    // As in the relative metrics: below a hundredth of the mean, dark is dark.
    let floor = 1e-2 * mean.abs();
    let relative: Vec<f64> = x
        .iter()
        .zip(&r)
        .map(|(x, r)| (x - r) / (r.abs() + floor).max(f64::MIN_POSITIVE))
        .collect();
    let mut sizes: Vec<f64> = relative.iter().map(|d| d.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let rank = ((1.0 - BEYOND) * (sizes.len() - 1) as f64) as usize;
    let scale = sizes[rank].max(f64::MIN_POSITIVE);
    let colours: Vec<[u8; 3]> = relative.iter().map(|d| colour(d / scale)).collect();
    png::write_colours(path, a.width, a.height, &colours)?;
    Ok(Some(scale))
}

fn luminances(side: &Side) -> Option<Vec<f64>> {
    Some(side.rgb()?.into_iter().map(luminance).collect())
}

/// White at 0, to dark red at 1 and dark blue at −1, through a full colour half way.
fn colour(t: f64) -> [u8; 3] {
    let size = t.abs().min(1.0);
    let fading = (2.0 * (1.0 - size)).min(1.0);
    let full = (2.0 - 2.0 * size).clamp(0.0, 1.0);
    let byte = |x: f64| (255.0 * x + 0.5) as u8;
    // Up to half way the other components fade from white; then the colour itself darkens.
    let others = byte((1.0 - 2.0 * size).max(0.0));
    let own = byte(0.4 + 0.6 * full.min(fading));
    if t >= 0.0 {
        [own, others, others]
    } else {
        [others, others, own]
    }
}
