//! How far numbers are from a reference. Each metric is defined here and nowhere else.
//!
//! All take the values `x` of one channel and the reference values `r` of the same pixels, and
//! panic where the lengths differ: whoever reads files checks that first. The value of a picture
//! with several channels is the mean over them ([`mean_over_channels`]). Without any values, and
//! where a denominator vanishes, a metric is NaN.
//!
//! Dark pixels must not rule the relative metrics. Their denominators hold the mean reference
//! value μ of the channel: ε = 1e-4·μ² beside r² in [`relmse`], and its root 1e-2·μ beside |x| + |r|
//! in [`smape`]; below a hundredth of the mean, an error counts as one at a hundredth.

use super::Estimate;

/// Share of the squared mean reference value that stands beside r² in the denominator of
/// [`relmse`]; the choice is a convention that numbers can only be compared under.
pub const RELMSE_EPSILON: f64 = 1e-4;

/// Share of the mean reference value that stands beside |x| + |r| in the denominator of [`smape`]:
/// the root of [`RELMSE_EPSILON`], so that both call the same pixels dark.
pub const SMAPE_EPSILON: f64 = 1e-2;

/// A metric's value with the standard error that the spread of its terms over the pixels gives.
///
/// Noise is independent from pixel to pixel, so the spread holds the noise of each term and also
/// how much the terms' expectations differ from pixel to pixel: the standard error is never too
/// small on average, and too large where the error has a structure.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Metric {
    /// The metric.
    pub value: f64,
    /// Its standard error; NaN for a single pixel.
    pub standard_error: f64,
}

impl Metric {
    /// The mean of values, one a pixel.
    #[must_use]
    pub fn mean(values: &[f64]) -> Self {
        let mean = Estimate::mean(values);
        Self {
            value: mean.value,
            standard_error: mean.standard_error,
        }
    }

    fn of_terms(terms: impl Iterator<Item = f64>) -> Self {
        Self::mean(&terms.collect::<Vec<_>>())
    }
}

/// Signed mean error, Σ (x − r) / n, in the unit of the values.
#[must_use]
pub fn mean_error(x: &[f64], r: &[f64]) -> Metric {
    Metric::of_terms(errors(x, r))
}

/// Signed mean error over the mean reference value.
#[must_use]
pub fn relative_mean_error(x: &[f64], r: &[f64]) -> Metric {
    let error = mean_error(x, r);
    let factor = 1.0 / mean(r);
    Metric {
        value: error.value * factor,
        standard_error: error.standard_error * factor.abs(),
    }
}

/// Mean squared error, Σ (x − r)² / n.
#[must_use]
pub fn mse(x: &[f64], r: &[f64]) -> Metric {
    Metric::of_terms(errors(x, r).map(|error| error * error))
}

/// Root of the mean squared error, in the unit of the values; its standard error is that of the
/// mean square over 2·RMSE (to first order).
#[must_use]
pub fn rmse(x: &[f64], r: &[f64]) -> Metric {
    let squared = mse(x, r);
    let value = squared.value.sqrt();
    Metric {
        value,
        standard_error: squared.standard_error / (2.0 * value),
    }
}

/// Relative mean squared error, Σ (x − r)² / (r² + ε) / n, ε = 1e-4·mean(r)² (Rousselle,
/// Knaus and Zwicker 2011 have the form, with an absolute ε).
///
/// With `variance`, the variance of each reference value, that is taken off the square: what is
/// left is the error of `x` alone on average, and may fall below zero.
#[must_use]
pub fn relmse(x: &[f64], r: &[f64], variance: Option<&[f64]>) -> Metric {
    if let Some(variance) = variance {
        assert_eq!(variance.len(), r.len(), "variances and references");
    }
    let epsilon = RELMSE_EPSILON * mean(r) * mean(r);
    let known = |pixel: usize| variance.map_or(0.0, |variance| variance[pixel]);
    Metric::of_terms(
        errors(x, r)
            .enumerate()
            .map(|(pixel, error)| (error * error - known(pixel)) / (r[pixel] * r[pixel] + epsilon)),
    )
}

/// Symmetric mean absolute percentage error as a fraction between 0 and 2,
/// Σ |x − r| / ((|x| + |r| + ε) / 2) / n, ε = 1e-2·|mean(r)|.
#[must_use]
pub fn smape(x: &[f64], r: &[f64]) -> Metric {
    let epsilon = SMAPE_EPSILON * mean(r).abs();
    let sizes = x.iter().zip(r).map(|(x, r)| x.abs() + r.abs() + epsilon);
    let terms = errors(x, r).zip(sizes);
    Metric::of_terms(terms.map(|(error, size)| 2.0 * error.abs() / size))
}

/// The metric of a picture from those of its channels. Channels share their paths, so their noise
/// may be wholly correlated, and the standard error is the mean of theirs.
#[must_use]
pub fn mean_over_channels(channels: &[Metric]) -> Metric {
    let count = channels.len() as f64;
    Metric {
        value: channels.iter().map(|m| m.value).sum::<f64>() / count,
        standard_error: channels.iter().map(|m| m.standard_error).sum::<f64>() / count,
    }
}

/// Arithmetic mean; NaN without values.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn errors<'a>(x: &'a [f64], r: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    assert_eq!(x.len(), r.len(), "values and references");
    x.iter().zip(r).map(|(x, r)| x - r)
}
