//! Spectral pictures: radiance summed by pixel, replicate and bin of wavelength.
//!
//! A sample of a path stands for the cell of the wavelength grid it lies in ([`grid`]); its
//! radiance goes to the bins in the proportions in which they share the cell, so that whatever is
//! constant over a cell is binned exactly. Nothing finer than a cell (0.06 nm in the middle of the
//! band, 1 nm at its red end) is resolved.
//!
//! [`grid`]: crate::spectrum::grid

use std::sync::Arc;

use crate::film::pixels::Estimate;
use crate::math::lanes::Scalar;
use crate::sample::replicates::Replicates;
use crate::spectrum::grid::{CELLS, WavelengthGrid};
use crate::spectrum::{NM_MAX, NM_MIN};

/// Neighbouring bins of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct BinGrid {
    centres: Vec<f64>,
    /// nm.
    width: f64,
}

/// How the bins share the cells of a wavelength grid.
#[derive(Debug)]
pub struct Shares {
    bins: usize,
    /// By cell, where its bins are in `shares`; one more than cells.
    starts: Vec<u32>,
    /// Bin, and (number of cells × shared width)/(bin width): what the cell's radiance adds to
    /// the bin's mean.
    shares: Vec<(u32, f64)>,
}

/// Why there can be no such bins.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BinError {
    /// The bin about this wavelength in nm reaches out of the wavelengths that paths carry.
    #[error("the bin at {0} nm reaches out of {NM_MIN} nm to {NM_MAX} nm")]
    Outside(f64),
    /// A width in nm that is not positive, not finite, or makes more bins than there are cells.
    #[error("the bins' width of {0} nm is not one of at most {CELLS} bins")]
    Width(f64),
}

impl BinGrid {
    /// Bins of width `step` nm about `from`, `from + step` … up to `to` nm.
    ///
    /// # Errors
    /// [`BinError`] where a bin would not be inside the band of 360 nm to 830 nm, or where there
    /// would be more bins than cells.
    pub fn new(from: f64, to: f64, step: f64) -> Result<Self, BinError> {
        // Rounded decimals such as (0.7 − 0.4)/0.1 may fall just short of a whole number.
        let steps = ((to - from) / step + 1e-9).floor();
        if !(step > 0.0 && steps >= 0.0 && steps < CELLS as f64) {
            return Err(BinError::Width(step));
        }
        let centres: Vec<f64> = (0..=steps as u32)
            .map(|i| from + f64::from(i) * step)
            .collect();
        let half = step / 2.0;
        let inside = |c: f64| c - half >= NM_MIN && c + half <= NM_MAX;
        if let Some(&centre) = centres.iter().find(|&&c| !inside(c)) {
            return Err(BinError::Outside(centre));
        }
        Ok(Self {
            centres,
            width: step,
        })
    }

    /// Middles of the bins, nm.
    pub fn centres(&self) -> &[f64] {
        &self.centres
    }

    /// How the bins share the cells of a grid.
    pub fn shares(&self, grid: &WavelengthGrid) -> Shares {
        let half = self.width / 2.0;
        let mut starts = vec![0];
        let mut shares = Vec::new();
        for cell in 0..CELLS {
            let (low, high) = grid.cell(cell);
            for (bin, centre) in self.centres.iter().enumerate() {
                let shared = high.min(centre + half) - low.max(centre - half);
                if shared > 0.0 {
                    shares.push((bin as u32, CELLS as f64 * shared / self.width));
                }
            }
            starts.push(shares.len() as u32);
        }
        Shares {
            bins: self.centres.len(),
            starts,
            shares,
        }
    }
}

/// Sums by pixel, replicate and bin.
#[derive(Debug, Clone)]
pub struct Bins {
    shares: Arc<Shares>,
    replicates: Replicates,
    slots: usize,
    sums: Vec<[f64; 1]>,
}

impl Bins {
    /// Zero sums for this many pixels of at most `samples` samples each.
    pub fn new(pixels: usize, shares: Arc<Shares>, replicates: Replicates, samples: u32) -> Self {
        let slots = replicates.count(samples) as usize;
        let sums = vec![[0.0]; pixels * slots * shares.bins];
        Self {
            shares,
            replicates,
            slots,
            sums,
        }
    }

    /// Bytes of the sums of a pixel of at most `samples` samples in one bin.
    pub fn bytes_per_pixel(replicates: Replicates, samples: u32) -> usize {
        replicates.count(samples) as usize * size_of::<[f64; 1]>()
    }

    /// Adds a sample of a pixel: radiance at C wavelengths, whose cells are `row`, `row` + 4096/C
    /// …; a pixel's samples must come in order.
    pub fn add<T: Scalar, const C: usize>(
        &mut self,
        pixel: usize,
        sample: u32,
        radiance: &[T; C],
        row: u32,
    ) {
        let count = self.shares.bins;
        let (replicate, _) = self.replicates.place(sample);
        let place = pixel * self.slots + replicate as usize;
        let sums = &mut self.sums[place * count..][..count];
        for (i, radiance) in radiance.iter().enumerate() {
            let radiance = radiance.to_f64() / C as f64;
            let cell = i * (CELLS / C) + row as usize;
            let [start, end] = [cell, cell + 1].map(|cell| self.shares.starts[cell] as usize);
            for (bin, share) in &self.shares.shares[start..end] {
                sums[*bin as usize][0] += radiance * share;
            }
        }
    }

    /// Radiance of a pixel in a bin, W·m⁻²·sr⁻¹·nm⁻¹; `counts` are the numbers of samples of the
    /// replicates.
    pub fn estimate(&self, pixel: usize, bin: usize, counts: &[f64]) -> Estimate<1> {
        let count = self.shares.bins;
        let sums = &self.sums[pixel * self.slots * count..][..self.slots * count];
        let of_bin = sums[bin..].iter().step_by(count);
        Estimate::new(counts, of_bin, |radiance| radiance)
    }
}
