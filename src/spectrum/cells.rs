//! Spectra resampled for the render loop: means over uniform cells.

use super::{NM_MIN, Spectrum, quadrature};

/// Width of a cell, nm.
pub const CELL_NM: f64 = 0.25;
/// Number of cells on 360–830 nm.
pub const CELLS: usize = 1880;

/// The mean of a spectrum over each cell [360 + i/4, 360 + (i + 1)/4] nm, `CELLS` numbers.
///
/// Exact up to rounding for tables (a table's kink or end inside a cell included), better than
/// 1e-12 for the smooth spectra. Zero where a table has no samples.
pub fn cells(spectrum: &Spectrum) -> Vec<f64> {
    if let Spectrum::Constant(value) = spectrum {
        return vec![*value; CELLS];
    }
    (0..CELLS)
        .map(|i| {
            let low = NM_MIN + i as f64 * CELL_NM;
            let [integral] =
                quadrature::between_kinks(spectrum, low, low + CELL_NM, |nm| [spectrum.value(nm)]);
            integral / CELL_NM
        })
        .collect()
}

/// The cell that holds wavelength `nm`; wavelengths outside 360–830 nm get the nearest cell.
pub fn cell_of(nm: f64) -> usize {
    // The cast saturates: below the range 0, above it CELLS − 1.
    (((nm - NM_MIN) / CELL_NM) as usize).min(CELLS - 1)
}
