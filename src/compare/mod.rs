//! Picture against picture, or against a number: how far they are apart, and whether noise alone
//! explains it.
//!
//! A [`Side`] is what is known of one picture: means and variances by channel and pixel. From two
//! sides come the [`metrics`](crate::stats::metrics), and, where both know their variances, a
//! [`Judgement`]: image means by channel, block by block, and the distribution of all blocks, at
//! one level for the whole family; a [`Comparison`] is all of it. [`stale`] finds references whose scene has changed since.

mod blocks;
mod comparison;
mod flip;
mod heatmap;
mod judge;
mod measure;
mod side;
pub mod stale;

pub use blocks::{Block, LEAST_FREEDOM, blocks};
pub use comparison::Comparison;
pub use flip::flip;
pub use heatmap::write_heatmap;
pub use judge::{ChannelJudgement, Judgement, LEVEL, ROUNDING, against_truth, judge};
pub use measure::{ChannelMetrics, Metrics, metrics};
pub use side::{Channel, Side, mean_over};

use std::path::PathBuf;

use crate::film;

/// Why pictures cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// A picture cannot be read.
    #[error(transparent)]
    Film(#[from] film::Error),
    /// A picture without anything to compare.
    #[error("{} has neither R, G, B nor spectral channels S0.…nm", path.display())]
    Channels {
        /// The file.
        path: PathBuf,
    },
    /// Values that are not numbers.
    #[error(
        "{} has {count} values that are not finite in channel {channel}, the first at pixel {},{}",
        path.display(), first[0], first[1]
    )]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// The channel.
        channel: String,
        /// How many.
        count: usize,
        /// Column and row of the first.
        first: [usize; 2],
    },
    /// Variances that are negative or not numbers in places.
    #[error("{} has a variance or standard error that is none in channel {channel}", path.display())]
    Variance {
        /// The file.
        path: PathBuf,
        /// The channel.
        channel: String,
    },
    /// Pictures of different sizes.
    #[error(
        "{} has {}x{} pixels and {} has {}x{}: only pictures of one size can be compared",
        paths[0].display(), sizes[0][0], sizes[0][1], paths[1].display(), sizes[1][0], sizes[1][1]
    )]
    Sizes {
        /// The files.
        paths: [PathBuf; 2],
        /// Width and height of each.
        sizes: [[usize; 2]; 2],
    },
    /// No channel in both.
    #[error(
        "{} and {} share no channel: the first has {}, the second {}",
        paths[0].display(), paths[1].display(), names[0], names[1]
    )]
    NothingShared {
        /// The files.
        paths: [PathBuf; 2],
        /// Their channels.
        names: [String; 2],
    },
}
