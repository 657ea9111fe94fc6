//! Spectra on the wavelength grid of the loop.
//!
//! A path carries C wavelengths: the hero, drawn by a density that follows the observer, and C − 1
//! more at equal steps of the cumulative density (A. Wilkie et al., "Hero Wavelength Spectral
//! Sampling", EGSR 2014). The unit interval of the cumulative density is cut into [`CELLS`] equal
//! cells, 0.06 nm wide in the middle of the band and 1 nm at its red end, where [`WavelengthGrid`]
//! lets a jump of a spectrum be an edge between two; all that a path needs to
//! look a spectrum up is its cell modulo `CELLS`/C, and the C values then stand in one row of a
//! table. *Mean* rows hold each cell's exact mean over wavelength, so that integrals against
//! anything constant over a cell are exact; *node* rows (refractive indices) hold values at the
//! cells' lower ends, linear between.

use super::{NM_MAX, NM_MIN, Spectrum};
use crate::math::lanes::Scalar;

/// Number of cells, a multiple of every number of wavelengths.
pub const CELLS: usize = 4096;

/// a, nm⁻¹.
const STEEPNESS: f64 = 0.0072;
/// Wavelength of the density's peak, nm.
const PEAK: f64 = 538.0;
/// tanh(a (538 − 360)).
const TANH_LOW: f64 = 0.856_910_625_469_828;
/// tanh(a (830 − 538)) + tanh(a (538 − 360)).
const TANH_SPAN: f64 = 1.827_501_972_410_097_8;
/// The wavelength, nm, at cumulative density `u` in 0…1 of p = A/cosh²(a (λ − 538 nm)),
/// a = 0.0072 nm⁻¹, A = a/(tanh(292 a) + tanh(178 a)) (Radziszewski, Boryczko and Alda 2009, with the
/// parameters of pbrt-v4 and Mitsuba 3).
pub fn visible_wavelength(u: f64) -> f64 {
    let nm = PEAK - libm::atanh(TANH_LOW - u * TANH_SPAN) / STEEPNESS;
    nm.clamp(NM_MIN, NM_MAX)
}

/// The inverse of the cumulative density by which heroes are drawn: [`visible_wavelength`] at the
/// edges of the cells, and linear between.
///
/// Each spectrum is averaged over a cell on its own, so that where one jumps inside of a cell, of
/// which it lights the share f, a path of n factors would have fⁿ instead of f. Such a wavelength
/// becomes an edge: the nearest one moves there. All cells stay equally likely; what a sample of a
/// cell stands for follows from its edges, so that the mean of the estimates is the same integral.
#[derive(Debug, Clone, PartialEq)]
pub struct WavelengthGrid {
    edges: Vec<f64>,
}

impl Default for WavelengthGrid {
    fn default() -> Self {
        let inner = (1..CELLS).map(|cell| visible_wavelength(cell as f64 / CELLS as f64));
        let lower = [NM_MIN].into_iter().chain(inner);
        Self {
            edges: lower.chain([NM_MAX]).collect(),
        }
    }
}

impl WavelengthGrid {
    /// The grid for these spectra.
    pub fn new<'a>(spectra: impl IntoIterator<Item = &'a Spectrum>) -> Self {
        let even = Self::default();
        let mut jumps: Vec<f64> = Vec::new();
        for [from, to] in spectra.into_iter().flat_map(Spectrum::rises) {
            let inside = from > NM_MIN && to < NM_MAX;
            // Across several cells, a spectrum is as good as smooth.
            if inside && to - from < even.width_at(from) {
                jumps.extend([from, to]);
            }
        }
        jumps.sort_by(f64::total_cmp);
        jumps.dedup();
        let mut grid = even.clone();
        let mut moved = [false; CELLS + 1];
        for jump in jumps {
            let above = even.edges.partition_point(|edge| *edge < jump);
            // The next one up is for where a lower jump of the same cell has taken the upper edge.
            let mut nearest = [above - 1, above, above + 1];
            if even.edges[above] - jump < jump - even.edges[above - 1] {
                nearest.swap(0, 1);
            }
            // Where all are taken, the jump stays inside of a cell.
            if let Some(&cell) = nearest
                .iter()
                .find(|&&cell| !moved[cell] && grid.fits(cell, jump))
            {
                grid.edges[cell] = jump;
                moved[cell] = true;
            }
        }
        grid
    }

    /// Whether an inner edge may lie there, between its neighbours.
    fn fits(&self, cell: usize, nm: f64) -> bool {
        (1..CELLS).contains(&cell) && self.edges[cell - 1] < nm && nm < self.edges[cell + 1]
    }

    /// Width of the cell that holds a wavelength of the band, nm.
    fn width_at(&self, nm: f64) -> f64 {
        let above = self.edges.partition_point(|edge| *edge <= nm);
        let above = above.clamp(1, CELLS);
        self.edges[above] - self.edges[above - 1]
    }

    /// The cells' edges, one more than cells, nm.
    pub fn edges(&self) -> &[f64] {
        &self.edges
    }

    /// Lower and upper edge of a cell, nm.
    pub fn cell(&self, cell: usize) -> (f64, f64) {
        (self.edges[cell], self.edges[cell + 1])
    }

    /// Wavelength, nm, at cumulative density `u` in 0…1.
    pub fn wavelength(&self, u: f64) -> f64 {
        let place = u * CELLS as f64;
        let cell = (place as usize).min(CELLS - 1);
        let (low, high) = self.cell(cell);
        low + (place - cell as f64) * (high - low)
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
