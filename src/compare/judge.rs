//! Whether noise alone explains how two pictures differ.
//!
//! Three kinds of tests share the level of the family in equal parts: the image mean of each
//! channel; the mean of each block of each channel, of which the worst counts (Šidák); and the
//! distribution of each channel's blocks (Anderson and Darling), which sees error bars that are too
//! small as well as differences everywhere. Standard errors of both sides add up in squares, with
//! Welch's degrees of freedom.

use super::measure::shared;
use super::{Channel, Side, mean_over};
use crate::stats::blocks::{EDGE, members};
use crate::stats::family::sidak;
use crate::stats::uniformity::anderson_darling;
use crate::stats::{Estimate, student};

/// Probability of calling honest pictures inconsistent.
pub const LEVEL: f64 = 1e-3;
/// Relative difference that rounding may make: about four roundings of single precision, 2⁻²⁴
/// each, a segment over a dozen segments, were they all to go the same way.
pub const ROUNDING: f64 = 48.0 / 16_777_216.0;

const KINDS: f64 = 3.0;
/// Most blocks along an edge of the picture: more would share the level among so many that each
/// sees less.
const MOST: usize = 32;
/// Degrees of freedom below which a block does not count: its error rests on a few bright samples,
/// and the law of its mean is neither Student's nor known. (With 20, Student's quantile at 1e-6 is
/// 1.4 times the normal one.)
const LEAST_FREEDOM: f64 = 20.0;

/// The verdict of all tests.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Judgement {
    /// Whether no test rejects.
    pub consistent: bool,
    /// Probability of a false alarm of all tests together.
    pub level: f64,
    /// The tests of each channel.
    pub channels: Vec<ChannelJudgement>,
}

/// The tests of a channel.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ChannelJudgement {
    /// Name of the channel.
    pub channel: String,
    /// Mean of the first picture minus that of the second, divided by the second's unless that is 0.
    pub relative_bias: f64,
    /// Standard error of the bias, from the variances of both.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error.
    pub freedom: f64,
    /// Two-sided p-value of the mean.
    pub p_value: f64,
    /// Smallest relative bias of the image mean that would have been caught, 39 times in 40.
    pub smallest_caught: f64,
    /// The tests of the blocks; `None` against a number.
    pub blocks: Option<BlockJudgement>,
    /// A sentence for each test that rejects.
    pub rejected: Vec<String>,
}

/// The tests of a channel's blocks.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BlockJudgement {
    /// Number of blocks with enough degrees of freedom to be tested.
    pub count: usize,
    /// Number of blocks with too few.
    pub left_out: usize,
    /// Edge in pixels.
    pub edge: usize,
    /// Corner of the block that differs most.
    pub worst: Option<[usize; 2]>,
    /// Difference of that block in standard errors.
    pub worst_score: f64,
    /// p-value of that block alone.
    pub worst_p_value: f64,
    /// p-value of the distribution of all blocks.
    pub distribution_p_value: f64,
}

/// Where a channel of two pictures is compared: a square of pixels, small enough to see where they
/// differ, large enough that its means are nearly normal; smaller at the right and lower border.
struct Block {
    /// First column and row.
    corner: [usize; 2],
    /// The first picture's mean minus the second's.
    difference: Estimate,
    /// Mean of the second picture.
    reference: f64,
}

/// Judges two pictures of one size; `None` where they share no channel whose variances both know.
pub fn judge(a: &Side, b: &Side, level: f64) -> Option<Judgement> {
    let (own, others) = (a.freedom?, b.freedom?);
    let known: Vec<(&Channel, &Channel)> = shared(a, b)
        .filter(|(a, b)| a.variances.is_some() && b.variances.is_some())
        .collect();
    let edge = EDGE.max(a.width.max(a.height).div_ceil(MOST));
    let members = members(a.width, a.height, edge);
    let part = level / KINDS;
    let levels = Levels {
        mean: sidak(part, known.len()),
        block: sidak(part, known.len() * members.len()),
        distribution: part / known.len() as f64,
    };
    let judged = |(x, r): &(&Channel, &Channel)| {
        let difference = |pixels: Option<&[usize]>| {
            let reference = mean_over(r, others, pixels)?;
            let difference = mean_over(x, own, pixels)?.minus(&reference);
            Some((difference, reference.value))
        };
        let block = |pixels: &Vec<usize>| {
            let (difference, reference) = difference(Some(pixels))?;
            let first = *pixels.first()?;
            Some(Block {
                corner: [first % a.width, first / a.width],
                difference,
                reference,
            })
        };
        let (mean, reference) = difference(None)?;
        let mut judged = mean_judged(&x.name, &mean, reference, levels.mean);
        let blocks: Option<Vec<Block>> = members.iter().map(block).collect();
        judge_blocks(&mut judged, &blocks?, edge, &levels);
        Some(judged)
    };
    let channels: Option<Vec<ChannelJudgement>> = known.iter().map(judged).collect();
    finish(channels?, level)
}

/// Judges the image mean of each channel against a number; `None` where no variances are known.
pub fn against_truth(a: &Side, truth: f64, level: f64) -> Option<Judgement> {
    let freedom = a.freedom?;
    let mean = |channel| Some((channel, mean_over(channel, freedom, None)?));
    let means: Vec<(&Channel, Estimate)> = a.channels.iter().filter_map(mean).collect();
    let own = sidak(level, means.len());
    let judged = |(channel, mean): &(&Channel, Estimate)| {
        let difference = mean.minus(&Estimate::exact(truth));
        mean_judged(&channel.name, &difference, truth, own)
    };
    finish(means.iter().map(judged).collect(), level)
}

fn finish(channels: Vec<ChannelJudgement>, level: f64) -> Option<Judgement> {
    (!channels.is_empty()).then(|| Judgement {
        consistent: channels.iter().all(|c| c.rejected.is_empty()),
        level,
        channels,
    })
}

/// Levels of single tests.
struct Levels {
    mean: f64,
    block: f64,
    distribution: f64,
}

fn mean_judged(name: &str, difference: &Estimate, reference: f64, level: f64) -> ChannelJudgement {
    let unit = match reference.abs() {
        0.0 => 1.0,
        size => size,
    };
    let p_value = difference.p_value(0.0, ROUNDING * reference.abs());
    let mut rejected = Vec::new();
    if p_value <= level {
        rejected.push(format!(
            "the image mean is off by {:+.2e} of the reference's, {:.1} standard errors",
            difference.value / unit,
            difference.score(0.0).abs(),
        ));
    }
    ChannelJudgement {
        channel: name.to_owned(),
        relative_bias: difference.value / unit,
        standard_error: difference.standard_error / unit,
        freedom: difference.freedom,
        p_value,
        smallest_caught: difference.smallest_caught(level) / unit,
        blocks: None,
        rejected,
    }
}

fn judge_blocks(judged: &mut ChannelJudgement, blocks: &[Block], edge: usize, levels: &Levels) {
    let counts = |block: &&Block| {
        // Without any spread a block's value is known exactly on both sides.
        let exact = block.difference.standard_error == 0.0;
        exact || block.difference.freedom >= LEAST_FREEDOM
    };
    let counted: Vec<&Block> = blocks.iter().filter(counts).collect();
    let p_value = |block: &Block| {
        let allowance = ROUNDING * block.reference.abs();
        block.difference.p_value(0.0, allowance)
    };
    let worst = counted.iter().map(|&block| (block, p_value(block)));
    let worst = worst.min_by(|a, b| a.1.total_cmp(&b.1));
    let scores: Vec<f64> = counted
        .iter()
        .filter(|block| block.difference.standard_error > 0.0)
        .map(|block| student::cumulative(block.difference.score(0.0), block.difference.freedom))
        .collect();
    let distribution = anderson_darling(&scores);
    if let Some((block, p)) = worst
        && p <= levels.block
    {
        let [x, y] = block.corner;
        judged.rejected.push(format!(
            "the block of {edge}x{edge} pixels at {x},{y} is off by {:.1} standard errors",
            block.difference.score(0.0).abs()
        ));
    }
    if distribution <= levels.distribution {
        judged.rejected.push(format!(
            "the differences of the {} blocks are not distributed as their standard errors say \
             (p = {distribution:.1e})",
            scores.len()
        ));
    }
    judged.blocks = Some(BlockJudgement {
        count: counted.len(),
        left_out: blocks.len() - counted.len(),
        edge,
        worst: worst.map(|(block, _)| block.corner),
        worst_score: worst.map_or(0.0, |(block, _)| block.difference.score(0.0)),
        worst_p_value: worst.map_or(1.0, |(_, p)| p),
        distribution_p_value: distribution,
    });
}
