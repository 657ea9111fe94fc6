//! From radiance at a path's wavelengths to tristimulus values.

use super::pool::Rows;
use crate::math::lanes::Scalar;
use crate::spectrum::cells;
use crate::spectrum::grid::{CELLS, Cumulative};
use crate::spectrum::observer;

/// The observer on the wavelength grid: x̄, ȳ, z̄ of each cell times what a sample of the cell
/// stands for, (number of cells × width of the cell)/C, over ∫ȳ.
#[derive(Debug, Clone)]
pub struct Spectrometer<T> {
    /// By row of the wavelength grid: a row for X, one for Y and one for Z, side by side.
    weights: Vec<T>,
}

impl<T: Scalar> Spectrometer<T> {
    /// The CIE 1931 observer for paths of `wavelengths` wavelengths.
    pub fn new(wavelengths: usize) -> Self {
        let cumulative = Cumulative;
        let by_cell: Vec<[f64; 3]> = (0..CELLS)
            .map(|cell| {
                let (low, high) = (cumulative.edge(cell), cumulative.edge(cell + 1));
                let mean = cells::mean_of_interpolant(low, high, observer::xyz_bar);
                let stands_for = CELLS as f64 * (high - low) / wavelengths as f64;
                mean.map(|m| m * stands_for / observer::Y_INTEGRAL)
            })
            .collect();
        let rows = CELLS / wavelengths;
        let mut weights = Vec::with_capacity(3 * CELLS);
        for row in 0..rows {
            for channel in 0..3 {
                let cells = (0..wavelengths).map(|j| by_cell[j * rows + row][channel]);
                weights.extend(cells.map(T::from_f64));
            }
        }
        Self { weights }
    }

    /// X, Y, Z of one sample.
    #[inline(always)]
    pub fn tristimulus<const C: usize>(&self, rows: &Rows<T, C>, slot: usize) -> [T; 3] {
        let radiance = rows.radiance[slot];
        let first = 3 * rows.row[slot] as usize;
        let table: &[[T; C]] = self.weights.as_chunks().0;
        let mut out = [T::default(); 3];
        for (out, weights) in out.iter_mut().zip(&table[first..first + 3]) {
            // Pairwise, so that the sum is the same tree whatever the vector width.
            let mut terms = [T::default(); C];
            for c in 0..C {
                terms[c] = radiance[c] * weights[c];
            }
            let mut width = C / 2;
            while width > 0 {
                for c in 0..width {
                    terms[c] = terms[c] + terms[c + width];
                }
                width /= 2;
            }
            *out = terms[0];
        }
        out
    }
}
