//! All that a comparison says.

use std::path::Path;

use super::{
    ChannelMetrics, CompareError, Judgement, LEVEL, Metrics, Side, against_truth, flip, judge,
    metrics,
};
use crate::film::Picture;
use crate::stats::metrics::Metric;

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

    /// The same of sides, such as files.
    ///
    /// # Errors
    /// [`CompareError`] for sides of different sizes or without a common channel.
    pub fn of_sides(a: &Side, b: &Side) -> Result<Self, CompareError> {
        let (channels, rgb) = metrics(a, b)?;
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
            judgement: against_truth(a, truth, LEVEL),
        }
    }
}
