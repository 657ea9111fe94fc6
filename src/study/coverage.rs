//! Coverage of error bars: how often 95 % intervals of blocks of pixels hold the truth.
//!
//! An interval from few contributing samples holds less often than it says. For a mean of n
//! independent samples of skewness γ and excess κ, Student's two-sided interval of level α misses
//! its coverage by
//!
//!   2 φ(z) z [κ (z² − 3)/12 − γ² (z⁴ + 2 z² − 3)/18]/n,   z the normal quantile
//!
//! to first order (P. Hall, *The Bootstrap and Edgeworth Expansion*, 1992, section 2.6; what the
//! formula has besides is what t instead of z is there for). Where a sample contributes with a
//! small probability p, always the same, γ² = κ = 1/p, so that n/γ² is the number of samples that
//! contribute; this quotient is what is called that number here, whatever the contributions are.
//! At 95 % the coverage then misses by −0.231 over it: it is at least 94 % from 24 contributing
//! samples on, which is [`ENOUGH`].

use super::subject::Ready;
use crate::render::Unwatched;
use crate::stats::Estimate;
use crate::stats::blocks::{EDGE, members};

/// Probability with which a 95 % interval misses.
const LEVEL: f64 = 0.05;

/// Contributing samples from which an interval must have the coverage it states.
pub const ENOUGH: f64 = 24.0;

/// Samples of a pixel in one render of the [`Survey`]: the largest number of replicates, so that each
/// is a single sample.
pub const SURVEY: u32 = 64;

/// Central moments of every pixel's samples, from independent sampling.
#[derive(Debug, Clone)]
pub struct Survey {
    size: [usize; 2],
    count: f64,
    /// Mean and sums of second and third powers of deviations.
    moments: Vec<[f64; 3]>,
}

/// A block of pixels as the survey found it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Its mean luminance.
    pub truth: Estimate,
    /// (Σ μ₂)³/(Σ μ₃)² over its pixels: contributing samples for each sample a pixel.
    pub contributing: f64,
}

/// How many intervals of blocks held the truth, by the number of contributing samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Coverage {
    /// Blocks with at least [`ENOUGH`] contributing samples.
    pub enough: Count,
    /// Blocks with fewer.
    pub few: Count,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Count {
    /// Intervals that held the truth.
    pub held: u64,
    /// All intervals.
    pub all: u64,
}

impl Count {
    pub fn share(self) -> f64 {
        self.held as f64 / self.all as f64
    }

    pub fn plus(self, other: Self) -> Self {
        Self {
            held: self.held + other.held,
            all: self.all + other.all,
        }
    }
}

impl Coverage {
    pub fn plus(self, other: Self) -> Self {
        Self {
            enough: self.enough.plus(other.enough),
            few: self.few.plus(other.few),
        }
    }
}

impl Survey {
    /// Surveys a scene that samples independently, with [`SURVEY`] samples a pixel in as many
    /// replicates, by this number of renders.
    pub fn new(ready: &mut Ready, renders: u32) -> Self {
        let size = ready.size();
        let mut survey = Self {
            size,
            count: 0.0,
            moments: vec![[0.0; 3]; size[0] * size[1]],
        };
        for render in 0..renders {
            let rendered = ready.render(render, &mut Unwatched);
            let samples = rendered.replicate_luminances();
            for (moments, values) in survey.moments.iter_mut().zip(&samples) {
                for (i, value) in values.iter().enumerate() {
                    add(moments, survey.count + i as f64, *value);
                }
            }
            survey.count += f64::from(SURVEY);
        }
        survey
    }

    /// The blocks of the picture; `None` where all samples agree and there is nothing to estimate.
    pub fn blocks(&self) -> Vec<Option<Block>> {
        let of = |members: &Vec<usize>| {
            let sum = |k: usize| members.iter().map(|i| self.moments[*i][k]).sum::<f64>();
            let (second, third) = (sum(1) / self.count, sum(2) / self.count);
            let pixels = members.len() as f64;
            let truth = Estimate {
                value: sum(0) / pixels,
                standard_error: (second / self.count).sqrt() / pixels,
                freedom: f64::INFINITY,
            };
            (second > 0.0).then_some(Block {
                truth,
                contributing: second * second * second / (third * third),
            })
        };
        let blocks = members(self.size[0], self.size[1], EDGE);
        blocks.iter().map(of).collect()
    }
}

/// Adds a value to the mean and the sums of the second and third power of deviations of `count`
/// values (T. B. Terriberry, "Computing Higher-Order Moments Online", 2007).
fn add(moments: &mut [f64; 3], count: f64, value: f64) {
    let [mean, second, third] = moments;
    let n = count + 1.0;
    let step = (value - *mean) / n;
    let term = (value - *mean) * step * count;
    *third += term * step * (n - 2.0) - 3.0 * step * *second;
    *second += term;
    *mean += step;
}

/// Counts the blocks whose intervals held the truth in one render.
pub fn cover(ready: &mut Ready, render: u32, blocks: &[Option<Block>]) -> Coverage {
    let rendered = ready.render(render, &mut Unwatched);
    let samples = f64::from(rendered.samples);
    let mut coverage = Coverage::default();
    for (own, block) in rendered.block_luminances().iter().zip(blocks) {
        let Some(block) = block else { continue };
        let held = own.minus(&block.truth).p_value(0.0, 0.0) >= LEVEL;
        let enough = samples * block.contributing >= ENOUGH;
        let count = if enough {
            &mut coverage.enough
        } else {
            &mut coverage.few
        };
        count.all += 1;
        count.held += u64::from(held);
    }
    coverage
}
