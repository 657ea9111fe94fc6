//! The error metrics of one picture against another.

use super::{Channel, CompareError, Side};
use crate::film::names;
use crate::stats::metrics::{
    Metric, mean, mean_error, mean_over_channels, relative_mean_error, relmse, rmse, smape,
};

/// The metrics of a channel, or their means over several.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Metrics {
    /// Signed mean error, in the unit of the channel.
    pub mean_error: Metric,
    /// Mean error over the reference's mean.
    pub relative_mean_error: Metric,
    /// Root of the mean squared error.
    pub rmse: Metric,
    /// Relative mean squared error.
    pub relmse: Metric,
    /// Relative mean squared error without the share of the reference's own variance, where that is
    /// known.
    pub relmse_without_reference_variance: Option<Metric>,
    /// Symmetric mean absolute percentage error, as a fraction.
    pub smape: Metric,
}

/// The metrics of a channel.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ChannelMetrics {
    /// Name of the channel.
    pub channel: String,
    /// Means of the picture and of the reference.
    pub means: [f64; 2],
    /// The picture's errors against the reference.
    pub metrics: Metrics,
}

/// The metrics of each channel that both sides have, and those of R, G, B together where they have
/// them.
///
/// # Errors
/// [`CompareError`] for sides of different sizes or without a common channel.
pub fn metrics(a: &Side, b: &Side) -> Result<(Vec<ChannelMetrics>, Option<Metrics>), CompareError> {
    let paths = || [a.path.clone(), b.path.clone()];
    let sizes = [a, b].map(|side| [side.width, side.height]);
    if sizes[0] != sizes[1] {
        return Err(CompareError::Sizes(paths(), sizes));
    }
    let channels: Vec<ChannelMetrics> = shared(a, b).map(|(a, b)| of_channel(a, b)).collect();
    if channels.is_empty() {
        let list = |side: &Side| {
            let names: Vec<&str> = side.channels.iter().map(|c| c.name.as_str()).collect();
            names.join(", ")
        };
        return Err(CompareError::NothingShared(paths(), [a, b].map(list)));
    }
    let colours = channels.iter();
    let colours = colours.filter(|c| names::RGB.contains(&c.channel.as_str()));
    let colours: Vec<Metrics> = colours.map(|c| c.metrics).collect();
    let together = (colours.len() == names::RGB.len()).then(|| joined(&colours));
    Ok((channels, together))
}

/// The channels that both sides have.
pub fn shared<'a>(a: &'a Side, b: &'a Side) -> impl Iterator<Item = (&'a Channel, &'a Channel)> {
    let both = |channel: &'a Channel| Some((channel, b.channel(&channel.name)?));
    a.channels.iter().filter_map(both)
}

fn of_channel(a: &Channel, b: &Channel) -> ChannelMetrics {
    let (x, r) = (a.values.as_slice(), b.values.as_slice());
    ChannelMetrics {
        channel: a.name.clone(),
        means: [mean(x), mean(r)],
        metrics: Metrics {
            mean_error: mean_error(x, r),
            relative_mean_error: relative_mean_error(x, r),
            rmse: rmse(x, r),
            relmse: relmse(x, r, None),
            relmse_without_reference_variance: b.variances.as_ref().map(|v| relmse(x, r, Some(v))),
            smape: smape(x, r),
        },
    }
}

fn joined(channels: &[Metrics]) -> Metrics {
    let over = |metric: fn(&Metrics) -> Metric| {
        mean_over_channels(&channels.iter().map(metric).collect::<Vec<_>>())
    };
    let known: Option<Vec<Metric>> = channels
        .iter()
        .map(|c| c.relmse_without_reference_variance)
        .collect();
    Metrics {
        mean_error: over(|c| c.mean_error),
        relative_mean_error: over(|c| c.relative_mean_error),
        rmse: over(|c| c.rmse),
        relmse: over(|c| c.relmse),
        relmse_without_reference_variance: known.map(|known| mean_over_channels(&known)),
        smape: over(|c| c.smape),
    }
}
