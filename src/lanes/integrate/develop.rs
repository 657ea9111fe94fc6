//! From radiance at a path's wavelengths to tristimulus values.

use super::pool::Rows;
use crate::math::lanes::Scalar;
use crate::spectrum::cells;
use crate::spectrum::grid::{CELLS, WavelengthGrid};
use crate::spectrum::observer;

/// The observer on the wavelength grid: x̄, ȳ, z̄ of each cell times what a sample of the cell
/// stands for, (number of cells × width of the cell)/C, over ∫ȳ.
#[derive(Debug, Clone)]
pub struct Spectrometer<T> {
    /// By row of the wavelength grid and pair of wavelengths: for X, Y and Z, and a zero, twice; zeros
    /// for the second of an odd number.
    weights: Vec<[T; 8]>,
}

impl<T: Scalar> Spectrometer<T> {
    /// The CIE 1931 observer for paths of `wavelengths` wavelengths.
    pub fn new(grid: &WavelengthGrid, wavelengths: usize) -> Self {
        let by_cell: Vec<[f64; 3]> = (0..CELLS)
            .map(|cell| {
                let (low, high) = grid.cell(cell);
                let mean = cells::mean_of_interpolant(low, high, observer::xyz_bar);
                let stands_for = CELLS as f64 * (high - low) / wavelengths as f64;
                mean.map(|m| m * stands_for / observer::Y_INTEGRAL)
            })
            .collect();
        let rows = CELLS / wavelengths;
        let pairs = wavelengths.div_ceil(2);
        let weight = |row: usize, j: usize| {
            let [x, y, z] = by_cell.get(j * rows + row).copied().unwrap_or_default();
            [x, y, z, 0.0].map(T::from_f64)
        };
        let both = |place: usize| {
            let (row, pair) = (place / pairs, place % pairs);
            let [a, b, c, d] = weight(row, 2 * pair);
            let [e, f, g, h] = weight(row, 2 * pair + 1);
            [a, b, c, d, e, f, g, h]
        };
        Self {
            weights: (0..rows * pairs).map(both).collect(),
        }
    }

    /// X, Y, Z of one sample.
    #[inline(always)]
    pub fn tristimulus<const C: usize>(&self, rows: &Rows<T, C>, slot: usize) -> [T; 3] {
        let radiance = rows.paths[slot].radiance;
        let first = rows.row[slot] as usize * C.div_ceil(2);
        let weights = &self.weights[first..first + C.div_ceil(2)];
        // Two wavelengths side by side fill a vector of eight.
        let mut sum = [T::default(); 8];
        for (pair, weights) in weights.iter().enumerate() {
            let [a, b] = [radiance[2 * pair], radiance[(2 * pair + 1).min(C - 1)]];
            let both = [a, a, a, a, b, b, b, b];
            for k in 0..8 {
                sum[k] = both[k].fused(weights[k], sum[k]);
            }
        }
        [sum[0] + sum[4], sum[1] + sum[5], sum[2] + sum[6]]
    }
}
