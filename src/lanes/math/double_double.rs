//! Double-double arithmetic (about 106 bits) with a running error bound.
//!
//! The algorithms and their relative bounds are those of Joldes, Muller, Popescu (2017), "Tight
//! and rigorous error bounds for basic building blocks of double-word arithmetic", ACM TOMS 44(2):
//! addition 3u² (Algorithm 6), multiplication 5u² (Algorithm 11), with u = 2⁻⁵³.

use std::cmp::Ordering;

use super::exact::Exact;
use super::number::{Number, no_less, quotient_error, scaled, square_root_error};

/// An unevaluated sum hi + lo, |lo| ≤ ulp(hi)/2, with a bound of its distance to the truth.
#[derive(Debug, Clone, Copy)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
    error: f64,
}

/// 16 u² = 2⁻¹⁰²: above the 3u², 5u² of sum and product; the rest pays for subnormal rounding of
/// the bound.
const ROUNDING: f64 = 4.0 * f64::EPSILON * f64::EPSILON;

/// Products below this may have lost part of their low word to underflow. 1e-260 · 2⁻¹⁰² ≈ 2⁻⁹⁶⁶
/// is far above the few 2⁻¹⁰⁷⁴ this costs, and a product above this has a low word and rounding
/// errors (≥ 1e-260 · 2⁻¹⁵⁹) out of underflow's reach.
const SMALL: f64 = 1e-260;

/// Covers the roundings in the evaluation of the error bound, see `number::INFLATION`.
const INFLATION: f64 = 1.0 + 8.0 * f64::EPSILON;

/// a + b = s + e exactly (Knuth 1969), barring overflow.
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let b_part = s - a;
    (s, (a - (s - b_part)) + (b - b_part))
}

/// a + b = s + e exactly where |a| ≥ |b| or a = 0 (Dekker 1971).
#[inline]
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    (s, b - (s - a))
}

/// a · b = p + e exactly, barring overflow and underflow.
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    (p, a.mul_add(b, -p))
}

impl DoubleDouble {
    const ZERO: Self = Self {
        hi: 0.0,
        lo: 0.0,
        error: 0.0,
    };

    /// The two numbers whose sum this is.
    pub fn parts(&self) -> [f64; 2] {
        [self.hi, self.lo]
    }

    #[inline]
    fn is_exact_zero(&self) -> bool {
        self.hi == 0.0 && self.lo == 0.0 && self.error == 0.0
    }

    /// hi + lo taken as the exact value.
    #[inline]
    fn without_error(self) -> Self {
        Self { error: 0.0, ..self }
    }

    /// The rounding errors of quotient and root below are each a few u²; this bounds them with
    /// the residual that their last correction left out.
    #[inline]
    fn widened(self, residual: f64, inherited: f64) -> Self {
        let rounding = ROUNDING * no_less(self.hi.abs(), SMALL);
        Self {
            error: INFLATION * (inherited + residual + rounding),
            ..self
        }
    }
}

impl Number for DoubleDouble {
    fn scaled(x: f64, exponent: i32) -> Self {
        let (hi, error) = scaled(x, exponent, ROUNDING * SMALL);
        Self { hi, lo: 0.0, error }
    }

    fn enclosing(x: &Exact) -> Self {
        let hi = x.to_f64();
        if !hi.is_finite() {
            return Self {
                hi,
                lo: 0.0,
                error: f64::INFINITY,
            };
        }
        let rest = x.minus(&Exact::of(hi));
        let lo = rest.to_f64();
        let exact = rest.minus(&Exact::of(lo)).sign() == Some(Ordering::Equal);
        Self {
            hi,
            lo,
            error: if exact {
                0.0
            } else {
                ROUNDING * no_less(hi.abs(), SMALL)
            },
        }
    }

    #[inline]
    fn plus(&self, other: &Self) -> Self {
        let (s_hi, s_lo) = two_sum(self.hi, other.hi);
        let (t_hi, t_lo) = two_sum(self.lo, other.lo);
        let (v_hi, v_lo) = fast_two_sum(s_hi, s_lo + t_hi);
        let (hi, lo) = fast_two_sum(v_hi, t_lo + v_lo);
        Self {
            hi,
            lo,
            error: INFLATION * (self.error + other.error + ROUNDING * hi.abs()),
        }
    }

    #[inline]
    fn times(&self, other: &Self) -> Self {
        if self.is_exact_zero() || other.is_exact_zero() {
            return Self::ZERO;
        }
        let (p, e) = two_product(self.hi, other.hi);
        let cross = self.lo.mul_add(other.hi, self.hi * other.lo);
        let (hi, lo) = fast_two_sum(p, e + cross);
        // |hi + lo| ≤ |hi| (1 + u): the last factor covers that and the products of errors.
        let inherited =
            (self.hi.abs() * other.error + self.error * (other.hi.abs() + other.error)) * INFLATION;
        Self {
            hi,
            lo,
            error: INFLATION * (inherited + ROUNDING * no_less(hi.abs(), SMALL)),
        }
    }

    #[inline]
    fn negated(&self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
            error: self.error,
        }
    }

    #[inline]
    fn sign(&self) -> Option<Ordering> {
        // |hi + lo| ≥ |hi| (1 − u); half of |hi| is a cheap lower bound that never decides wrongly
        // and needs hi and lo to be taken together only near the bound, which climbs instead.
        if 0.5 * self.hi > self.error {
            Some(Ordering::Greater)
        } else if -0.5 * self.hi > self.error {
            Some(Ordering::Less)
        } else if self.is_exact_zero() {
            Some(Ordering::Equal)
        } else {
            None
        }
    }

    fn divided_by(&self, other: &Self) -> Self {
        let (a, b) = (self.without_error(), other.without_error());
        let first = a.hi / b.hi;
        let rest = a.minus(&b.times(&Self::of(first)));
        let second = rest.hi / b.hi;
        let (hi, lo) = fast_two_sum(first, second);
        // The second quotient is off by its rounding, u|second|, by rest.lo and b.lo, each below
        // 2u|rest|, and by the error of the rest: 8u|second| with rest.error / |b|.
        let residual = 4.0 * f64::EPSILON * second.abs()
            + quotient_error(rest.error, second.abs(), 0.0, b.hi.abs());
        let inherited = quotient_error(
            self.error,
            hi.abs() * (1.0 + f64::EPSILON),
            other.error,
            b.hi.abs(),
        );
        Self { hi, lo, error: 0.0 }.widened(residual, inherited)
    }

    fn square_root(&self) -> Self {
        let x = self.without_error();
        let inherited = square_root_error(self.hi, self.error);
        if self.hi.is_nan() || self.hi <= 0.0 {
            // The truth is ≥ 0 and ≤ error − |hi|.
            return Self {
                error: inherited,
                ..Self::ZERO
            };
        }
        let first = self.hi.sqrt();
        let rest = x.minus(&Self::of(first).squared());
        let second = rest.hi / (2.0 * first);
        let (hi, lo) = fast_two_sum(first, second);
        // √x = first + rest / (first + √x): replacing √x by first and rounding costs
        // |second| (|second| / first + 3u) at most, with |second| ≤ 2u first.
        let residual =
            8.0 * f64::EPSILON * second.abs() + quotient_error(rest.error, 0.0, 0.0, 2.0 * first);
        Self { hi, lo, error: 0.0 }.widened(residual, inherited)
    }

    #[inline]
    fn to_f64(&self) -> f64 {
        self.hi
    }

    #[inline]
    fn error(&self) -> f64 {
        self.error
    }
}
