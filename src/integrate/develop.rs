//! From radiance at a path's wavelengths to tristimulus values.

use super::pool::Rows;
use crate::math::lanes::Scalar;
use crate::spectrum::cells;
use crate::spectrum::grid::{CELLS, Cumulative, SpectrumBank};
use crate::spectrum::observer;

/// The observer on the wavelength grid: x̄, ȳ, z̄ of each cell times what a sample of the cell
/// stands for, (number of cells × width of the cell)/C, over ∫ȳ.
#[derive(Debug, Clone)]
pub struct Spectrometer<T> {
    bank: SpectrumBank<T>,
    observer: [u32; 3],
}

impl<T: Scalar> Spectrometer<T> {
    /// The CIE 1931 observer for paths of `wavelengths` wavelengths.
    pub fn new(wavelengths: usize) -> Self {
        let mut bank = SpectrumBank::new(wavelengths);
        let cumulative = Cumulative;
        let weights: Vec<[f64; 3]> = (0..CELLS)
            .map(|cell| {
                let (low, high) = (cumulative.edge(cell), cumulative.edge(cell + 1));
                let mean = cells::mean_of_interpolant(low, high, observer::xyz_bar);
                let stands_for = CELLS as f64 * (high - low) / wavelengths as f64;
                mean.map(|m| m * stands_for / observer::Y_INTEGRAL)
            })
            .collect();
        let mut channel = |i: usize| {
            let values: Vec<f64> = weights.iter().map(|w| w[i]).collect();
            bank.push(&values)
        };
        let observer = [channel(0), channel(1), channel(2)];
        Self { bank, observer }
    }

    /// X, Y, Z of one sample.
    #[inline(always)]
    pub fn tristimulus<const C: usize>(&self, rows: &Rows<T, C>, slot: usize) -> [T; 3] {
        let radiance = rows.radiance[slot];
        let row = rows.row[slot];
        let mut out = [T::default(); 3];
        for (out, first) in out.iter_mut().zip(self.observer) {
            let weights = self.bank.rows::<C>()[(first + row) as usize];
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
