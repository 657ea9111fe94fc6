//! How many samples a wanted error takes, chosen without bias in the picture.
//!
//! A render that stops when its own samples say that it is good stops early where they happen to
//! agree, and so is biased (D. Kirk and J. Arvo, "Unbiased Sampling Techniques for Image
//! Synthesis", SIGGRAPH 1991). Here pilots with seeds of their own say how the error falls; they
//! choose the number of samples and are thrown away, and the picture is rendered afresh.

use super::session::Rendered;
use crate::stats::blocks;

/// The quantity whose error is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The mean luminance of the picture.
    Image,
    /// The mean luminance of the picture's worst block of 8 × 8 pixels.
    Block,
}

/// A wanted error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The quantity.
    pub target: Target,
    /// Standard error of the quantity over its value.
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
/// Camera paths of the smallest pilot of a picture, which takes milliseconds: light that one path in
/// ten thousand brings is missed in one case of 700 (0.9999^65536).
const PATHS: u32 = 1 << 16;
/// Samples of a pilot over those of the one before, at most.
const GROWTH: f64 = 4.0;

impl Target {
    /// Samples a pixel of the first pilot. A block's share of [`PATHS`] would be too much; it has
    /// 1024 paths, and as many again until its error is known.
    fn first(self, pixels: usize) -> u32 {
        match self {
            Self::Image => FIRST.max(PATHS / pixels.clamp(1, PATHS as usize) as u32),
            Self::Block => 2 * FIRST,
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

/// Degrees of freedom k that the worst place's variance is to have: its square root, the error,
/// then has a relative standard error of 1/√(2k), 18 %. A block of 64 alike pixels has them at
/// once; one whose variance is all in one pixel, at the edge of a lamp, by sixteen renders.
const FREEDOM: f64 = 16.0;
/// Renders of a pilot at most: a variance that rare paths bear would go on without end.
const RENDERS: u32 = 16;
/// A pilot is large enough if it is smaller than it was meant to be by no more than this factor.
const SLACK: f64 = 1.5;
/// Slopes of the standard error over samples: independent samples have −1/2, and no sampler here
/// falls faster than −1 for long (smooth integrands, strata: Mitchell 1996).
const SLOPES: [f64; 2] = [-1.0, -0.5];

/// Standard error over mean of the quantity in a finished render; NaN where it is not known.
pub fn reached(rendered: &Rendered, target: Target) -> f64 {
    let mut pilot = Pilot::default();
    pilot.add(rendered, target);
    pilot.worst()[0].sqrt()
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
        let mut joined = Pilot::default();
        let error = loop {
            joined.add(&pilot(samples, number)?, target);
            number += 1;
            spent += u64::from(samples);
            if joined.is_certain() {
                break joined.error();
            }
        };
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

/// Sums over the renders of a pilot for one place: the whole picture or a block.
#[derive(Debug, Clone, Copy, Default)]
struct Place {
    /// Sum of the pixels' luminances.
    total: f64,
    /// Sum of their variances.
    variance: f64,
    /// Sum of the squares of the variances.
    square: f64,
}

/// The squared relative error, and its degrees of freedom, of a value that is known exactly.
const EXACT: [f64; 2] = [0.0, f64::INFINITY];

/// Joined renders of equally many samples: one place for the picture, or one for each block.
#[derive(Debug, Default)]
struct Pilot {
    places: Vec<Place>,
    renders: u32,
    /// Degrees of freedom of a pixel's variance.
    freedom: f64,
}

impl Pilot {
    fn add(&mut self, rendered: &Rendered, target: Target) {
        let pixels = rendered.xyz();
        let window = rendered.window;
        let [width, height] = [window.width(), window.height()].map(|n| n as usize);
        let blocks = match target {
            Target::Image => vec![(0..pixels.len()).collect()],
            Target::Block => blocks::members(width, height, blocks::EDGE),
        };
        self.places.resize(blocks.len(), Place::default());
        for (place, block) in self.places.iter_mut().zip(blocks) {
            for pixel in block {
                let variance = pixels[pixel].standard_error[1].powi(2);
                place.total += pixels[pixel].mean[1];
                place.variance += variance;
                place.square += variance * variance;
            }
        }
        self.renders += 1;
        self.freedom = f64::from(rendered.replicates()) - 1.0;
    }

    /// The largest squared relative standard error of a place, NaN where one has none, and its degrees
    /// of freedom (see [`Estimate::mean_of`](crate::stats::Estimate::mean_of)).
    fn worst(&self) -> [f64; 2] {
        let places = self.places.iter().map(|place| self.relative(place));
        places.fold(
            EXACT,
            |a, b| {
                if a[0] >= b[0] || a[0].is_nan() { a } else { b }
            },
        )
    }

    /// The same of one place; one without variance, such as a black one, has no error.
    fn relative(&self, place: &Place) -> [f64; 2] {
        if place.variance == 0.0 {
            return EXACT;
        }
        let square = f64::from(self.renders) * place.variance / (place.total * place.total);
        let freedom = (self.freedom + 2.0) * place.variance * place.variance / place.square;
        [square, freedom.max(self.freedom)]
    }

    fn is_certain(&self) -> bool {
        self.renders == RENDERS || self.worst()[1] >= FREEDOM
    }

    /// Relative standard error to plan with. Samples in proportion to an estimated variance s² of
    /// k degrees of freedom leave the picture σ²/s² times the wanted one, on average k/(k − 2)
    /// (the mean of an inverse χ²); s² is taken that much larger.
    fn error(&self) -> f64 {
        let [square, freedom] = self.worst();
        let larger = if freedom.is_finite() {
            freedom / (freedom - 2.0).max(1.0)
        } else {
            1.0
        };
        (square * larger).sqrt()
    }
}
