//! Intervals with outward rounding, the same bits in one lane as in eight.
//!
//! An interval [low, high] holds every real number that its operands could have given. Each bound
//! is computed with rounding to nearest, the only one there is on every machine, and moved one
//! step outward: the true result lies between the neighbours of the rounded one. What cannot be
//! bounded (0·∞, ∞ − ∞, overflow, division by an interval that holds 0) becomes the whole line.
//!
//! The step outward is that of Rump, Zimmermann, Boldo, Melquiond (2009), "Computing predecessor
//! and successor in rounding to nearest", BIT 49: with u = 2⁻⁵³, φ = u (1 + 2u), η = 2⁻¹⁰⁷⁴,
//!
//! > x − (φ|x| + η), each operation rounded to nearest, is at most the predecessor of x.
//!
//! Let 2ᵏ ≤ |x| < 2ᵏ⁺¹. Where φ|x| is a normal number its rounded value is at least 2ᵏu(1 + 2u),
//! for that is a number, and so more than half a unit 2ᵏ⁺¹u of x; where it is subnormal rounding
//! loses η/2 at most and η is added. A difference below the middle between x and its predecessor
//! is rounded to the predecessor or less; below a power of two the predecessor is nearer still.
//! The last argument does not use that the compiler leaves products and sums apart: fused, the
//! sum φ|x| + η is rounded once instead of twice, and is the larger of two neighbours or exact.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_rational::BigRational;
use num_traits::ToPrimitive;

use super::instructions::DoubleLanes;
use super::lanes::Real;
use super::scalar_lane::One;

/// u (1 + 2u), see the module's head.
const STEP: f64 = (1.0 + f64::EPSILON) * (0.5 * f64::EPSILON);
const TINY: f64 = f64::from_bits(1);

/// A number at or below whatever rounds to `x`; −∞ for NaN and +∞.
#[inline(always)]
pub fn down<L: DoubleLanes>(l: L, x: L::Real) -> L::Real {
    lowered(l, x, STEP)
}

/// A number at or above whatever rounds to `x`; +∞ for NaN and −∞.
#[inline(always)]
pub fn up<L: DoubleLanes>(l: L, x: L::Real) -> L::Real {
    raised(l, x, STEP)
}

/// x − (relative · |x| + 2⁻¹⁰⁷⁴); −∞ for NaN and +∞.
#[inline(always)]
pub(super) fn lowered<L: DoubleLanes>(l: L, x: L::Real, relative: f64) -> L::Real {
    let step = x.abs() * l.real(relative) + l.real(TINY);
    // A comparison with NaN is false, and the maximum then is its second operand.
    (x - step).max(l.real(f64::NEG_INFINITY))
}

/// x + (relative · |x| + 2⁻¹⁰⁷⁴); +∞ for NaN and −∞.
#[inline(always)]
pub(super) fn raised<L: DoubleLanes>(l: L, x: L::Real, relative: f64) -> L::Real {
    let step = x.abs() * l.real(relative) + l.real(TINY);
    (x + step).min(l.real(f64::INFINITY))
}

/// All real numbers from `low` to `high`, in each lane.
#[derive(Debug, Clone, Copy)]
pub struct Interval<L: DoubleLanes> {
    pub lanes: L,
    /// The lower bound; −∞ where there is none.
    pub low: L::Real,
    /// The upper bound; +∞ where there is none.
    pub high: L::Real,
}

pub type ScalarInterval = Interval<One>;

impl<L: DoubleLanes> Interval<L> {
    methods! {
        /// From `low` to `high`; the caller sees to low ≤ high.
        pub fn new(lanes: L, low: L::Real, high: L::Real) -> Self = Self { lanes, low, high };
        fn with(self, low: L::Real, high: L::Real) -> Self = Self { low, high, ..self };
        pub fn point(lanes: L, x: L::Real) -> Self = Self::new(lanes, x, x);
        /// The same interval in each lane.
        pub fn splat(lanes: L, [low, high]: [f64; 2]) -> Self =
            Self::new(lanes, lanes.real(low), lanes.real(high));
        pub fn whole(lanes: L) -> Self = Self::splat(lanes, [f64::NEG_INFINITY, f64::INFINITY]);
        /// All numbers that may have been rounded to `low`, to `high` or to one between them.
        pub(super) fn outward(lanes: L, low: L::Real, high: L::Real) -> Self =
            Self::new(lanes, down(lanes, low), up(lanes, high));
        pub fn whole_where(self, mask: L::Mask) -> Self =
            Self::whole(self.lanes).or_where_not(mask, self);
        pub fn hull(self, other: Self) -> Self =
            self.with(self.low.min(other.low), self.high.max(other.high));
        pub fn smaller(self, other: Self) -> Self =
            self.with(self.low.min(other.low), self.high.min(other.high));
        pub fn larger(self, other: Self) -> Self =
            self.with(self.low.max(other.low), self.high.max(other.high));
        /// The largest |x|.
        pub fn magnitude(&self) -> L::Real = self.low.abs().max(self.high.abs());
        /// The smallest |x|.
        pub fn mignitude(&self) -> L::Real = self.low.max(-self.high).max(self.lanes.real(0.0));
        pub fn absolute(self) -> Self = self.with(self.mignitude(), self.magnitude());
        pub fn squared(self) -> Self = self.absolute().nonnegative_product(self.absolute());
    }

    /// Lane by lane `self` where the mask is true, else `other`.
    #[inline(always)]
    pub fn or_where_not(self, mask: L::Mask, other: Self) -> Self {
        let select = inlined!(|a: L::Real, b: L::Real| self.lanes.select(mask, a, b));
        self.with(select(self.low, other.low), select(self.high, other.high))
    }

    /// Where 0 may be among the numbers.
    #[inline(always)]
    pub fn may_be_zero(&self) -> L::Mask {
        let zero = self.lanes.real(0.0);
        !(self.low.gt(zero) | self.high.lt(zero))
    }

    /// Where 0 is the only number.
    #[inline(always)]
    pub fn is_zero(&self) -> L::Mask {
        let zero = self.lanes.real(0.0);
        self.low.same(zero) & self.high.same(zero)
    }

    /// √x of what is not negative in x.
    #[inline(always)]
    pub fn square_root(self) -> Self {
        let l = self.lanes;
        let zero = l.real(0.0);
        // √ of NaN is NaN and becomes unbounded; a negative upper bound is the caller's to see.
        let low = down(l, self.low.max(zero).sqrt()).max(zero);
        Self::new(l, low, up(l, self.high.sqrt()))
    }

    #[inline(always)]
    pub fn times_number(self, c: f64) -> Self {
        let l = self.lanes;
        let (a, b) = if c < 0.0 {
            (self.high, self.low)
        } else {
            (self.low, self.high)
        };
        Self::outward(l, a * l.real(c), b * l.real(c))
    }

    /// x · y for two intervals without negative numbers.
    #[inline(always)]
    pub fn nonnegative_product(self, other: Self) -> Self {
        let l = self.lanes;
        // 0·∞ is NaN and becomes unbounded below, which 0 replaces.
        let low = down(l, self.low * other.low).max(l.real(0.0));
        Self::new(l, low, up(l, self.high * other.high))
    }

    /// xⁿ by repeated squaring; where n is negative and x may be 0, the whole line.
    #[inline(always)]
    pub fn whole_power(self, n: i32) -> Self {
        let l = self.lanes;
        if n == 0 {
            return Self::splat(l, [1.0, 1.0]);
        }
        let count = n.unsigned_abs();
        let power = if count.is_multiple_of(2) {
            self.absolute().nonnegative_power(count)
        } else {
            // Odd powers are monotone: each bound is the power of a bound.
            let zero = l.real(0.0);
            let low = Self::point(l, self.low.abs()).nonnegative_power(count);
            let high = Self::point(l, self.high.abs()).nonnegative_power(count);
            Self::new(
                l,
                l.select(self.low.lt(zero), -low.high, low.low),
                l.select(self.high.lt(zero), -high.low, high.high),
            )
        };
        if n < 0 {
            Self::splat(l, [1.0, 1.0]) / power
        } else {
            power
        }
    }

    #[inline(always)]
    fn nonnegative_power(self, count: u32) -> Self {
        let mut square = self;
        let mut left = count;
        while left.is_multiple_of(2) {
            square = square.nonnegative_product(square);
            left /= 2;
        }
        let mut power = square;
        left /= 2;
        while left > 0 {
            square = square.nonnegative_product(square);
            if left % 2 == 1 {
                power = power.nonnegative_product(square);
            }
            left /= 2;
        }
        power
    }

    /// The smallest interval around four numbers and what rounding may have taken from them; the
    /// whole line where one of them is NaN or infinite.
    #[inline(always)]
    pub(super) fn around(l: L, [a, b, c, d]: [L::Real; 4], relative: f64) -> Self {
        // 0 for finite numbers, NaN otherwise; minimum and maximum alone could lose a NaN.
        let check = ((a + b) + (c + d)) * l.real(0.0);
        let low = a.min(b).min(c.min(d)) + check;
        let high = a.max(b).max(c.max(d)) + check;
        Self::new(l, lowered(l, low, relative), raised(l, high, relative))
    }
}

impl<L: DoubleLanes> Add for Interval<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::outward(self.lanes, self.low + other.low, self.high + other.high)
    }
}

impl<L: DoubleLanes> Sub for Interval<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::outward(self.lanes, self.low - other.high, self.high - other.low)
    }
}

impl<L: DoubleLanes> Mul for Interval<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, Self { low, high, .. }: Self) -> Self {
        let [a, b] = [self.low * low, self.low * high];
        let [c, d] = [self.high * low, self.high * high];
        Self::around(self.lanes, [a, b, c, d], STEP)
    }
}

impl<L: DoubleLanes> Div for Interval<L> {
    type Output = Self;
    /// The whole line where the divisor may be 0.
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (low, high) = (other.low, other.high);
        let [a, b] = [self.low / low, self.low / high];
        let [c, d] = [self.high / low, self.high / high];
        Self::around(self.lanes, [a, b, c, d], STEP).whole_where(other.may_be_zero())
    }
}

impl<L: DoubleLanes> Neg for Interval<L> {
    type Output = Self;
    methods! { fn neg(self) -> Self = self.with(-self.high, -self.low); }
}

/// The narrowest bounds in f64 of an exact rational; the whole line beyond the range of f64.
pub fn enclosing_rational(x: &BigRational) -> [f64; 2] {
    const WHOLE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
    let Some(near) = x.to_f64().filter(|near| near.is_finite()) else {
        return WHOLE;
    };
    // The conversion may be off by a unit or two; comparison of exact numbers settles it.
    let step = [near.next_down(), near, near.next_up()];
    let low = step.iter().rev().find(|y| at_most(**y, x));
    let high = step.iter().find(|y| at_most(-**y, &-x));
    match (low, high) {
        (Some(low), Some(high)) => [*low, *high],
        _ => WHOLE,
    }
}

fn at_most(y: f64, x: &BigRational) -> bool {
    BigRational::from_float(y).is_some_and(|y| y <= *x)
}

/// Lanes of an evaluation in which the function may be undefined or jump.
#[derive(Debug, Clone, Copy)]
pub struct Domain<L: DoubleLanes> {
    /// The function may be undefined or jump somewhere in the interval.
    pub broken: L::Mask,
    /// The function is undefined everywhere in the interval.
    pub void: L::Mask,
    /// For operations that may jump, in order: lanes that take the one side of the jump.
    sides: [L::Mask; SIDES],
    /// The next of them.
    next: usize,
}

/// Jumps whose sides are looked at apart: 2³ combinations fill eight lanes.
const SIDES: usize = 3;

impl<L: DoubleLanes> Domain<L> {
    #[inline(always)]
    pub fn unbroken(l: L) -> Self {
        Self {
            broken: l.mask(false),
            void: l.mask(false),
            sides: [l.mask(false); SIDES],
            next: 0,
        }
    }

    /// The same, for lanes from `place` on of eight that take all combinations of sides.
    #[inline(always)]
    pub fn with_sides(l: L, place: usize) -> Self {
        let side = inlined!(|bits: u32| l.mask_from_bits(bits >> place));
        Self {
            sides: [side(0xaa), side(0xcc), side(0xf0)],
            ..Self::unbroken(l)
        }
    }

    /// The sides of the next operation that may jump; none left after three.
    #[inline(always)]
    pub fn next_side(&mut self) -> Option<L::Mask> {
        let side = self.sides.get(self.next).copied();
        self.next += 1;
        side
    }

    /// Notes where an operation may be undefined or jump, and where it surely is undefined.
    #[inline(always)]
    pub fn note(&mut self, broken: L::Mask, void: L::Mask) {
        self.broken = self.broken | broken;
        self.void = self.void | void;
    }
}
