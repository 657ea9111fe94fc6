//! Three verdicts on a difference that should be zero.
//!
//! "No difference found" says nothing when the noise is large. So a test passes only if the
//! difference is *shown* to be within a tolerance, fails only if it is shown to be off, and is
//! otherwise inconclusive: then a fresh and larger set of samples decides, never the old ones
//! together with new, which would favour whatever they lean to.

use super::{Estimate, student};

/// What an estimated difference shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It is within the tolerance.
    Pass,
    /// It is off zero, and not by so little that it does not matter.
    Fail,
    /// Neither.
    Inconclusive,
}

/// Share of the tolerance below which a difference that is certainly there does not matter.
const MATTERS: f64 = 0.5;

/// Probability with which a bias of [`smallest_caught`] is caught.
pub const POWER: f64 = 0.975;

/// Judges a difference d with standard error s and the two-sided Student quantile t of `level`:
/// pass if |d| + t s ≤ tolerance; otherwise fail if |d| − t s > 0 and |d| > tolerance/2.
///
/// A true difference of zero fails with probability at most `level`, one beyond the tolerance
/// passes with at most `level`/2.
#[must_use]
pub fn judge(difference: &Estimate, tolerance: f64, level: f64) -> Verdict {
    let distance = difference.value.abs();
    let margin = student::critical(level, difference.freedom) * difference.standard_error;
    if distance + margin <= tolerance {
        Verdict::Pass
    } else if distance > margin && distance > MATTERS * tolerance {
        Verdict::Fail
    } else {
        Verdict::Inconclusive
    }
}

/// The smallest bias that a two-sided test at `level` catches with probability [`POWER`]:
/// (t + t₀.₉₇₅) standard errors.
#[must_use]
pub fn smallest_caught(difference: &Estimate, level: f64) -> f64 {
    standard_errors_needed(level, difference.freedom) * difference.standard_error
}

/// How many standard errors the tolerance must be for a test at `level` to pass what is exactly
/// right, and fail what is off by the tolerance, with probability [`POWER`].
#[must_use]
pub fn standard_errors_needed(level: f64, freedom: f64) -> f64 {
    student::critical(level, freedom) + student::critical(2.0 * (1.0 - POWER), freedom)
}
