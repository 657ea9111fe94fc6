//! Weights of multiple importance sampling, and only weights.

use crate::math::lanes::{Lanes, Real};

/// The power heuristic with exponent 2 for one sample of each of two strategies: p²/(p² + q²)
/// (E. Veach 1997, section 9.2.4), written so that p² cannot overflow.
#[inline(always)]
pub fn power_weight<L: Lanes>(l: L, pdf: L::Real, other: L::Real) -> L::Real {
    let ratio = other / pdf;
    l.real(1.0) / ratio.mul_add(ratio, l.real(1.0))
}
