//! A preview for the eye: 8-bit sRGB PNG. The measurement is the OpenEXR file.
//!
//! 1. *Exposure* is one factor for the picture, from the 99th percentile of its luminance (see
//!    [`exposure`]).
//! 2. *Gamut*: colours with a negative component move straight towards the grey of their own
//!    luminance until none is negative; without positive luminance they are black.
//! 3. *Tone curve*: the largest component goes through a curve that is the identity up to 0.8
//!    and approaches 1 above it; the others keep their ratio to it, and so the hue.
//! 4. *Encoding*: the sRGB transfer function (IEC 61966-2-1:1999, 5.2), rounded to nearest.
//!
//! A pixel that is not finite is painted pure magenta, so that it shows.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};

use super::{Error, whole};
use crate::spectrum::observer::luminance;

/// Share of the finite pixels that may be brighter than white.
const BRIGHTEST: f64 = 0.01;
/// A picture is lightened until its percentile reaches this, the usual mid-grey of 18 %.
const MID_GREY: f64 = 0.18;
/// Where the tone curve leaves the identity: white (1) comes to lie at 0.9, its middle.
const KNEE: f64 = 0.8;
const NOT_FINITE: [u8; 3] = [255, 0, 255];

/// Writes a preview of `width` × `height` linear Rec. 709 colours, rows from the top, whole or
/// not at all; returns the factor of [`exposure`] it used.
///
/// # Errors
/// As [`write_colours`].
pub fn write_preview(
    path: &Path,
    width: usize,
    height: usize,
    rgb: &[[f32; 3]],
) -> Result<f64, Error> {
    let exposure = exposure(rgb);
    let colours: Vec<[u8; 3]> = rgb.iter().map(|&pixel| encode(pixel, exposure)).collect();
    write_colours(path, width, height, &colours)?;
    Ok(exposure)
}

/// Writes `width` × `height` sRGB colours of three bytes, rows from the top, whole or not at all.
///
/// # Errors
/// [`Error::Write`], of the kind `InvalidInput` when the number of pixels is not `width` × `height` or
/// not one that PNG can hold; otherwise as [`whole::write()`].
pub fn write_colours(
    path: &Path,
    width: usize,
    height: usize,
    colours: &[[u8; 3]],
) -> Result<(), Error> {
    let contradiction = |reason: String| io::Error::new(io::ErrorKind::InvalidInput, reason);
    whole::write(path, |file| {
        let count = colours.len();
        if count == 0 || width.checked_mul(height) != Some(count) {
            let reason = format!("{count} pixels are no {width} × {height}");
            return Err(contradiction(reason));
        }
        let (Ok(columns), Ok(rows)) = (u32::try_from(width), u32::try_from(height)) else {
            return Err(contradiction(format!(
                "{width} × {height} is too large for PNG"
            )));
        };
        let mut out = BufWriter::new(file);
        PngEncoder::new(&mut out)
            .write_image(
                colours.as_flattened(),
                columns,
                rows,
                ExtendedColorType::Rgb8,
            )
            .map_err(|error| match error {
                ImageError::IoError(source) => source,
                other => contradiction(other.to_string()),
            })?;
        out.flush()
    })
}

/// The factor a picture is exposed by: 1 while the 99th percentile of its luminance lies between
/// mid-grey (0.18) and white (1); otherwise the factor that takes the percentile to the nearer of
/// the two.
///
/// The percentile is the luminance of rank ⌈0.99 n⌉ among the n finite pixels. A picture that is
/// black there keeps exposure 1.
pub fn exposure(rgb: &[[f32; 3]]) -> f64 {
    let finite = rgb.iter().filter(|pixel| is_finite(**pixel));
    let mut luminances: Vec<f64> = finite
        .map(|pixel| luminance(pixel.map(f64::from)))
        .collect();
    if luminances.is_empty() {
        return 1.0;
    }
    let brighter = (BRIGHTEST * luminances.len() as f64).floor() as usize;
    let rank = luminances.len() - 1 - brighter;
    let (_, percentile, _) = luminances.select_nth_unstable_by(rank, f64::total_cmp);
    let exposure = percentile.clamp(MID_GREY, 1.0) / *percentile;
    // Subnormal luminances would ask for an infinite factor: that is black.
    if *percentile > 0.0 && exposure.is_finite() {
        exposure
    } else {
        1.0
    }
}

/// The sRGB bytes of a linear Rec. 709 colour times `exposure`.
#[must_use]
pub fn encode(rgb: [f32; 3], exposure: f64) -> [u8; 3] {
    if !is_finite(rgb) {
        return NOT_FINITE;
    }
    let inside = into_gamut(rgb.map(|component| f64::from(component) * exposure));
    let largest = inside.into_iter().fold(0.0, f64::max);
    if largest <= 0.0 {
        return [0; 3];
    }
    let curve = tone_curve(largest);
    inside.map(|component| quantize(transfer(component / largest * curve)))
}

fn is_finite(rgb: [f32; 3]) -> bool {
    rgb.into_iter().all(f32::is_finite)
}

/// The colour, mixed with the grey of its luminance until no component is negative.
fn into_gamut(rgb: [f64; 3]) -> [f64; 3] {
    let least = rgb.into_iter().fold(f64::INFINITY, f64::min);
    let grey = luminance(rgb);
    if least >= 0.0 {
        rgb
    } else if grey <= 0.0 {
        [0.0; 3]
    } else {
        let kept = grey / (grey - least);
        rgb.map(|component| (grey + kept * (component - grey)).max(0.0))
    }
}

/// k + (1 − k) u/(1 + u) with u = (x − k)/(1 − k) above the knee k: slope 1 there, 1 at infinity.
fn tone_curve(x: f64) -> f64 {
    if x <= KNEE {
        return x;
    }
    let u = (x - KNEE) / (1.0 - KNEE);
    KNEE + (1.0 - KNEE) * (u / (1.0 + u))
}

/// The sRGB transfer function on [0, 1].
fn transfer(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    }
}

/// The nearest of 256 levels.
fn quantize(value: f64) -> u8 {
    (255.0 * value + 0.5) as u8
}
