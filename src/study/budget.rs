//! What a study will cost, from a measured pilot, and what fits into a budget.

use std::time::{Duration, Instant};

use super::axis::Axis;
use super::grid::{Grid, Point};
use super::measure::measure;
use super::own::FIRST;
use super::reference::Reference;
use crate::render::seeds::seed;
use super::subject::Ready;
use crate::chart::Key;
use crate::film::pixels::{Estimate, Pixels};
use crate::render::Unwatched;

/// What a render costs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cost {
    /// Seconds for one sample in each pixel.
    pub sample: f64,
    /// Seconds to begin a render, to form its estimates and to compare them.
    pub render: f64,
}

/// What a whole study costs.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimated {
    /// Cost of each point, in the grid's order.
    pub points: Vec<Cost>,
    /// Cost of the study's own reference, if it needs one.
    pub reference: Option<Cost>,
    /// Independent renders of each point.
    pub replicates: u32,
}

/// What of a study would fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fits {
    /// An axis of samples a pixel that ends here.
    AxisTo(u32),
    /// So many samples a pixel at every point.
    Samples(u32),
    /// No number of samples.
    NoSamples,
    /// Not even an axis of samples a pixel that ends here.
    NoAxisTo(u32),
}

impl std::fmt::Display for Fits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::AxisTo(end) => write!(f, "an axis that ends at spp={end} would fit"),
            Self::Samples(n) => write!(f, "{n} samples a pixel would fit"),
            Self::NoSamples => f.write_str("no number of samples does"),
            Self::NoAxisTo(end) => write!(f, "even spp from 1 to {end} does not fit"),
        }
    }
}

/// Why a study is not begun.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BudgetError {
    /// It would take too long.
    #[error(
        "the study would take about {needed:.0} s, its reference included, and may take {budget:.0} s: {fits}"
    )]
    Seconds {
        /// Estimated seconds.
        needed: f64,
        /// Allowed seconds.
        budget: f64,
        /// A budget that would do, seconds.
        enough: f64,
        /// What would fit.
        fits: Fits,
    },
    /// It would not fit into memory.
    #[error(
        "the study needs about {} MiB of memory, and {} MiB are available: a picture of {}x{} pixels would fit",
        needed >> 20, available >> 20, size[0], size[1]
    )]
    Memory {
        /// Estimated bytes.
        needed: u64,
        /// Bytes there are.
        available: u64,
        /// The largest picture of the same shape that would fit.
        size: [u64; 2],
    },
}

/// Share of the budget that is planned for: clocks vary, and charts and report come after.
const PLANNED: f64 = 0.85;
/// Largest power of two that a planned axis of samples ends at.
const LONGEST_AXIS: u32 = 14;
/// The smallest: fewer than four points are no curve.
const SHORTEST_AXIS: u32 = 3;

/// Measures what renders of this scene cost, in about this many seconds.
pub fn pilot(ready: &mut Ready, seconds: f64) -> Cost {
    let base = seed(ready.scene.image.seed, "pilot", 0);
    // Strata are cut for a known number of samples; the other samplers go on as long as wanted.
    let samples = if ready.scene.image.sampler.needs_count() {
        ready.scene.image.spp
    } else {
        ready.scene.image.spp.max(1 << 16)
    };
    let time = Duration::from_secs_f64(seconds);
    let start = Instant::now();
    let rendered = ready.render_for(base, samples, Some(time), &mut Unwatched);
    let estimates = rendered.rgb();
    let [width, height] = ready.scene.image.size.map(|n| n as usize);
    let nothing = Reference::uniform([width, height], [1.0; 3]);
    std::hint::black_box(measure(&estimates, &nothing));
    Cost {
        sample: rendered.seconds / f64::from(rendered.samples),
        render: start.elapsed().as_secs_f64() - rendered.seconds,
    }
}

impl Estimated {
    /// Seconds of the points and the reference where each point has its number of samples.
    pub fn seconds(&self, samples: &[u32]) -> f64 {
        let points: f64 = self
            .points
            .iter()
            .zip(samples)
            .map(|(cost, spp)| cost.render + cost.sample * f64::from(*spp))
            .sum();
        let most = samples.iter().copied().max().unwrap_or(0);
        let reference = self.reference.map_or(0.0, |cost| {
            f64::from(FIRST) * (cost.render + cost.sample * f64::from(most))
        });
        f64::from(self.replicates) * points + reference
    }
}

/// The axis of samples 1, 2, 4 … that fits into the budget, for curves of these costs.
///
/// # Errors
/// [`BudgetError::Seconds`] where not even the shortest axis fits.
pub fn plan(curves: &Estimated, budget: f64) -> Result<Axis, BudgetError> {
    let seconds = |longest: u32| {
        let samples: Vec<u32> = (0..=longest).map(|k| 1 << k).collect();
        let whole = Estimated {
            points: samples.iter().flat_map(|_| curves.points.clone()).collect(),
            ..curves.clone()
        };
        let each = samples.iter().flat_map(|s| vec![*s; curves.points.len()]);
        whole.seconds(&each.collect::<Vec<_>>())
    };
    let fits = |longest: &u32| seconds(*longest) <= PLANNED * budget;
    let longest = (SHORTEST_AXIS..=LONGEST_AXIS).rev().find(fits);
    let longest = longest.ok_or_else(|| {
        let needed = seconds(SHORTEST_AXIS);
        BudgetError::Seconds {
            needed,
            budget,
            enough: (needed / PLANNED).ceil(),
            fits: Fits::NoAxisTo(1 << SHORTEST_AXIS),
        }
    })?;
    Ok(Axis {
        key: Key::Spp,
        values: (0..=longest).map(|k| (1u32 << k).to_string()).collect(),
    })
}

/// Checks that a grid with these samples at its points fits.
///
/// # Errors
/// [`BudgetError::Seconds`] with the largest number of samples that would.
pub fn check(
    grid: &Grid,
    points: &[Point],
    samples: &[u32],
    cost: &Estimated,
    budget: f64,
) -> Result<f64, BudgetError> {
    let needed = cost.seconds(samples);
    if needed <= budget {
        return Ok(needed);
    }
    let fits = if grid.abscissa.key == Key::Spp {
        shorter(points, samples, cost, budget).map(Fits::AxisTo)
    } else {
        let most = samples.iter().copied().max().unwrap_or(1);
        let fits = |n: &u32| cost.seconds(&vec![*n; points.len()]) <= budget;
        let smaller = (0..most.ilog2()).rev().map(|k| 1 << k).find(fits);
        smaller.map(Fits::Samples)
    };
    let fits = fits.unwrap_or(Fits::NoSamples);
    Err(BudgetError::Seconds {
        needed,
        budget,
        enough: needed.ceil(),
        fits,
    })
}

/// The largest end of an axis of samples that fits.
fn shorter(points: &[Point], samples: &[u32], cost: &Estimated, budget: f64) -> Option<u32> {
    let mut ends: Vec<u32> = samples.to_vec();
    ends.sort_unstable();
    ends.dedup();
    let seconds = |end: u32| {
        let kept = |i: &usize| samples[*i] <= end;
        let kept: Vec<usize> = (0..points.len()).filter(kept).collect();
        let part = Estimated {
            points: kept.iter().map(|i| cost.points[*i]).collect(),
            ..cost.clone()
        };
        part.seconds(&kept.iter().map(|i| samples[*i]).collect::<Vec<_>>())
    };
    ends.into_iter().rev().find(|end| seconds(*end) <= budget)
}

/// Checks that pictures of this size can be rendered and compared with this much memory.
///
/// # Errors
/// [`BudgetError::Memory`] with the largest picture that would fit.
pub fn check_memory(largest: &Ready, available: u64) -> Result<(), BudgetError> {
    let image = &largest.scene.image;
    let sums = Pixels::bytes_per_pixel(largest.plan.choices.replicates, image.spp);
    // Of the render the sums, the estimates and their planes; of the reference and of its own
    // making, values and variances; of pictures kept for the report, three colours.
    let numbers = 3 + 2 * 6 + 3;
    let pixel = (sums + size_of::<Estimate>() + numbers * size_of::<f64>()) as u64;
    let [width, height] = image.size.map(u64::from);
    let needed = width.saturating_mul(height).saturating_mul(pixel);
    if needed <= available {
        return Ok(());
    }
    let scale = (available as f64 / needed as f64).sqrt();
    Err(BudgetError::Memory {
        needed,
        available,
        size: [width, height].map(|n| ((n as f64 * scale) as u64).max(1)),
    })
}
