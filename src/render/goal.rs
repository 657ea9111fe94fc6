//! How many samples a wanted error takes, without letting the answer bend the picture.
//!
//! A render that stops when its own samples say that it is good stops early where they happen to
//! agree, and so is biased (D. Kirk and J. Arvo, "Unbiased Sampling Techniques for Image
//! Synthesis", SIGGRAPH 1991). Here pilots with seeds of their own say how the error falls; they
//! choose the number of samples and are thrown away, and the picture is rendered afresh.

use super::blocks;
use super::session::Rendered;

/// What the wanted error is an error of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The mean luminance of the picture.
    Image,
    /// The mean luminance of its worst block of 8 × 8 pixels.
    Block,
}

/// What is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Of what.
    pub target: Target,
    /// Standard error over value.
    pub error: f64,
}

/// The number of samples that was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chosen {
    /// Samples a pixel.
    pub samples: u32,
    /// Samples a pixel that the pilots took.
    pub spent: u64,
    /// Whether the goal asks for more samples than are allowed.
    pub short: bool,
}

/// Samples a pixel of the first pilot: enough for two replicates of a few points each.
const FIRST: u32 = 8;
/// How much larger the next pilot is.
const GROWTH: u32 = 4;
/// Renders of a pilot. The largest of many estimated errors is too large by chance; with four
/// renders a block's standard error has 4 × 64 degrees of freedom with two replicates, so its
/// relative standard error is 1/√512, 4 %, and the largest of 10⁴ blocks about 4 of those too large.
const RENDERS: u32 = 4;
/// A pilot is large enough when the goal asks for no more than so many times its samples: then
/// all pilots together take about two thirds of the picture's time.
const NEAR: f64 = 8.0;
/// Slopes of the standard error over samples: independent samples have −1/2, and no sampler here
/// falls faster than −1 for long (smooth integrands, strata: Mitchell 1996).
const SLOPES: [f64; 2] = [-1.0, -0.5];

/// Standard error over mean, of what is aimed at: black blocks have none.
pub fn reached(rendered: &Rendered, target: Target) -> f64 {
    errors(rendered, target)
        .into_iter()
        .map(f64::sqrt)
        .fold(0.0, largest)
}

/// Chooses the samples a pixel, at most `most`. `pilot` renders with this many samples a pixel and
/// a seed that belongs to the number of the pilot; `None` where it was stopped.
pub fn choose(
    goal: Goal,
    most: u32,
    mut pilot: impl FnMut(u32, u32) -> Option<Rendered>,
) -> Option<Chosen> {
    let (mut samples, mut spent, mut number) = (FIRST.min(most), 0, 0);
    let mut before: Option<(u32, f64)> = None;
    loop {
        let mut sums: Vec<f64> = Vec::new();
        for _ in 0..RENDERS {
            let squares = errors(&pilot(samples, number)?, goal.target);
            number += 1;
            spent += u64::from(samples);
            sums.resize(squares.len(), 0.0);
            for (sum, square) in sums.iter_mut().zip(squares) {
                *sum += square / f64::from(RENDERS);
            }
        }
        let error = sums.into_iter().map(f64::sqrt).fold(0.0, largest);
        let slope = before.map_or(SLOPES[1], |(fewer, larger)| {
            let times = f64::from(samples) / f64::from(fewer);
            let slope = libm::log(error / larger) / libm::log(times);
            slope.clamp(SLOPES[0], SLOPES[1])
        });
        // Down to fewer samples than the pilot's, strata have gained less than above it.
        let slope = if error < goal.error { SLOPES[1] } else { slope };
        let times = libm::pow(goal.error / error, 1.0 / slope);
        let wanted = f64::from(samples) * times;
        // Two samples are the least that have a standard error.
        let enough = (wanted.ceil().min(f64::from(most)) as u32).max(2.min(most));
        if times <= NEAR || samples >= most / GROWTH {
            return Some(Chosen {
                samples: enough,
                spent,
                short: wanted > f64::from(most),
            });
        }
        before = Some((samples, error));
        samples *= GROWTH;
    }
}

/// The larger number; what is no number counts as largest.
fn largest(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// Squared relative standard errors: one of the picture, or one a block.
fn errors(rendered: &Rendered, target: Target) -> Vec<f64> {
    let relative = |value: f64, error: f64| {
        let ratio = if error == 0.0 { 0.0 } else { error / value };
        ratio * ratio
    };
    match target {
        Target::Image => {
            let mean = rendered.mean_luminance();
            vec![relative(mean.value, mean.standard_error)]
        }
        Target::Block => blocks::luminances(rendered)
            .iter()
            .map(|block| relative(block.value, block.standard_error))
            .collect(),
    }
}
