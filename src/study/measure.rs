//! How far one render is from the reference.

use super::reference::Reference;
use crate::film::pixels::Estimate;
use crate::stats::metrics::{self, Metric, mean, mean_over_channels};

/// The errors of a render, means over R, G, B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Mean squared error, the reference's variance taken off; may be below 0.
    pub mse: f64,
    /// Relative mean squared error, the same.
    pub relmse: f64,
    /// Signed mean error over the reference's mean.
    pub bias: Metric,
    /// Mean of the squared standard errors that the render says it has; NaN with one replicate.
    pub estimated_mse: f64,
}

impl Measured {
    /// The root of `mse`, or minus the root of its size.
    pub fn rmse(&self) -> f64 {
        self.mse.abs().sqrt().copysign(self.mse)
    }
}

/// R, G and B of estimates, each for itself.
pub fn planes(estimates: &[Estimate]) -> [Vec<f64>; 3] {
    std::array::from_fn(|c| estimates.iter().map(|e| e.mean[c]).collect())
}

/// Compares a render with a reference of the same size.
pub fn measure(estimates: &[Estimate], reference: &Reference) -> Measured {
    let channels = planes(estimates);
    let mut mse = 0.0;
    let (mut relative, mut bias) = (Vec::new(), Vec::new());
    for (c, x) in channels.iter().enumerate() {
        let (r, variance) = (&reference.channels[c], &reference.variances[c]);
        mse += (metrics::mse(x, r).value - mean(variance)) / 3.0;
        relative.push(metrics::relmse(x, r, Some(variance)));
        bias.push(metrics::relative_mean_error(x, r));
    }
    let squares = estimates
        .iter()
        .map(|e| e.standard_error.iter().map(|s| s * s).sum::<f64>());
    Measured {
        mse,
        relmse: mean_over_channels(&relative).value,
        bias: mean_over_channels(&bias),
        estimated_mse: squares.sum::<f64>() / (3 * estimates.len()) as f64,
    }
}
