//! Double-double arithmetic (about 106 bits) with a running error bound.
//!
//! The algorithms and their relative bounds are those of Joldes, Muller, Popescu (2017), "Tight
//! and rigorous error bounds for basic building blocks of double-word arithmetic", ACM TOMS 44(2):
//! addition 3u² (Algorithm 6), multiplication 5u² (Algorithm 11), with u = 2⁻⁵³.

use super::exact::Exact;
use super::number::{Approximation, Bounded, INFLATION, Number, quotient_error};
use super::words::{fast_two_sum, two_sum};

/// An unevaluated sum hi + lo, |lo| ≤ ulp(hi)/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    hi: f64,
    lo: f64,
}

/// A sum of two f64 with a bound of its distance to the truth.
pub type DoubleDouble = Bounded<Pair>;

impl DoubleDouble {
    /// The two numbers whose sum this is.
    pub fn parts(&self) -> [f64; 2] {
        [self.value.hi, self.value.lo]
    }
}

impl Approximation for Pair {
    const ZERO: Self = Self { hi: 0.0, lo: 0.0 };
    /// 16 u² = 2⁻¹⁰²: above the 3u², 5u² of sum and product.
    const ROUNDING: f64 = 4.0 * f64::EPSILON * f64::EPSILON;
    /// 1e-260 · 2⁻¹⁰² ≈ 2⁻⁹⁶⁶ is far above the few 2⁻¹⁰⁷⁴ that an underflow of the low word costs,
    /// and a product above this has a low word and rounding errors (≥ 1e-260 · 2⁻¹⁵⁹) out of
    /// underflow's reach.
    const SMALL: f64 = 1e-260;
    /// |hi + lo| ≥ |hi| (1 − u): half is a cheap lower bound that never decides wrongly. Only near
    /// the bound would hi and lo have to be taken together; there the next tier decides.
    const LEAST: f64 = 0.5;
    /// |hi + lo| ≤ |hi| (1 + u): this covers that and the products of errors.
    const PRODUCT: f64 = INFLATION;

    methods! {
        fn of(x: f64) -> Self = Self { hi: x, lo: 0.0 };
        fn head(self) -> f64 = self.hi;
        fn negated(self) -> Self = Self { hi: -self.hi, lo: -self.lo };
    }

    fn nearest(x: &Exact) -> (Self, bool) {
        let hi = x.to_f64();
        if !hi.is_finite() {
            return (Self::of(hi), false);
        }
        let rest = x.minus(&Exact::of(hi));
        let lo = rest.to_f64();
        (Self { hi, lo }, rest.is(lo))
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        let (s_hi, s_lo) = two_sum(self.hi, other.hi);
        let (t_hi, t_lo) = two_sum(self.lo, other.lo);
        let (v_hi, v_lo) = fast_two_sum(s_hi, s_lo + t_hi);
        let (hi, lo) = fast_two_sum(v_hi, t_lo + v_lo);
        Self { hi, lo }
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        let p = self.hi * other.hi;
        // hi · hi = p + e exactly, barring overflow and underflow.
        let e = self.hi.mul_add(other.hi, -p);
        let cross = self.lo.mul_add(other.hi, self.hi * other.lo);
        let (hi, lo) = fast_two_sum(p, e + cross);
        Self { hi, lo }
    }

    fn over(self, other: Self) -> (Self, f64) {
        let (a, b) = (Bounded::exactly(self), Bounded::exactly(other));
        let first = self.hi / other.hi;
        let rest = a.minus(&b.times(&Bounded::of(first)));
        let second = rest.to_f64() / other.hi;
        let (hi, lo) = fast_two_sum(first, second);
        // The second quotient is off by its rounding, u|second|, by rest.lo and b.lo, each below
        // 2u|rest|, and by the error of the rest: 8u|second| with rest.error / |b|.
        let residual = 4.0 * f64::EPSILON * second.abs()
            + quotient_error(rest.error(), second.abs(), 0.0, other.hi.abs());
        (Self { hi, lo }, residual)
    }

    fn root(self) -> Option<(Self, f64)> {
        if self.hi.is_nan() || self.hi <= 0.0 {
            return None;
        }
        let first = self.hi.sqrt();
        let rest = Bounded::exactly(self).minus(&DoubleDouble::of(first).squared());
        let second = rest.to_f64() / (2.0 * first);
        let (hi, lo) = fast_two_sum(first, second);
        // √x = first + rest / (first + √x): replacing √x by first and rounding costs
        // |second| (|second| / first + 3u) at most, with |second| ≤ 2u first.
        let residual =
            8.0 * f64::EPSILON * second.abs() + quotient_error(rest.error(), 0.0, 0.0, 2.0 * first);
        Some((Self { hi, lo }, residual))
    }
}
