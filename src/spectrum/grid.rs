//! Spectra on the wavelength grid of the loop.
//!
//! A path carries C wavelengths: the hero, drawn by a density that follows the observer, and C − 1
//! more at equal steps of the cumulative density (A. Wilkie et al., "Hero Wavelength Spectral
//! Sampling", EGSR 2014). The unit interval of the cumulative density is cut into [`CELLS`] equal
//! cells, 0.06 nm wide in the middle of the band and 1 nm at its red end; all that a path needs to
//! look a spectrum up is its cell modulo `CELLS`/C, and the C values then stand in one row of a
//! table. *Mean* rows hold each cell's exact mean over wavelength, so that integrals against
//! anything constant over a cell are exact; *node* rows (refractive indices) hold values at the
//! cells' lower ends, linear between.

use super::wavelengths::WavelengthPdf;
use crate::math::lanes::Scalar;

/// Shortest wavelength, nm.
pub const SHORTEST: f64 = 360.0;
/// Longest wavelength, nm.
pub const LONGEST: f64 = 830.0;
/// Number of cells, a multiple of every number of wavelengths.
pub const CELLS: usize = 4096;

/// The inverse of the cumulative density by which heroes are drawn, [`WavelengthPdf::Visible`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Cumulative;

impl Cumulative {
    /// Wavelength, nm, at cumulative density `u`.
    pub fn wavelength(&self, u: f64) -> f64 {
        WavelengthPdf::Visible.sample(u)
    }

    /// Wavelength at the lower end of a cell, nm.
    pub fn edge(&self, cell: usize) -> f64 {
        match cell {
            0 => SHORTEST,
            CELLS.. => LONGEST,
            _ => self.wavelength(cell as f64 / CELLS as f64),
        }
    }
}

/// Many spectra in one table of rows of `wavelengths` values.
#[derive(Debug, Clone)]
pub struct SpectrumBank<T> {
    wavelengths: usize,
    values: Vec<T>,
}

impl<T: Scalar> SpectrumBank<T> {
    /// An empty bank for paths of `wavelengths` wavelengths.
    pub fn new(wavelengths: usize) -> Self {
        Self {
            wavelengths,
            values: Vec::new(),
        }
    }

    /// Adds a spectrum: entry `cell` of `values` is its mean or node. The node after the last is
    /// the last itself if not given. Returns the first row's number.
    pub fn push(&mut self, values: &[f64]) -> u32 {
        let first = self.values.len() / self.wavelengths;
        let rows = CELLS / self.wavelengths;
        for row in 0..=rows {
            for j in 0..self.wavelengths {
                let cell = (j * rows + row).min(values.len() - 1);
                self.values.push(T::from_f64(values[cell]));
            }
        }
        first as u32
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.values.len() * size_of::<T>()
    }

    /// The table: row `first + r` holds the values at the wavelengths of a path of row r of the
    /// spectrum that starts at `first`.
    #[inline(always)]
    pub fn rows<const C: usize>(&self) -> &[[T; C]] {
        self.values.as_chunks().0
    }
}
