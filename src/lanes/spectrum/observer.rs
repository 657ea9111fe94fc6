//! The CIE 1931 standard observer (2°), XYZ, and linear sRGB.
//!
//! XYZ = ∫ L(λ) (x̄, ȳ, z̄) dλ / ∫ ȳ dλ over 360–830 nm, so the equal-energy spectrum of value 1 has
//! Y = 1. The colour-matching functions are the published values at 1 nm, linear in between; the
//! integral of that function, which is the trapezoid sum of the table, is [`Y_INTEGRAL`].
//! (The plain sum of the 471 values is 106.856917. Other renderers divide by 106.856895 or
//! 106.7502594; comparisons at 1e-4 must take that into account.) With 683.002 lm/W in the
//! numerator instead, the same integrals are cd/m².

use std::sync::LazyLock;

use super::table::columns;
use super::{NM_MAX, NM_MIN, Spectrum, quadrature};

/// ∫ ȳ dλ in nm: the trapezoid sum over the 1 nm table, exact to all its decimals.
pub const Y_INTEGRAL: f64 = 106.856_914_916_767;

/// XYZ to linear sRGB (Rec. 709 primaries, white D65), without chromatic adaptation.
///
/// The matrix of IEC 61966-2-1:1999/Amd 1:2003, which is the inverse of the standard's forward
/// matrix *rounded to four decimals*. From that of the exact chromaticities it differs by up to
/// 5e-4.
pub const XYZ_TO_LINEAR_SRGB: [[f64; 3]; 3] = [
    [3.240_625_5, -1.537_208, -0.498_628_6],
    [-0.968_930_7, 1.875_756_1, 0.041_517_5],
    [0.055_710_1, -0.204_021_1, 1.056_995_9],
];

static TABLE: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    let ([_, x, y, z], _) = columns::<4>(include_str!("data/cie_1931_2deg.csv"))
        .expect("the embedded table of the observer is well formed");
    (0..x.len()).map(|i| [x[i], y[i], z[i]]).collect()
});

/// x̄, ȳ, z̄ at wavelength `nm`: linear between the table's nodes at whole nm, zero outside
/// 360–830 nm.
pub fn xyz_bar(nm: f64) -> [f64; 3] {
    let table = &*TABLE;
    if !(NM_MIN..=NM_MAX).contains(&nm) {
        return [0.0; 3];
    }
    let offset = nm - NM_MIN;
    let index = (offset as usize).min(table.len() - 2);
    let t = offset - index as f64;
    let (low, high) = (&table[index], &table[index + 1]);
    std::array::from_fn(|i| low[i] * (1.0 - t) + high[i] * t)
}

/// XYZ of a spectrum, Y = 1 for the equal-energy spectrum of value 1.
///
/// The integral of the product of spectrum and colour-matching functions is exact (up to
/// rounding) for tables, and better than 1e-12 for the smooth spectra.
pub fn spectrum_to_xyz(spectrum: &Spectrum) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for index in 0..TABLE.len() - 1 {
        let low = NM_MIN + index as f64;
        let part = quadrature::between_kinks(spectrum, low, low + 1.0, |nm| {
            let value = spectrum.value(nm);
            xyz_bar(nm).map(|bar| value * bar)
        });
        for (total, piece) in sum.iter_mut().zip(part) {
            *total += piece;
        }
    }
    sum.map(|total| total / Y_INTEGRAL)
}

/// Luminance of linear R, G, B: Rec. ITU-R BT.709-6, item 3.2.
#[inline]
pub fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// Linear sRGB of XYZ (D65 white, no adaptation); components may be negative or above 1.
#[inline]
pub fn xyz_to_linear_srgb(xyz: [f64; 3]) -> [f64; 3] {
    XYZ_TO_LINEAR_SRGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}
