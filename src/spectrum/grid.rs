//! Spectra on the wavelength grid of the loop.
//!
//! The band 360–830 nm is cut into cells of a quarter nanometre. A *mean* spectrum holds each
//! cell's exact mean, so that integrals against anything constant over a cell are exact; a
//! *node* spectrum (refractive indices) holds values at the cell edges, linear between.

use crate::math::lanes::{Int, Lanes, Real, Scalar};

/// Shortest wavelength, nm.
pub const SHORTEST: f64 = 360.0;
/// Longest wavelength, nm.
pub const LONGEST: f64 = 830.0;
/// Cells per nm.
pub const CELLS_PER_NM: f64 = 4.0;
/// Number of cells.
pub const CELLS: usize = 1880;
/// Entries of one spectrum in a bank: the cells and one repeated last entry for a wavelength of
/// exactly 830 nm and for node spectra.
pub const STRIDE: usize = CELLS + 2;

/// Many spectra in one table.
#[derive(Debug, Clone, Default)]
pub struct SpectrumBank<T> {
    values: Vec<T>,
}

impl<T: Scalar> SpectrumBank<T> {
    /// An empty bank.
    pub fn new() -> Self {
        Self { values: Vec::new() }
    }

    /// Adds a spectrum given by its cell means or its nodes; returns where it starts.
    pub fn push(&mut self, values: &[f64]) -> u32 {
        let start = self.values.len();
        self.values.extend(values.iter().map(|&v| T::from_f64(v)));
        let last = values.last().copied().unwrap_or(0.0);
        self.values.resize(start + STRIDE, T::from_f64(last));
        start as u32
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.values.len() * size_of::<T>()
    }

    /// Entry `cell` of the spectrum at `start`; past the end the last one.
    pub fn at(&self, start: u32, cell: usize) -> T {
        let index = start as usize + cell.min(STRIDE - 1);
        self.values.get(index).copied().unwrap_or_default()
    }

    /// The mean of the cell at a grid position (cells above 360 nm).
    #[inline(always)]
    pub fn mean<L: Lanes<Scalar = T>>(&self, l: L, start: L::Int, position: L::Real) -> L::Real {
        l.gather(&self.values, start.plus(l.truncate(position)))
    }

    /// The value between nodes at a grid position.
    #[inline(always)]
    pub fn between<L: Lanes<Scalar = T>>(&self, l: L, start: L::Int, position: L::Real) -> L::Real {
        let cell = l.truncate(position);
        let index = start.plus(cell);
        let a = l.gather(&self.values, index);
        let b = l.gather(&self.values, index.plus(l.int(1)));
        (position - l.to_real(cell)).mul_add(b - a, a)
    }
}
