//! What a study will cost, from a measured pilot, and what fits into a budget.

use std::time::{Duration, Instant};

use super::axis::Axis;
use super::own::FIRST;
use super::reference::Reference;
use super::subject::Ready;
use crate::chart::Key;
use crate::film::pixels::{Estimate, Pixels};
use crate::render::Unwatched;
use crate::render::seeds::seed;

/// Seconds of a render, measured by a pilot.
#[derive(Debug, Clone, Copy)]
pub struct Cost {
    /// Seconds for one sample in each pixel.
    sample: f64,
    /// Seconds to begin a render, to form its estimates and to compare them.
    render: f64,
}

/// Costs of renders that differ in more than their samples.
#[derive(Debug, Clone)]
pub struct Costs {
    /// One a curve where the abscissa is the number of samples, otherwise one a point.
    pub points: Vec<Cost>,
    /// Of the study's own reference, if it needs one.
    pub reference: Option<Cost>,
    /// Independent renders of each point.
    pub replicates: u32,
}

/// The part of a study that would fit into the budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fits {
    /// Samples a pixel up to this number.
    AxisTo(u32),
    /// This number of samples a pixel at every point.
    Samples(u32),
    NoSamples,
    /// Not even samples a pixel from 1 to this number.
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

/// A study that does not fit into the time or the memory there is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BudgetError {
    #[error(
        "the study would take about {needed:.0} s, its reference included, and may take {budget:.0} s: {fits}"
    )]
    Seconds {
        needed: f64,
        budget: f64,
        /// The least budget that suffices, seconds.
        enough: f64,
        fits: Fits,
    },
    #[error(
        "the study needs about {} MiB of memory, and {} MiB are available: a picture of {}x{} pixels would fit",
        needed >> 20, available >> 20, size[0], size[1]
    )]
    Memory {
        needed: u64,
        available: u64,
        /// The largest picture of the same shape that would fit.
        size: [u64; 2],
    },
}

/// Share of the budget that is planned for: speed varies, and charts and report come after.
const PLANNED: f64 = 0.85;
/// Largest power of two that a planned axis of samples ends at.
const LONGEST_AXIS: u32 = 14;
/// Smallest power of two that it ends at: fewer than four points are no curve.
const SHORTEST_AXIS: u32 = 3;

impl Cost {
    /// Measures what renders of this scene cost, in about this many seconds.
    pub fn pilot(ready: &mut Ready, seconds: f64) -> Self {
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
        let nothing = Reference::uniform(ready.size(), [1.0; 3]);
        std::hint::black_box(nothing.measure(&estimates));
        Self {
            sample: rendered.seconds / f64::from(rendered.samples),
            render: start.elapsed().as_secs_f64() - rendered.seconds,
        }
    }

    pub fn seconds(self, samples: u32) -> f64 {
        self.render + self.sample * f64::from(samples)
    }
}

impl Costs {
    /// Seconds of all renders of points with these samples a pixel, and of the reference.
    fn seconds(&self, points: impl Iterator<Item = (Cost, u32)> + Clone) -> f64 {
        let most = points.clone().map(|(_, samples)| samples).max();
        let reference = self.reference.map_or(0.0, |cost| {
            f64::from(FIRST) * cost.seconds(most.unwrap_or(0))
        });
        let points: f64 = points.map(|(cost, samples)| cost.seconds(samples)).sum();
        f64::from(self.replicates) * points + reference
    }

    /// The axis of samples 1, 2, 4 … that fits into the budget.
    ///
    /// # Errors
    /// [`BudgetError::Seconds`] where not even the shortest axis fits.
    pub fn plan(&self, budget: f64) -> Result<Axis, BudgetError> {
        let seconds = |longest: u32| {
            let with = |samples| self.points.iter().map(move |cost| (*cost, samples));
            self.seconds((0..=longest).flat_map(|k| with(1 << k)))
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

    /// Checks that points with these samples a pixel fit.
    ///
    /// # Errors
    /// [`BudgetError::Seconds`] with the largest number of samples that would.
    pub fn check(
        &self,
        abscissa: Key,
        points: &[(Cost, u32)],
        budget: f64,
    ) -> Result<(), BudgetError> {
        let all = || points.iter().copied();
        let needed = self.seconds(all());
        if needed <= budget {
            return Ok(());
        }
        let fits = if abscissa == Key::Spp {
            let fits =
                |end: &u32| self.seconds(all().filter(|(_, samples)| samples <= end)) <= budget;
            let ends = all().map(|(_, samples)| samples);
            ends.filter(fits).max().map(Fits::AxisTo)
        } else {
            let most = all().map(|(_, samples)| samples).max().unwrap_or(1);
            let fits = |n: &u32| self.seconds(all().map(|(cost, _)| (cost, *n))) <= budget;
            let mut smaller = (0..most.ilog2()).rev().map(|k| 1 << k);
            smaller.find(fits).map(Fits::Samples)
        };
        Err(BudgetError::Seconds {
            needed,
            budget,
            enough: needed.ceil(),
            fits: fits.unwrap_or(Fits::NoSamples),
        })
    }
}

/// Checks that pictures of this size can be rendered and compared with this much memory.
///
/// # Errors
/// [`BudgetError::Memory`] with the largest picture that would fit.
pub fn check_memory(largest: &Ready, available: u64) -> Result<(), BudgetError> {
    let image = &largest.scene.image;
    let sums = Pixels::bytes_per_pixel(largest.plan.choices.replicates, image.spp);
    // The render: sums, estimates and their planes; the reference and the sums it is made from:
    // values and variances; the picture kept for the report: three colours.
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
