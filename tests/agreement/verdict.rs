//! Three verdicts on a difference that should be zero.
//!
//! "No difference found" says nothing when the noise is large. So a test passes only if the
//! difference is *shown* to be within a tolerance, fails only if it is shown to be off, and is
//! otherwise inconclusive: then a fresh and larger set of samples decides, never the old ones
//! together with new, which would favour whatever they lean to.

use etalon::Estimate;

/// What an estimated difference shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    Pass,
    /// It is off zero, and not by so little that it does not matter.
    Fail,
    Inconclusive,
}

/// Share of the tolerance below which a difference that is certainly there does not matter.
const MATTERS: f64 = 0.5;

/// Judges a difference d with standard error s and the two-sided Student quantile t of `level`:
/// pass if |d| + t s ≤ tolerance; otherwise fail if |d| − t s > 0 and |d| > tolerance/2.
///
/// A true difference of zero fails with probability at most `level`, one beyond the tolerance
/// passes with at most `level`/2.
pub fn judge(difference: &Estimate, tolerance: f64, level: f64) -> Verdict {
    let distance = difference.value.abs();
    let margin = difference.half_width(level);
    if distance + margin <= tolerance {
        Verdict::Pass
    } else if distance > margin && distance > MATTERS * tolerance {
        Verdict::Fail
    } else {
        Verdict::Inconclusive
    }
}
