//! HDR-ꟻLIP: how large a difference looks to somebody who flips between two pictures.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. D. Fairchild, "ꟻLIP: A
//! Difference Evaluator for Alternating Images", PACM CGIT 3(2), 2020; P. Andersson, J. Nilsson,
//! P. Shirley and T. Akenine-Möller, "Visualizing the Error in Rendered High Dynamic Range Images",
//! Eurographics 2021 (short). Constants are those of the papers: a viewer 0.7 m in front of a
//! display 0.7 m wide with 3840 pixels; ACES tone mapping. The exponential and the powers are those
//! of the `libm` crate.
//!
//! Values are between 0 and 1 a pixel, and no unbiased measure of anything: noise counts as error.

mod exposures;
mod filters;

use rayon::prelude::*;

use exposures::{exposures, tone_mapped};
use filters::Filters;

/// Pixels per degree of visual angle: distance · pixels/width · π/180.
const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * std::f64::consts::PI / 180.0;
/// q_c, p_c, p_t and q_f of the first paper.
const COLOUR_EXPONENT: f64 = 0.7;
const LARGEST_SHARE: f64 = 0.4;
const LARGEST_TARGET: f64 = 0.95;
const FEATURE_EXPONENT: f64 = 0.5;
/// D65 as the papers' program has it: XYZ of linear sRGB white.
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];
/// Linear sRGB to XYZ (IEC 61966-2-1, with the digits of the papers' program).
const TO_XYZ: [[f64; 3]; 3] = [
    [0.412_396_555, 0.357_583_078, 0.180_489_298],
    [0.212_649_23, 0.715_169_14, 0.072_181_63],
    [0.019_331_62, 0.119_194_79, 0.950_541_07],
];

/// HDR-ꟻLIP of each pixel of a test picture against a reference, both linear sRGB of
/// `width` pixels a row.
pub fn flip(reference: &[[f64; 3]], test: &[[f64; 3]], width: usize) -> Vec<f64> {
    let filters = Filters::new(PIXELS_PER_DEGREE);
    let maps: Vec<Vec<f64>> = exposures(reference)
        .into_par_iter()
        .map(|exposure| {
            let shown = |picture: &[[f64; 3]]| -> Vec<[f64; 3]> {
                picture.iter().map(|p| tone_mapped(*p, exposure)).collect()
            };
            low_dynamic_range(&filters, &shown(reference), &shown(test), width)
        })
        .collect();
    let worst = |pixel: usize| maps.iter().map(|map| map[pixel]).fold(0.0, f64::max);
    (0..reference.len()).map(worst).collect()
}

/// ꟻLIP of pictures with components in [0, 1], linear.
fn low_dynamic_range(
    filters: &Filters,
    reference: &[[f64; 3]],
    test: &[[f64; 3]],
    width: usize,
) -> Vec<f64> {
    let [r, t] = [reference, test].map(|picture| Seen::new(filters, picture, width));
    let largest = largest_colour_difference();
    let colours = r.colour.iter().zip(&t.colour);
    colours
        .zip(r.features.iter().zip(&t.features))
        .map(|((a, b), (own, others))| {
            let colour = redistributed(libm::pow(hyab(*a, *b), COLOUR_EXPONENT), largest);
            let [edges, points] = [0, 1].map(|i| (own[i] - others[i]).abs());
            let feature = edges.max(points) * std::f64::consts::FRAC_1_SQRT_2;
            let feature = libm::pow(feature, FEATURE_EXPONENT);
            libm::pow(colour, 1.0 - feature)
        })
        .collect()
}

/// A picture as the eye takes it in.
struct Seen {
    /// Colours as the eye resolves them: L*, and a*, b* scaled by the Hunt effect.
    colour: Vec<[f64; 3]>,
    /// Strength of edges and of points.
    features: Vec<[f64; 2]>,
}

impl Seen {
    fn new(filters: &Filters, picture: &[[f64; 3]], width: usize) -> Self {
        let opponent: Vec<[f64; 3]> = picture.iter().map(|rgb| opponent(*rgb)).collect();
        let [mut grey, x, z] =
            [0, 1, 2].map(|i| opponent.iter().map(|c| c[i]).collect::<Vec<f64>>());
        let seen = |values: &[f64], channel| filters.contrast(values, width, channel);
        let colour = seen(&grey, 0).into_iter().zip(seen(&x, 1)).zip(seen(&z, 2));
        let colour = colour
            .map(|((y, x), z)| hunt(lab(from_opponent([y, x, z]))))
            .collect();
        for value in &mut grey {
            *value = (*value + 16.0) / 116.0;
        }
        Self {
            colour,
            features: filters.features(&grey, width),
        }
    }
}

/// XYZ of linear sRGB over those of white.
fn relative_xyz(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = TO_XYZ.map(|row| row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]);
    [x / WHITE[0], y / WHITE[1], z / WHITE[2]]
}

/// The lightness, red–green and blue–yellow of X, Y, Z, which L*a*b* takes after their cube root.
fn opposed([x, y, z]: [f64; 3]) -> [f64; 3] {
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Linear sRGB to Y, Cx, Cz: linear in XYZ, achromatic, red–green and blue–yellow.
fn opponent(rgb: [f64; 3]) -> [f64; 3] {
    opposed(relative_xyz(rgb))
}

/// Back to linear sRGB, clamped to what a display shows.
fn from_opponent([y, x, z]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    let xyz = glam::DVec3::new(
        (x / 500.0 + y) * WHITE[0],
        y * WHITE[1],
        (y - z / 200.0) * WHITE[2],
    );
    let rows = TO_XYZ.map(glam::DVec3::from_array);
    let to_xyz = glam::DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    (to_xyz.inverse() * xyz)
        .to_array()
        .map(|c| c.clamp(0.0, 1.0))
}

/// CIE 1976 L*a*b*.
fn lab(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let f = |t: f64| {
        if t > DELTA * DELTA * DELTA {
            libm::cbrt(t)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    opposed(relative_xyz(rgb).map(f))
}

/// Colours look less colourful where it is dark.
fn hunt([l, a, b]: [f64; 3]) -> [f64; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

/// Distance of colours that is meant for large differences (Abasi, Tehran and Fairchild 2020).
fn hyab(p: [f64; 3], q: [f64; 3]) -> f64 {
    let [l, a, b] = [0, 1, 2].map(|i| p[i] - q[i]);
    l.abs() + (a * a + b * b).sqrt()
}

/// Between the green and the blue of the display.
fn largest_colour_difference() -> f64 {
    let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| hunt(lab(rgb)));
    libm::pow(hyab(green, blue), COLOUR_EXPONENT)
}

/// Maps [0, largest] to [0, 1], the large differences into the last twentieth.
fn redistributed(difference: f64, largest: f64) -> f64 {
    let limit = LARGEST_SHARE * largest;
    if difference < limit {
        LARGEST_TARGET * difference / limit
    } else {
        let above = (difference - limit) / (largest - limit);
        LARGEST_TARGET + (1.0 - LARGEST_TARGET) * above
    }
}
