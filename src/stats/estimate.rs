//! Numbers with their standard errors.

use std::fmt;

use super::student;

/// Probability with which a test catches what is called the smallest bias that it catches
/// ([`Estimate::smallest_caught`]).
pub const POWER: f64 = 0.975;

/// An estimate of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error; infinite where it is known.
    pub freedom: f64,
}

impl Estimate {
    /// A number known exactly.
    #[must_use]
    pub fn exact(value: f64) -> Self {
        Self {
            value,
            standard_error: 0.0,
            freedom: f64::INFINITY,
        }
    }

    /// The mean of independent values whose `variances` are estimates too, each with `freedom`
    /// degrees of freedom k.
    ///
    /// Their sum has (Σ σᵢ²)²/Σ (σᵢ⁴/k) degrees of freedom (F. E. Satterthwaite, Biometrics
    /// Bulletin 2, 1946; B. L. Welch, Biometrika 34, 1947). A variance v with k degrees of freedom
    /// has E v² = σ⁴ (1 + 2/k), so that σᵢ⁴ is estimated by vᵢ²/(1 + 2/k) and the result is
    /// (k + 2) (Σ vᵢ)²/Σ vᵢ², at least k and at most n k.
    #[must_use]
    pub fn mean_of(values: &[f64], variances: &[f64], freedom: f64) -> Self {
        assert_eq!(values.len(), variances.len(), "values and variances");
        let variance = [
            variances.iter().sum(),
            variances.iter().map(|v| v * v).sum(),
        ];
        Self::of_sums(values.len(), values.iter().sum(), variance, freedom)
    }

    /// [`Estimate::mean_of`] `count` values from their sum, and from the sum of their variances and
    /// that of the squares of these.
    #[must_use]
    pub fn of_sums(count: usize, sum: f64, [variance, squares]: [f64; 2], freedom: f64) -> Self {
        let count = count as f64;
        let joined = if squares > 0.0 {
            ((freedom + 2.0) * variance * variance / squares).clamp(freedom, freedom * count)
        } else {
            freedom * count
        };
        Self {
            value: sum / count,
            standard_error: variance.sqrt() / count,
            freedom: joined,
        }
    }

    /// The mean of independent values from their spread.
    #[must_use]
    pub fn mean(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let value = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - value) * (v - value)).sum();
        Self {
            value,
            standard_error: (squares / (count - 1.0) / count).sqrt(),
            freedom: count - 1.0,
        }
    }

    /// The difference to an independent estimate, with the degrees of freedom of Welch (1947).
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let own = self.standard_error * self.standard_error;
        let others = other.standard_error * other.standard_error;
        let sum = own + others;
        let freedom = if sum > 0.0 {
            sum * sum / (own * own / self.freedom + others * others / other.freedom)
        } else {
            self.freedom.min(other.freedom)
        };
        Self {
            value: self.value - other.value,
            standard_error: sum.sqrt(),
            freedom,
        }
    }

    /// The estimate in another unit.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            standard_error: self.standard_error * factor.abs(),
            ..*self
        }
    }

    /// Standard error over value, where it is known.
    #[must_use]
    pub fn relative_error(&self) -> Option<f64> {
        let ratio = self.standard_error / self.value;
        ratio.is_finite().then_some(ratio)
    }

    /// Standard errors between the estimate and a number; infinite where it differs and there is
    /// no error, 0 where it does not.
    #[must_use]
    pub fn score(&self, number: f64) -> f64 {
        let difference = self.value - number;
        if difference == 0.0 {
            0.0
        } else {
            difference / self.standard_error
        }
    }

    /// Two-sided p-value of the hypothesis that the estimated number is within `allowance` of
    /// `number`.
    #[must_use]
    pub fn p_value(&self, number: f64, allowance: f64) -> f64 {
        let distance = (self.value - number).abs() - allowance;
        if distance <= 0.0 {
            return 1.0;
        }
        student::two_sided(distance / self.standard_error, self.freedom)
    }

    /// Half the width of the two-sided interval by Student's t that misses with probability `level`.
    #[must_use]
    pub fn half_width(&self, level: f64) -> f64 {
        student::critical(level, self.freedom) * self.standard_error
    }

    /// The smallest bias that a two-sided test at `level` catches with probability [`POWER`]:
    /// (t + t₀.₉₇₅) standard errors.
    #[must_use]
    pub fn smallest_caught(&self, level: f64) -> f64 {
        let t = |level| student::critical(level, self.freedom);
        (t(level) + t(2.0 * (1.0 - POWER))) * self.standard_error
    }
}

/// `value ± standard error`, both up to the second digit of the latter where it is known.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            value,
            standard_error,
            ..
        } = self;
        let decimals = 1.0 - standard_error.log10().floor();
        if (0.0..=17.0).contains(&decimals) {
            let decimals = decimals as usize;
            write!(f, "{value:.decimals$} ± {standard_error:.decimals$}")
        } else {
            write!(f, "{value:?} ± {standard_error:?}")
        }
    }
}
