//! Blocks of pixels: small enough to see where pictures differ, large enough that their means are
//! nearly normal.

use super::{Channel, mean_over};
use crate::stats::Estimate;
use crate::stats::blocks::{EDGE, members};

/// Most blocks along an edge of the picture: more would share the level among so many that each
/// sees less.
const MOST: usize = 32;
/// Degrees of freedom below which a block does not count: its error rests on a few bright samples,
/// and the law of its mean is neither Student's nor known. (With 20, Student's quantile at 1e-6 is
/// 1.4 times the normal one.)
pub const LEAST_FREEDOM: f64 = 20.0;

/// Where a channel of two pictures is compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Its first column and row.
    pub corner: [usize; 2],
    /// Its edge in pixels; blocks at the right and lower border may be smaller.
    pub edge: usize,
    /// The first picture's mean minus the second's.
    pub difference: Estimate,
    /// The second's mean.
    pub reference: f64,
}

/// The blocks of a channel of two pictures `width` × `height`, with the degrees of freedom of each
/// picture's variances; `None` where a variance is unknown.
#[must_use]
pub fn blocks(
    a: (&Channel, f64),
    b: (&Channel, f64),
    width: usize,
    height: usize,
) -> Option<Vec<Block>> {
    let edge = EDGE.max(width.max(height).div_ceil(MOST));
    let block = |pixels: Vec<usize>| {
        let first = *pixels.first()?;
        let reference = mean_over(b.0, b.1, Some(&pixels))?;
        let difference = mean_over(a.0, a.1, Some(&pixels))?.minus(&reference);
        Some(Block {
            corner: [first % width, first / width],
            edge,
            difference,
            reference: reference.value,
        })
    };
    let all = members(width, height, edge);
    all.into_iter().map(block).collect()
}
