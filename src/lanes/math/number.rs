//! Numbers that know how wrong they may be: one interface for every rung of the ladder
//! f64 → double-double → exact, so that a predicate is written once.

use std::cmp::Ordering;

use super::exact::Exact;

/// A real number known exactly or within a bound.
///
/// Every operation returns an enclosure of the true result: |value − truth| ≤ error. A predicate
/// asks only for [`sign`](Number::sign), which answers `None` where the enclosure holds zero and
/// other numbers besides. Overflow and underflow widen the enclosure; they never narrow it.
pub trait Number: Clone {
    /// x · 2^exponent, for finite x and |exponent| ≤ 1000.
    fn scaled(x: f64, exponent: i32) -> Self;
    fn enclosing(x: &Exact) -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn negated(&self) -> Self;
    /// Sign of the true value: `Equal` is zero, `None` is undecided.
    fn sign(&self) -> Option<Ordering>;
    /// self / other. For values, never for decisions: on the exact rung it is truncated to
    /// [`exact::VALUE_BITS`](super::exact::VALUE_BITS).
    fn divided_by(&self, other: &Self) -> Self;
    /// √self, of a number known to be ≥ 0. For values, never for decisions.
    fn square_root(&self) -> Self;
    /// The nearest f64, or one of its neighbours.
    fn to_f64(&self) -> f64;
    /// Bound of |value − truth|; infinite or NaN where nothing is known.
    fn error(&self) -> f64;

    fn of(x: f64) -> Self {
        Self::scaled(x, 0)
    }
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }
    fn squared(&self) -> Self {
        self.times(self)
    }
    fn negated_if(&self, negative: bool) -> Self {
        if negative {
            self.negated()
        } else {
            self.clone()
        }
    }
}

/// a · b for vectors of any equal length ≥ 1.
pub fn dot<N: Number>(a: &[N], b: &[N]) -> N {
    let mut sum = a[0].times(&b[0]);
    for (x, y) in a[1..].iter().zip(&b[1..]) {
        sum = sum.plus(&x.times(y));
    }
    sum
}

/// 2^exponent for |exponent| ≤ 1000.
pub fn power_of_two(exponent: i32) -> f64 {
    debug_assert!(exponent.abs() <= 1000);
    f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52)
}

/// The exponent e, clamped to ±1000, with 2^e ≤ |x| < 2^(e+1) for normal x (−1000 for 0).
pub fn binary_exponent(x: f64) -> i32 {
    (((x.to_bits() >> 52) & 0x7ff) as i32 - 1023).clamp(-1000, 1000)
}

/// Products below this may have underflowed in part; their error is bounded as if they were this
/// large. 1e-280 · 2⁻⁵² ≈ 2⁻⁹⁸² is far above the few 2⁻¹⁰⁷⁴ that underflow can cost a value
/// and its error bound together.
const SMALL: f64 = 1e-280;

/// Twice the unit roundoff: a correctly rounded result is off by half of this at most; the other
/// half pays for subnormal rounding of the bound itself.
const ROUNDING: f64 = f64::EPSILON;

/// The error bound is a sum of positive terms computed with at most 6 roundings of relative
/// size ≤ 2⁻⁵³ each, so that this factor covers them.
const INFLATION: f64 = 1.0 + 8.0 * f64::EPSILON;

/// f64 with a running forward error bound (Wilkinson 1963, *Rounding Errors in Algebraic
/// Processes*, ch. 1).
#[derive(Debug, Clone, Copy)]
pub struct Bounded {
    value: f64,
    error: f64,
}

impl Bounded {
    const ZERO: Self = Self {
        value: 0.0,
        error: 0.0,
    };

    /// Zero without error: it annihilates whatever it is multiplied with.
    #[inline]
    fn is_exact_zero(&self) -> bool {
        self.value == 0.0 && self.error == 0.0
    }
}

impl Number for Bounded {
    #[inline]
    fn scaled(x: f64, exponent: i32) -> Self {
        let (value, error) = scaled(x, exponent, ROUNDING * SMALL);
        Self { value, error }
    }

    fn enclosing(x: &Exact) -> Self {
        let value = x.to_f64();
        let exact = value.is_finite() && Exact::of(value).minus(x).sign() == Some(Ordering::Equal);
        Self {
            value,
            error: if exact {
                0.0
            } else {
                ROUNDING * no_less(value.abs(), SMALL)
            },
        }
    }

    #[inline]
    fn plus(&self, other: &Self) -> Self {
        let value = self.value + other.value;
        Self {
            value,
            error: INFLATION * (self.error + other.error + ROUNDING * value.abs()),
        }
    }

    #[inline]
    fn times(&self, other: &Self) -> Self {
        if self.is_exact_zero() || other.is_exact_zero() {
            return Self::ZERO;
        }
        let value = self.value * other.value;
        let inherited =
            self.value.abs() * other.error + self.error * (other.value.abs() + other.error);
        Self {
            value,
            error: INFLATION * (inherited + ROUNDING * no_less(value.abs(), SMALL)),
        }
    }

    #[inline]
    fn negated(&self) -> Self {
        Self {
            value: -self.value,
            error: self.error,
        }
    }

    #[inline]
    fn sign(&self) -> Option<Ordering> {
        // A NaN in either field fails every comparison and so stays undecided.
        if self.value > self.error {
            Some(Ordering::Greater)
        } else if -self.value > self.error {
            Some(Ordering::Less)
        } else if self.is_exact_zero() {
            Some(Ordering::Equal)
        } else {
            None
        }
    }

    #[inline]
    fn divided_by(&self, other: &Self) -> Self {
        let value = self.value / other.value;
        let inherited = quotient_error(
            self.error,
            value.abs() * (1.0 + ROUNDING),
            other.error,
            other.value.abs(),
        );
        Self {
            value,
            error: INFLATION * (inherited + ROUNDING * no_less(value.abs(), SMALL)),
        }
    }

    #[inline]
    fn square_root(&self) -> Self {
        let value = self.value.max(0.0).sqrt();
        Self {
            value,
            error: INFLATION
                * (square_root_error(self.value, self.error) + ROUNDING * no_less(value, SMALL)),
        }
    }

    #[inline]
    fn to_f64(&self) -> f64 {
        self.value
    }

    #[inline]
    fn error(&self) -> f64 {
        self.error
    }
}

/// x · 2^exponent and a bound of its error, `subnormal` where it has lost digits.
#[inline]
pub(super) fn scaled(x: f64, exponent: i32, subnormal: f64) -> (f64, f64) {
    let value = x * power_of_two(exponent);
    let exact = exponent == 0 || x == 0.0 || value.abs() >= f64::MIN_POSITIVE;
    let error = match (value.is_finite(), exact) {
        (false, _) => f64::INFINITY,
        (true, true) => 0.0,
        (true, false) => subnormal,
    };
    (value, error)
}

/// The larger of the two, but NaN where x is NaN (`f64::max` would hide it).
#[inline]
pub(super) fn no_less(x: f64, least: f64) -> f64 {
    if x < least { least } else { x }
}

/// Bound of |a'/b' − a/b| for |a' − a| ≤ `numerator`, |b' − b| ≤ `denominator`, |a/b| ≤ `quotient`
/// and |b| = `divisor`: a'/b' − a/b = ((a' − a) − (a/b)(b' − b)) / b'. Infinite where b' may be 0.
pub(super) fn quotient_error(numerator: f64, quotient: f64, denominator: f64, divisor: f64) -> f64 {
    let smallest = divisor * (1.0 - ROUNDING) - denominator;
    if smallest > SMALL {
        (numerator + quotient * denominator) / smallest * INFLATION
    } else {
        f64::INFINITY
    }
}

/// Bound of |√x' − √max(x, 0)| for |x' − x| ≤ e, x' ≥ 0: the difference is e / (√x' + √x) ≤ e / √x,
/// and never more than √e. NaN stays NaN.
pub(super) fn square_root_error(x: f64, e: f64) -> f64 {
    if e == 0.0 {
        0.0
    } else if x > e {
        no_less(e / x.sqrt(), SMALL) * INFLATION
    } else {
        (2.0 * e).sqrt() * INFLATION
    }
}
