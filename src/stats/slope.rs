//! The power law that errors follow: a straight line on logarithmic axes, with its uncertainty.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::{Estimate, student};

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

/// ln of a mean and its variance, over ln x.
struct Logarithm {
    x: f64,
    y: f64,
    variance: f64,
    freedom: f64,
}

impl Slope {
    /// Fits the means of replicates. Points whose mean is not above zero, or with a single
    /// replicate, say nothing and are left out; `None` where fewer than two are left or their
    /// replicates have no spread.
    ///
    /// The variance v of a point's logarithm is, to first order, the relative variance of its mean.
    /// Weights 1/v from few replicates would favour the points whose replicates agree by accident
    /// and be too sure of themselves; with 1/(v + v̄), v̄ the mean over the points, no point counts
    /// for much more than its share, and one that is known badly counts for less. The slope is then
    /// Σ c y with c from weighted least squares, its variance Σ c² v, with the degrees of freedom of
    /// F. E. Satterthwaite (Biometrics Bulletin 2, 1946). Where the points are no line
    /// ([`Slope::straight`]), the variance is scaled by χ²/(n − 2) and has n − 2 degrees of freedom.
    #[must_use]
    pub fn fit(points: &[Replicates]) -> Option<Self> {
        let points: Vec<Logarithm> = points.iter().filter_map(Logarithm::of).collect();
        if points.len() < 2 {
            return None;
        }
        let (slope, intercept, shares) = line(&points);
        let (mut variance, mut squares, mut excess) = (0.0, 0.0, 0.0);
        for (p, share) in points.iter().zip(&shares) {
            let part = share * share * p.variance;
            variance += part;
            squares += part * part / p.freedom;
            let miss = p.y - intercept - slope * p.x;
            excess += miss * miss / p.variance;
        }
        let own_freedom = variance * variance / squares;
        let beyond = points.len() as f64 - 2.0;
        excess /= beyond;
        let freedoms = points.iter().map(|p| p.freedom);
        let of_one = freedoms.fold(f64::INFINITY, f64::min);
        let straight = beyond < 1.0 || excess <= tolerated(beyond, of_one);
        let (scale, freedom) = if straight {
            (1.0, own_freedom)
        } else {
            (excess.max(1.0), beyond)
        };
        let standard_error = (scale * variance).sqrt();
        (slope.is_finite() && standard_error.is_finite()).then_some(Self {
            value: slope,
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

/// Slope and intercept of a line by weighted least squares, and what each ordinate counts for in the
/// slope.
fn line(points: &[Logarithm]) -> (f64, f64, Vec<f64>) {
    let usual = points.iter().map(|p| p.variance).sum::<f64>() / points.len() as f64;
    let weights: Vec<f64> = points.iter().map(|p| 1.0 / (p.variance + usual)).collect();
    let sum = |f: &dyn Fn(&Logarithm) -> f64| -> f64 {
        points.iter().zip(&weights).map(|(p, w)| w * f(p)).sum()
    };
    let all = sum(&|_| 1.0);
    let (mean_x, mean_y) = (sum(&|p| p.x) / all, sum(&|p| p.y) / all);
    let squares = sum(&|p| (p.x - mean_x) * (p.x - mean_x));
    let share = |(p, w): (&Logarithm, &f64)| w * (p.x - mean_x) / squares;
    let shares: Vec<f64> = points.iter().zip(&weights).map(share).collect();
    let parts = points.iter().zip(&shares).map(|(p, c)| c * p.y);
    let slope = parts.sum::<f64>();
    (slope, mean_y - slope * mean_x, shares)
}

impl Logarithm {
    fn of(point: &Replicates) -> Option<Self> {
        let mean = Estimate::mean(&point.values);
        let variance = (mean.standard_error / mean.value).powi(2);
        let usable = mean.value > 0.0 && variance > 0.0 && variance.is_finite();
        usable.then(|| Self {
            x: libm::log(point.x),
            // The mean of a logarithm is less than the logarithm of the mean by half the variance.
            y: libm::log(mean.value) + variance / 2.0,
            variance,
            freedom: mean.freedom,
        })
    }
}

/// The mean square miss that points of a line stay below in 95 of 100 cases: Fisher's F, with the
/// degrees of freedom of one point, as each miss is measured by its own point's spread.
fn tolerated(freedom: f64, of_one: f64) -> f64 {
    FisherSnedecor::new(freedom, of_one)
        .map_or(f64::INFINITY, |fisher| fisher.inverse_cdf(1.0 - LEVEL))
}
