//! Numbers with a bound of their own error: one interface for every tier of the ladder
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
    /// self / other. For values, never for decisions: on the exact tier it is truncated to
    /// [`exact::VALUE_BITS`](super::exact::VALUE_BITS).
    fn divided_by(&self, other: &Self) -> Self;
    /// √self, of a number that is ≥ 0. For values, never for decisions.
    fn square_root(&self) -> Self;
    /// The nearest f64, or one of its neighbours.
    fn to_f64(&self) -> f64;
    /// Bound of |value − truth|; infinite or NaN where there is none.
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

/// One or several f64 whose sum approximates a real number, with bounds of its rounding errors.
pub trait Approximation: Copy + PartialEq {
    const ZERO: Self;
    /// Bound of the relative error of sums and products, with room for the subnormal rounding of
    /// the bound itself.
    const ROUNDING: f64;
    /// Products below this may have underflowed in part; their error is bounded as if they were
    /// this large.
    const SMALL: f64;
    /// No number is smaller than this part of its head.
    const LEAST: f64;
    /// Factor on the error that a product inherits, which is computed from heads alone.
    const PRODUCT: f64;
    fn of(x: f64) -> Self;
    /// The nearest to a number, and whether it is the number itself.
    fn nearest(x: &Exact) -> (Self, bool);
    /// The f64 nearest to it.
    fn head(self) -> f64;
    fn plus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn negated(self) -> Self;
    /// self / other, and a bound of the error besides [`ROUNDING`](Self::ROUNDING).
    fn over(self, other: Self) -> (Self, f64);
    /// The same for √self; `None` where there is no approximation but 0.
    fn root(self) -> Option<(Self, f64)>;
}

impl Approximation for f64 {
    const ZERO: Self = 0.0;
    /// Twice the unit roundoff: a correctly rounded result is off by half of this at most.
    const ROUNDING: f64 = f64::EPSILON;
    /// 1e-280 · 2⁻⁵² ≈ 2⁻⁹⁸² is far above the few 2⁻¹⁰⁷⁴ that underflow can cost a value and its
    /// error bound together.
    const SMALL: f64 = 1e-280;
    const LEAST: f64 = 1.0;
    const PRODUCT: f64 = 1.0;
    methods! {
        fn of(x: f64) -> Self = x;
        fn head(self) -> f64 = self;
        fn plus(self, other: Self) -> Self = self + other;
        fn times(self, other: Self) -> Self = self * other;
        fn negated(self) -> Self = -self;
        fn over(self, other: Self) -> (Self, f64) = (self / other, 0.0);
        fn root(self) -> Option<(Self, f64)> = Some((self.max(0.0).sqrt(), 0.0));
    }
    fn nearest(x: &Exact) -> (Self, bool) {
        let value = x.to_f64();
        (value, value.is_finite() && x.is(value))
    }
}

/// The error bound is a sum of positive terms computed with at most 6 roundings of relative
/// size ≤ 2⁻⁵³ each, so that this factor covers them.
pub(super) const INFLATION: f64 = 1.0 + 8.0 * f64::EPSILON;

/// An approximation with a running forward error bound (Wilkinson 1963, *Rounding Errors in
/// Algebraic Processes*, ch. 1).
#[derive(Debug, Clone, Copy)]
pub struct Bounded<A = f64> {
    pub(super) value: A,
    error: f64,
}

impl<A: Approximation> Bounded<A> {
    /// Zero without error: it annihilates whatever it is multiplied with.
    #[inline]
    fn is_exact_zero(&self) -> bool {
        self.value == A::ZERO && self.error == 0.0
    }

    /// A number taken as the exact value.
    #[inline]
    pub(super) fn exactly(value: A) -> Self {
        Self { value, error: 0.0 }
    }

    /// A rounded result, whose operands put `inherited` into its error.
    #[inline]
    fn rounded(value: A, inherited: f64) -> Self {
        let rounding = A::ROUNDING * no_less(value.head().abs(), A::SMALL);
        Self {
            value,
            error: INFLATION * (inherited + rounding),
        }
    }
}

impl<A: Approximation> Number for Bounded<A> {
    methods! {
        fn negated(&self) -> Self = Self { value: self.value.negated(), ..*self };
        fn to_f64(&self) -> f64 = self.value.head();
        fn error(&self) -> f64 = self.error;
    }

    #[inline]
    fn scaled(x: f64, exponent: i32) -> Self {
        let value = x * power_of_two(exponent);
        let exact = exponent == 0 || x == 0.0 || value.abs() >= f64::MIN_POSITIVE;
        let error = match (value.is_finite(), exact) {
            (false, _) => f64::INFINITY,
            (true, true) => 0.0,
            (true, false) => A::ROUNDING * A::SMALL,
        };
        let value = A::of(value);
        Self { value, error }
    }

    fn enclosing(x: &Exact) -> Self {
        let (value, exact) = A::nearest(x);
        let rounding = A::ROUNDING * no_less(value.head().abs(), A::SMALL);
        let error = if exact { 0.0 } else { rounding };
        Self { value, error }
    }

    #[inline]
    fn plus(&self, other: &Self) -> Self {
        let value = self.value.plus(other.value);
        Self {
            value,
            error: INFLATION * (self.error + other.error + A::ROUNDING * value.head().abs()),
        }
    }

    #[inline]
    fn times(&self, other: &Self) -> Self {
        if self.is_exact_zero() || other.is_exact_zero() {
            return Self::exactly(A::ZERO);
        }
        let (a, b) = (self.value.head().abs(), other.value.head().abs());
        let inherited = (a * other.error + self.error * (b + other.error)) * A::PRODUCT;
        Self::rounded(self.value.times(other.value), inherited)
    }

    #[inline]
    fn sign(&self) -> Option<Ordering> {
        let least = A::LEAST * self.value.head();
        // A NaN in either number fails every comparison and so stays undecided.
        if least > self.error {
            Some(Ordering::Greater)
        } else if -least > self.error {
            Some(Ordering::Less)
        } else if self.is_exact_zero() {
            Some(Ordering::Equal)
        } else {
            None
        }
    }

    #[inline]
    fn divided_by(&self, other: &Self) -> Self {
        let (value, residual) = self.value.over(other.value);
        let quotient = value.head().abs() * (1.0 + f64::EPSILON);
        let divisor = other.value.head().abs();
        let inherited = quotient_error(self.error, quotient, other.error, divisor);
        Self::rounded(value, inherited + residual)
    }

    #[inline]
    fn square_root(&self) -> Self {
        let inherited = square_root_error(self.value.head(), self.error);
        match self.value.root() {
            Some((value, residual)) => Self::rounded(value, inherited + residual),
            // The truth is ≥ 0 and ≤ error − |head|.
            None => Self {
                value: A::ZERO,
                error: inherited,
            },
        }
    }
}

/// The larger of the two, but NaN where x is NaN (`f64::max` would hide it).
#[inline]
fn no_less(x: f64, least: f64) -> f64 {
    if x < least { least } else { x }
}

/// Bound of |a'/b' − a/b| for |a' − a| ≤ `numerator`, |b' − b| ≤ `denominator`, |a/b| ≤ `quotient`
/// and |b| = `divisor`: a'/b' − a/b = ((a' − a) − (a/b)(b' − b)) / b'. Infinite where b' may be 0.
pub(super) fn quotient_error(numerator: f64, quotient: f64, denominator: f64, divisor: f64) -> f64 {
    let smallest = divisor * (1.0 - f64::ROUNDING) - denominator;
    if smallest > f64::SMALL {
        (numerator + quotient * denominator) / smallest * INFLATION
    } else {
        f64::INFINITY
    }
}

/// Bound of |√x' − √max(x, 0)| for |x' − x| ≤ e, x' ≥ 0: the difference is e / (√x' + √x) ≤ e / √x,
/// and never more than √e. NaN stays NaN.
fn square_root_error(x: f64, e: f64) -> f64 {
    if e == 0.0 {
        0.0
    } else if x > e {
        no_less(e / x.sqrt(), f64::SMALL) * INFLATION
    } else {
        (2.0 * e).sqrt() * INFLATION
    }
}
