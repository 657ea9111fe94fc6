//! Spectra resampled for the render loop: means over cells of wavelength.

use super::{Spectrum, quadrature};

/// The mean of a spectrum between each two neighbours of `edges` (nm, strictly increasing).
///
/// Exact up to rounding for tables (a table's kink or end inside a cell included), better than
/// 1e-12 for the smooth spectra at cells of 1 nm or less. Zero where a table has no samples.
pub fn means(spectrum: &Spectrum, edges: &[f64]) -> Vec<f64> {
    let cells = edges.windows(2);
    if let Spectrum::Constant(value) = spectrum {
        return vec![*value; cells.len()];
    }
    cells
        .map(|cell| {
            let (low, high) = (cell[0], cell[1]);
            let [integral] =
                quadrature::between_kinks(spectrum, low, high, |nm| [spectrum.value(nm)]);
            integral / (high - low)
        })
        .collect()
}

/// The mean over [low, high] of a function that is linear between whole nanometres.
pub fn mean_of_interpolant<const N: usize>(
    low: f64,
    high: f64,
    f: impl Fn(f64) -> [f64; N],
) -> [f64; N] {
    let mut sum = [0.0; N];
    let mut from = low;
    while from < high {
        let to = (from.floor() + 1.0).min(high);
        for (total, part) in sum.iter_mut().zip(quadrature::gauss(from, to, &f)) {
            *total += part;
        }
        from = to;
    }
    sum.map(|s| s / (high - low))
}
