//! Sums over samples, and the means and standard errors that follow from them.
//!
//! Every pixel keeps one sum a replicate, in f64, added in the order of its samples; means,
//! standard errors and the picture's colours are formed from those sums alone, so they do not
//! depend on how the work was shared out.

use std::ops::Range;

use crate::math::lanes::Scalar;
use crate::sample::replicates::Replicates;

/// Sums of X, Y, Z by pixel and replicate.
#[derive(Debug, Clone)]
pub struct Pixels {
    replicates: Replicates,
    slots: usize,
    sums: Vec<[f64; 3]>,
}

/// A pixel's mean and, where replicates allow, its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate<const N: usize = 3> {
    /// Mean of each channel.
    pub mean: [f64; N],
    /// Standard error of each mean; NaN with a single replicate.
    pub standard_error: [f64; N],
}

impl<const N: usize> Estimate<N> {
    /// The estimate where there are no samples.
    pub const UNKNOWN: Self = Self {
        mean: [f64::NAN; N],
        standard_error: [f64::NAN; N],
    };

    /// Estimates from the sums over each replicate's samples, whose numbers are `counts`; channels are
    /// mapped by `channels`.
    ///
    /// With nᵣ samples in replicate r and m its mean, the squared standard error is
    /// Σ nᵣ (mᵣ − m)²/((K − 1) Σ nᵣ), unbiased where a replicate's variance falls as 1/nᵣ, and for
    /// any law where all have the same number.
    #[inline]
    pub fn new<'a>(
        counts: &[f64],
        sums: impl Iterator<Item = &'a [f64; N]> + Clone,
        channels: impl Fn([f64; N]) -> [f64; N],
    ) -> Self {
        let total: f64 = counts.iter().sum();
        let mut sum = [0.0; N];
        for replicate in sums.clone() {
            for (sum, value) in sum.iter_mut().zip(replicate) {
                *sum += value;
            }
        }
        let mean = channels(sum.map(|s| s / total));
        let mut squares = [0.0; N];
        for (own, replicate) in counts.iter().zip(sums) {
            let own_mean = channels(replicate.map(|s| s / own));
            for ((square, own_mean), mean) in squares.iter_mut().zip(own_mean).zip(mean) {
                *square += own * (own_mean - mean) * (own_mean - mean);
            }
        }
        let freedom = match counts {
            [] | [_] => f64::NAN,
            _ => counts.len() as f64 - 1.0,
        };
        Self {
            mean,
            standard_error: squares.map(|s| (s / (freedom * total)).sqrt()),
        }
    }
}

/// Whether all three are numbers. (The sum of f64 overflows only beyond what an f32 can hold or any
/// radiance can be.)
#[inline]
pub fn is_finite<T: Scalar>(xyz: &[T; 3]) -> bool {
    let [x, y, z] = xyz;
    (x.to_f64() + y.to_f64() + z.to_f64()).is_finite()
}

impl Pixels {
    /// Zero sums for this many pixels of at most `samples` samples each.
    pub fn new(pixels: usize, replicates: Replicates, samples: u32) -> Self {
        let slots = replicates.count(samples) as usize;
        Self {
            replicates,
            slots,
            sums: vec![[0.0; 3]; pixels * slots],
        }
    }

    /// Bytes of the sums of a pixel of at most `samples` samples.
    pub fn bytes_per_pixel(replicates: Replicates, samples: u32) -> usize {
        replicates.count(samples) as usize * size_of::<[f64; 3]>()
    }

    /// Adds samples of a pixel, which must come in order, and leaves out those that are not numbers;
    /// returns how many.
    pub fn add<T: Scalar>(&mut self, pixel: usize, samples: Range<u32>, values: &[[T; 3]]) -> u64 {
        let sums = &mut self.sums[pixel * self.slots..][..self.slots];
        let mut rejected = 0;
        for (sample, xyz) in samples.zip(values) {
            if !is_finite(xyz) {
                rejected += 1;
                continue;
            }
            let (replicate, _) = self.replicates.place(sample);
            for (sum, value) in sums[replicate as usize].iter_mut().zip(xyz) {
                *sum += value.to_f64();
            }
        }
        rejected
    }

    /// Mean of a pixel's samples in each of its replicates, whose numbers of samples are `counts`.
    pub fn replicate_means(&self, pixel: usize, counts: &[f64]) -> impl Iterator<Item = [f64; 3]> {
        let sums = &self.sums[pixel * self.slots..][..self.slots];
        sums.iter()
            .zip(counts)
            .map(|(sum, own)| sum.map(|s| s / own))
    }

    /// Mean and standard error of a pixel, channels mapped by `channels`; `counts` are the numbers of
    /// samples of its replicates.
    #[inline]
    pub fn estimate(
        &self,
        pixel: usize,
        counts: &[f64],
        channels: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Estimate {
        let sums = &self.sums[pixel * self.slots..][..self.slots];
        Estimate::new(counts, sums.iter(), channels)
    }
}
