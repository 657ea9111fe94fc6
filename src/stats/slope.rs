//! The power law that errors follow: a straight line on logarithmic axes, with its uncertainty.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::student;

/// The line ln y = intercept + slope · ln x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// Its slope.
    pub value: f64,
    /// ln y at x = 1.
    pub intercept: f64,
    /// Standard error of the slope.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error.
    pub freedom: f64,
    /// Whether the points could lie on a line: `false` where they miss it by more than the spread
    /// of the replicates explains in 95 of 100 cases, and then the standard error holds the misses
    /// too.
    pub straight: bool,
}

/// Level of the test for straightness and of [`Slope::interval`].
pub const LEVEL: f64 = 0.05;

/// Values measured independently at one x > 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Replicates {
    /// The abscissa.
    pub x: f64,
    /// The values; their mean is what has a law.
    pub values: Vec<f64>,
}

/// ln of the mean and its variance.
struct Logarithm {
    x: f64,
    y: f64,
    variance: f64,
    freedom: f64,
}

impl Slope {
    /// Fits the means of replicates, each weighted by the inverse variance of its logarithm (to
    /// first order the relative variance of the mean). Points whose mean is not above zero, or
    /// with a single replicate, say nothing and are left out; `None` where fewer than two are left
    /// or their replicates have no spread.
    ///
    /// The slope's variance is that of weighted least squares, 1/Σ w (ln x − mean)² (Bevington and
    /// Robinson, *Data Reduction and Error Analysis*, 3rd ed., ch. 6), with the degrees of freedom
    /// of all replicates together. Where the points are no line ([`Slope::straight`]), it is
    /// scaled by χ²/(n − 2) and has n − 2 degrees of freedom.
    #[must_use]
    pub fn fit(points: &[Replicates]) -> Option<Self> {
        let points: Vec<Logarithm> = points.iter().filter_map(Logarithm::of).collect();
        let count = points.len() as f64;
        if points.len() < 2 {
            return None;
        }
        let weight = |p: &Logarithm| 1.0 / p.variance;
        let sum = |f: &dyn Fn(&Logarithm) -> f64| points.iter().map(|p| weight(p) * f(p)).sum();
        let weights: f64 = sum(&|_| 1.0);
        let mean_x: f64 = sum(&|p| p.x) / weights;
        let mean_y: f64 = sum(&|p| p.y) / weights;
        let squares: f64 = sum(&|p| (p.x - mean_x) * (p.x - mean_x));
        let value: f64 = sum(&|p| (p.x - mean_x) * (p.y - mean_y)) / squares;
        let intercept = mean_y - value * mean_x;
        let misses: f64 = sum(&|p| {
            let miss = p.y - intercept - value * p.x;
            miss * miss
        });
        let own_freedom: f64 = points.iter().map(|p| p.freedom).sum();
        let excess = misses / (count - 2.0);
        let straight = points.len() < 3 || excess <= tolerated(count - 2.0, own_freedom);
        let (scale, freedom) = if straight {
            (1.0, own_freedom)
        } else {
            (excess.max(1.0), count - 2.0)
        };
        let standard_error = (scale / squares).sqrt();
        (value.is_finite() && standard_error.is_finite()).then_some(Self {
            value,
            intercept,
            standard_error,
            freedom,
            straight,
        })
    }

    /// The 95 % interval of the slope, by Student's t.
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        let half = student::critical(LEVEL, self.freedom) * self.standard_error;
        [self.value - half, self.value + half]
    }

    /// The slope of the k-th power's root: that of the root mean square from that of the mean
    /// square with k = 2.
    #[must_use]
    pub fn of_root(&self, k: f64) -> Self {
        Self {
            value: self.value / k,
            intercept: self.intercept / k,
            standard_error: self.standard_error / k,
            ..*self
        }
    }

    /// y of the line at x.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        libm::exp(self.intercept + self.value * libm::log(x))
    }
}

impl Logarithm {
    fn of(point: &Replicates) -> Option<Self> {
        let count = point.values.len() as f64;
        let mean = point.values.iter().sum::<f64>() / count;
        let squares: f64 = point.values.iter().map(|v| (v - mean) * (v - mean)).sum();
        let variance = squares / (count - 1.0) / count / (mean * mean);
        let usable = mean > 0.0 && variance > 0.0 && variance.is_finite();
        usable.then(|| Self {
            x: libm::log(point.x),
            // The mean of a logarithm is less than the logarithm of the mean by half the variance.
            y: libm::log(mean) + variance / 2.0,
            variance,
            freedom: count - 1.0,
        })
    }
}

/// The mean square miss that points of a line stay below in 95 of 100 cases: Fisher's F.
fn tolerated(freedom: f64, own_freedom: f64) -> f64 {
    FisherSnedecor::new(freedom, own_freedom)
        .map_or(f64::INFINITY, |fisher| fisher.inverse_cdf(1.0 - LEVEL))
}
