//! Many tests that together raise a false alarm with a stated probability.

/// The level of each of `count` independent tests when the whole family may raise a false alarm
/// with probability `level` (Z. Šidák, JASA 62, 1967): 1 − (1 − level)^(1/count).
#[must_use]
pub fn sidak(level: f64, count: usize) -> f64 {
    -libm::expm1(libm::log1p(-level) / count as f64)
}
