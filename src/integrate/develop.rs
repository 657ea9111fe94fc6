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
    /// By row of the wavelength grid and wavelength: for X, Y and Z, and a zero.
    weights: Vec<[T; 4]>,
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
        let weight = |row: usize, j: usize| {
            let [x, y, z] = by_cell[j * rows + row];
            [x, y, z, 0.0].map(T::from_f64)
        };
        Self {
            weights: (0..rows)
                .flat_map(|row| (0..wavelengths).map(move |j| (row, j)))
                .map(|(row, j)| weight(row, j))
                .collect(),
        }
    }

    /// X, Y, Z of one sample.
    #[inline(always)]
    pub fn tristimulus<const C: usize>(&self, rows: &Rows<T, C>, slot: usize) -> [T; 3] {
        let radiance = &rows.paths[slot].radiance;
        let table: &[[[T; 4]; C]] = self.weights.as_chunks().0;
        let mut sum = [T::default(); 4];
        for (radiance, weights) in radiance.iter().zip(&table[rows.row[slot] as usize]) {
            for (sum, weight) in sum.iter_mut().zip(weights) {
                *sum = radiance.fused(*weight, *sum);
            }
        }
        let [x, y, z, _] = sum;
        [x, y, z]
    }
}
