//! Picture against picture, or against a number: how far they are apart, and whether noise alone
//! explains the difference.
//!
//! A [`Side`] holds one picture's means and variances by channel and pixel. Two sides have
//! [`metrics`](crate::stats::metrics) and, where the variances of both are known, a
//! [`Judgement`]: image means by channel, block by block, and the distribution of all blocks, at
//! one level for the whole family; a [`Comparison`] is all of it. [`stale`] finds references whose
//! scene has changed since.

mod flip;
mod heatmap;
mod judge;
mod measure;
mod side;
pub mod stale;

pub use flip::flip;
pub use heatmap::write_heatmap;
pub use judge::{ChannelJudgement, Judgement, LEVEL, judge};
pub use measure::{ChannelMetrics, Metrics};
pub use side::{Channel, Side, mean_over};

use std::path::{Path, PathBuf};

use crate::film::{self, Picture};
use crate::stats::metrics::Metric;

/// Why pictures cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// A picture cannot be read.
    #[error(transparent)]
    Film(#[from] film::Error),
    /// A picture without anything to compare.
    #[error("{} has neither R, G, B nor spectral channels S0.…nm", .0.display())]
    Channels(PathBuf),
    /// Values that are infinite or not numbers.
    #[error(
        "{} has {count} values that are not finite in channel {channel}, the first at pixel {},{}",
        path.display(), first[0], first[1]
    )]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// The channel.
        channel: String,
        /// Number of such values.
        count: usize,
        /// Column and row of the first.
        first: [usize; 2],
    },
    /// A file and a channel of it of whose variances some are negative, infinite or not numbers.
    #[error(
        "{} has a variance or standard error that is negative or not finite in channel {}",
        .0.display(), .1
    )]
    Variance(PathBuf, String),
    /// Pictures of different sizes; width and height of each.
    #[error(
        "{} has {}x{} pixels and {} has {}x{}: only pictures of one size can be compared",
        .0[0].display(), .1[0][0], .1[0][1], .0[1].display(), .1[1][0], .1[1][1]
    )]
    Sizes([PathBuf; 2], [[usize; 2]; 2]),
    /// Pictures without a common channel; the channels of each, separated by commas.
    #[error(
        "{} and {} share no channel: the first has {}, the second {}",
        .0[0].display(), .0[1].display(), .1[0], .1[1]
    )]
    NothingShared([PathBuf; 2], [String; 2]),
}

/// How far two pictures are apart, or a picture and a number, and whether noise alone explains it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Comparison {
    /// The metrics by channel; none against a number.
    pub channels: Vec<ChannelMetrics>,
    /// The metrics of R, G and B together.
    pub rgb: Option<Metrics>,
    /// HDR-FLIP of the second picture and the first, the mean over the pixels.
    pub flip: Option<Metric>,
    /// The verdict at the level [`LEVEL`], where variances are known.
    pub judgement: Option<Judgement>,
}

impl Comparison {
    /// Compares a picture with a reference.
    ///
    /// # Errors
    /// [`CompareError`] for pictures of different sizes or without a common channel, and for values
    /// that are not numbers.
    pub fn of(picture: &Picture, reference: &Picture) -> Result<Self, CompareError> {
        let side =
            |name: &str, picture: &Picture| Side::of_picture(Path::new(name), picture.clone());
        Self::of_sides(
            &side("the picture", picture)?,
            &side("the reference", reference)?,
        )
    }

    /// Compares two sides, such as files.
    ///
    /// # Errors
    /// [`CompareError`] for sides of different sizes or without a common channel.
    pub fn of_sides(a: &Side, b: &Side) -> Result<Self, CompareError> {
        let (channels, rgb) = measure::metrics(a, b)?;
        let flip = match (a.rgb(), b.rgb()) {
            (Some(own), Some(reference)) => Some(Metric::mean(&flip(&reference, &own, a.width))),
            _ => None,
        };
        Ok(Self {
            channels,
            rgb,
            flip,
            judgement: judge(a, b, LEVEL),
        })
    }

    /// Judges the image means of a side against a number that each of its pixels is known to have.
    #[must_use]
    pub fn with_truth(a: &Side, truth: f64) -> Self {
        Self {
            channels: Vec::new(),
            rgb: None,
            flip: None,
            judgement: judge::against_truth(a, truth, LEVEL),
        }
    }
}
