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

/// Samples a pixel of the smallest pilot: enough for two replicates of a few points each.
const FIRST: u32 = 8;
/// Camera paths of the smallest pilot of a picture: what one path in ten thousand brings is seen by
/// it but for one case in 700 (0.9999^65536), and it takes milliseconds.
const PATHS: u32 = 1 << 16;
/// How much larger the next pilot is at most.
const GROWTH: f64 = 4.0;

impl Target {
    /// Samples a pixel of the first pilot. A block's share of [`PATHS`] would be too much; it has
    /// 4096 paths in four renders.
    fn first(self, pixels: usize) -> u32 {
        match self {
            Self::Image => FIRST.max(PATHS / pixels.clamp(1, PATHS as usize) as u32),
            Self::Block => 2 * FIRST,
        }
    }

    /// Renders of a pilot. A picture's mean has the degrees of freedom of all its pixels. Of blocks
    /// the largest estimated error counts, which is too large by chance: with four renders of two
    /// replicates a block's standard error has 4 × 64 degrees of freedom, so its relative standard
    /// error is 1/√512, 4 %, and the largest of 10⁴ blocks may be four of those too large.
    fn renders(self) -> u32 {
        match self {
            Self::Image => 1,
            Self::Block => 4,
        }
    }

    /// The picture's samples over those of the last pilot: near enough that the law between the
    /// two hardly matters (scrambled nets have none between powers of two), and so that all
    /// pilots together cost little more than the picture.
    fn near(self) -> f64 {
        match self {
            Self::Image => 2.0,
            Self::Block => 4.0,
        }
    }
}

/// A pilot will do that is so much smaller than it was meant to be.
const SLACK: f64 = 1.5;
/// Slopes of the standard error over samples: independent samples have −1/2, and no sampler here
/// falls faster than −1 for long (smooth integrands, strata: Mitchell 1996).
const SLOPES: [f64; 2] = [-1.0, -0.5];

/// Standard error over mean of what is aimed at; NaN where there is none.
pub fn reached(rendered: &Rendered, target: Target) -> f64 {
    let squares = squares(rendered, target);
    let worst = squares.into_iter().reduce(Squares::larger);
    worst.map_or(0.0, |worst| worst.sum.sqrt())
}

/// Chooses the samples a pixel of a picture of so many pixels, at most `most`. `pilot` renders with
/// this many samples a pixel and a seed that belongs to the number of the pilot; `None` where it
/// was stopped.
pub fn choose(
    goal: Goal,
    pixels: usize,
    most: u32,
    mut pilot: impl FnMut(u32, u32) -> Option<Rendered>,
) -> Option<Chosen> {
    let target = goal.target;
    let (mut samples, mut spent, mut number) = (target.first(pixels).min(most), 0, 0);
    let near = target.near();
    let mut before: Option<(u32, f64)> = None;
    loop {
        let mut sums: Vec<Squares> = Vec::new();
        for _ in 0..target.renders() {
            let squares = squares(&pilot(samples, number)?, target);
            number += 1;
            spent += u64::from(samples);
            sums.resize(squares.len(), Squares::default());
            for (sum, square) in sums.iter_mut().zip(squares) {
                sum.sum += square.sum;
            }
        }
        let worst = sums.into_iter().reduce(Squares::larger).unwrap_or_default();
        let error = (worst.sum / f64::from(target.renders())).sqrt();
        let wanted = f64::from(samples) * times(goal.error, (samples, error), before);
        let enough = wanted <= SLACK * near * f64::from(samples);
        if enough || samples == most || error.is_nan() {
            // Two samples are the least that have a standard error.
            let chosen = (wanted.ceil().min(f64::from(most)) as u32).max(2.min(most));
            return Some(Chosen {
                samples: chosen,
                spent,
                short: wanted > f64::from(most),
            });
        }
        before = Some((samples, error));
        let aimed = (wanted / near).max(2.0 * f64::from(samples));
        let next = (GROWTH * f64::from(samples)).min(aimed).ceil();
        samples = next.min(f64::from(most)) as u32;
    }
}

/// How many times the samples of a pilot the wanted error takes, by the law through the pilot
/// before it.
fn times(wanted: f64, (samples, error): (u32, f64), before: Option<(u32, f64)>) -> f64 {
    let slope = before.map_or(SLOPES[1], |(fewer, larger)| {
        let ratio = f64::from(samples) / f64::from(fewer);
        let slope = libm::log(error / larger) / libm::log(ratio);
        slope.clamp(SLOPES[0], SLOPES[1])
    });
    // Down to fewer samples than the pilot's, strata have gained less than above it.
    let slope = if error < wanted { SLOPES[1] } else { slope };
    libm::pow(wanted / error, 1.0 / slope)
}

/// The squared relative standard error of a mean over pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Squares {
    sum: f64,
}

impl Squares {
    /// Of the mean luminance of these pixels: black ones have no error.
    fn of(pixels: impl Iterator<Item = (f64, f64)>) -> Self {
        let (mut total, mut own) = (0.0, Self::default());
        for (value, error) in pixels {
            let square = error * error;
            total += value;
            own.sum += square;
        }
        if own.sum == 0.0 {
            return Self::default();
        }
        Self {
            sum: own.sum / (total * total),
        }
    }

    /// The larger one; what is no number counts as largest.
    fn larger(self, other: Self) -> Self {
        if self.sum >= other.sum || self.sum.is_nan() {
            self
        } else {
            other
        }
    }
}

/// Squared relative standard errors: one of the picture, or one a block.
fn squares(rendered: &Rendered, target: Target) -> Vec<Squares> {
    let pixels = rendered.xyz();
    let pixel = |i: usize| (pixels[i].mean[1], pixels[i].standard_error[1]);
    match target {
        Target::Image => vec![Squares::of((0..pixels.len()).map(pixel))],
        Target::Block => {
            let window = rendered.window;
            blocks::members(window.width() as usize, window.height() as usize)
                .into_iter()
                .map(|block| Squares::of(block.into_iter().map(pixel)))
                .collect()
        }
    }
}
