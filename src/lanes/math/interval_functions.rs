//! Elementary functions of intervals.
//!
//! Each rests on a kernel: an argument reduction and a truncated Taylor series in lanes, with a
//! relative error below 2⁻⁵¹ by the account beside it (u = 2⁻⁵³ is the unit roundoff). Results
//! are widened by 2⁻⁵⁰, which also covers the rounding of the widening itself. Monotone functions
//! are bounded at the ends of the interval; sine and cosine get ±1 where an extremum may lie
//! inside. Where a function may be undefined or jump is noted in a [`Domain`].

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, LN_2, LOG2_E, SQRT_2};

use super::functions::{self, ARCTAN, COS, SIN, in_quadrant, over_factorials, polynomial};
use super::instructions::DoubleLanes;
use super::interval::{Domain, Interval, down, lowered, raised, up};
use super::lanes::{Mask, Real};

/// 2⁻⁵⁰, twice the kernels' bound.
const WIDENING: f64 = 4.0 * f64::EPSILON;
/// π/2 − fl(π/2) rounded; off by less than 2⁻¹⁰⁷.
const FRAC_PI_2_LOW: f64 = 6.123_233_995_736_766e-17;
/// ln 2 − fl(ln 2) rounded; off by less than 2⁻¹⁰⁸.
const LN_2_LOW: f64 = 2.319_046_813_846_299_6e-17;
/// Beyond this many radians sine and cosine are only known to lie within ±1: up to here the
/// reduction by two words of π/2 keeps |k| · 2⁻¹⁰⁷ below 2⁻⁸⁶.
const LARGEST_ANGLE: f64 = 1_048_576.0;

/// [π/2] and [π] in f64: the literals are rounded to nearest, below the true values.
const HALF_PI: [f64; 2] = [FRAC_PI_2, FRAC_PI_2.next_up()];
const PI: [f64; 2] = [2.0 * FRAC_PI_2, 2.0 * FRAC_PI_2.next_up()];

/// The interval between the kernel's values at its ends, of an increasing function.
#[inline(always)]
fn increasing<L: DoubleLanes>(l: L, low: L::Real, high: L::Real) -> Interval<L> {
    Interval::new(l, lowered(l, low, WIDENING), raised(l, high, WIDENING))
}

/// eˣ for any x.
///
/// x = k ln 2 + r, |r| ≤ 0.3466. x − k·fl(ln 2) is exact: it is a multiple of 2⁻⁵⁴ (k ≠ 0 needs
/// |x| > 0.34) below ½. The low word then costs u|r| and less than 2⁻⁹⁷. The series to r¹³ leaves
/// 0.3466¹⁴/14! = 0.04u; evaluated by Horner with fused steps it is off by 2u. Together below 3u.
/// The power of two is applied in two halves, so that over- and underflow are rounded once.
#[inline(always)]
fn exp_kernel<L: DoubleLanes>(l: L, x: L::Real) -> L::Real {
    const EXP: [f64; 14] = over_factorials(0, 1, 1.0);
    // e⁻⁷⁴⁶ rounds to 0 and e⁷¹⁰ to ∞, and the widening bounds what lies beyond.
    let x = x.max(l.real(-746.0)).min(l.real(710.0));
    let k = (x * l.real(LOG2_E)).round();
    let r = k.mul_add(l.real(-LN_2), x);
    let r = k.mul_add(l.real(-LN_2_LOW), r);
    let series = polynomial(l, r, &EXP);
    let half = (k * l.real(0.5)).floor();
    series * l.power_of_two(half) * l.power_of_two(k - half)
}

/// (sin x, cos x, k) for |x| ≤ [`LARGEST_ANGLE`], x = kπ/2 + r with |r| ≤ π/4.
///
/// x − k·fl(π/2) is exact: a multiple of 2⁻⁵³ below 1. The low word costs u|r| and |k|·2⁻¹⁰⁷. The
/// series leave 1e-19 and 0.02u; by Horner sin r is off by 1.3u + u and cos r by 2.3u, with r's own
/// error at most 3.4u relative to the result and, where that is small, |k|·2⁻¹⁰⁷.
#[inline(always)]
fn sine_kernel<L: DoubleLanes>(l: L, x: L::Real) -> (L::Real, L::Real, L::Real) {
    let k = (x * l.real(2.0 * FRAC_1_PI)).round();
    let r = k.mul_add(l.real(-FRAC_PI_2), x);
    let r = k.mul_add(l.real(-FRAC_PI_2_LOW), r);
    let rr = r * r;
    let s = polynomial(l, rr, &SIN) * r;
    let c = polynomial(l, rr, &COS);
    // 2²¹ is a multiple of 4 above any |k|.
    let (sine, cosine) = in_quadrant(l, l.truncate(k + l.real(2_097_152.0)), (s, c));
    (sine, cosine, k)
}

/// arctan x for any x.
///
/// Reduced by π/4 and π/2 to |z| ≤ tan(π/8) = 0.4142: z = x, (|x| − 1)/(|x| + 1) or −1/|x|. The
/// quotient is off by 3u relative to z, whose arc tangent is at most half of the result where a
/// constant is added; the series to z⁴¹ leaves 2e-18 and is off by 2u. Together below 4u.
#[inline(always)]
fn atan_kernel<L: DoubleLanes>(l: L, x: L::Real) -> L::Real {
    const TAN_PI_8: f64 = SQRT_2 - 1.0;
    let one = l.real(1.0);
    let a = x.abs();
    let (middle, large) = (a.gt(l.real(TAN_PI_8)), a.gt(l.real(SQRT_2 + 1.0)));
    let numerator = l.select(large, -one, l.select(middle, a - one, a));
    let denominator = l.select(large, a, l.select(middle, a + one, one));
    let z = numerator / denominator;
    let series = polynomial(l, z * z, &ARCTAN) * z;
    let constant = l.select(middle, l.real(FRAC_PI_4), l.real(0.0));
    let constant = l.select(large, l.real(FRAC_PI_2), constant);
    (constant + series).copysign(x)
}

/// sinh x for |x| ≤ 1: the series to x¹⁷ leaves 1/19! = 0.08u; 2u by Horner.
#[inline(always)]
fn small_sinh_kernel<L: DoubleLanes>(l: L, x: L::Real) -> L::Real {
    const SINH: [f64; 9] = over_factorials(1, 2, 1.0);
    polynomial(l, x * x, &SINH) * x
}

impl<L: DoubleLanes> Interval<L> {
    #[inline(always)]
    pub fn square_root_noted(self, domain: &mut Domain<L>) -> Self {
        let zero = self.lanes.real(0.0);
        domain.note(!self.low.ge(zero), self.high.lt(zero));
        self.square_root()
    }

    #[inline(always)]
    pub fn quotient_noted(self, other: Self, domain: &mut Domain<L>) -> Self {
        domain.note(other.may_be_zero(), other.is_zero());
        self / other
    }

    #[inline(always)]
    pub fn exponential(self) -> Self {
        let l = self.lanes;
        let e = increasing(l, exp_kernel(l, self.low), exp_kernel(l, self.high));
        Self::new(l, e.low.max(l.real(0.0)), e.high)
    }

    /// ln x.
    ///
    /// [`functions::ln`] is good to 3½ ulp, below 2⁻⁵⁰ relative, with the rounding of the widening
    /// below 2⁻⁴⁹; it wants normal numbers, so subnormal ones are scaled.
    #[inline(always)]
    pub fn logarithm(self, domain: &mut Domain<L>) -> Self {
        let l = self.lanes;
        let (zero, infinity) = (l.real(0.0), l.real(f64::INFINITY));
        let positive = self.low.gt(zero);
        domain.note(!positive, !self.high.gt(zero));
        let at = inlined!(|x: L::Real| {
            let small = x.lt(l.real(f64::MIN_POSITIVE));
            let scaled = l.select(small, x * l.real(18_014_398_509_481_984.0), x);
            let ln = functions::ln(l, scaled);
            l.select(small, ln - l.real(54.0 * LN_2), ln)
        });
        let low = lowered(l, at(self.low), 2.0 * WIDENING);
        let high = raised(l, at(self.high), 2.0 * WIDENING);
        let unbounded = l.real(f64::NEG_INFINITY);
        Self::new(
            l,
            l.select(positive & self.low.lt(infinity), low, unbounded),
            l.select(self.high.gt(zero) & self.high.lt(infinity), high, infinity),
        )
    }

    /// Where an angle may be beyond [`LARGEST_ANGLE`].
    #[inline(always)]
    fn is_huge_angle(&self) -> L::Mask {
        let largest = self.lanes.real(LARGEST_ANGLE);
        !(self.low.ge(-largest) & self.high.le(largest))
    }

    #[inline(always)]
    pub fn sine_cosine(self) -> (Self, Self) {
        let l = self.lanes;
        let one = l.real(1.0);
        let (sa, ca, ka) = sine_kernel(l, self.low);
        let (sb, cb, kb) = sine_kernel(l, self.high);
        let slack = ka.abs().max(kb.abs()) * l.real(1.0 / (1u128 << 105) as f64);
        let between = inlined!(|a: L::Real, b: L::Real| {
            let low = lowered(l, a.min(b), WIDENING) - slack;
            let high = raised(l, a.max(b), WIDENING) + slack;
            (low, high)
        });
        // The ends in turns, outward: 1/(2π) is off by u relative, the product by u more.
        let turns = l.real(0.5 * FRAC_1_PI);
        let from = lowered(l, self.low * turns, WIDENING);
        let to = raised(l, self.high * turns, WIDENING);
        // Whether a whole number plus `shift` lies in [from, to].
        let passes = inlined!(|shift: f64| {
            let shift = l.real(shift);
            up(l, to - shift).floor().ge(down(l, from - shift))
        });
        let huge = self.is_huge_angle();
        let bounded = inlined!(|(low, high): (L::Real, L::Real), top: f64, bottom: f64| {
            let low = l.select(huge | passes(bottom), -one, low);
            let high = l.select(huge | passes(top), one, high);
            Self::new(l, low.max(-one), high.min(one))
        });
        (
            bounded(between(sa, sb), 0.25, 0.75),
            bounded(between(ca, cb), 0.0, 0.5),
        )
    }

    /// (sin x, cos x) of a short interval: one kernel at its middle m, and |sin x − sin m| ≤
    /// |x − m|. Valid for any length.
    #[inline(always)]
    pub fn sine_cosine_thin(self) -> (Self, Self) {
        let l = self.lanes;
        let one = l.real(1.0);
        let middle = (self.low + self.high) * l.real(0.5);
        let radius = up(l, (middle - self.low).max(self.high - middle));
        let (s, c, k) = sine_kernel(l, middle);
        let slack = up(l, k.abs() * l.real(1.0 / (1u128 << 105) as f64) + radius);
        let huge = self.is_huge_angle();
        let around = inlined!(|x: L::Real| {
            let low = down(l, lowered(l, x, WIDENING) - slack);
            let high = up(l, raised(l, x, WIDENING) + slack);
            let low = l.select(huge, -one, low.max(-one));
            let high = l.select(huge, one, high.min(one));
            Self::new(l, low, high)
        });
        (around(s), around(c))
    }

    /// tan x; the whole line where a pole may lie inside.
    #[inline(always)]
    pub fn tangent(self, domain: &mut Domain<L>) -> Self {
        let l = self.lanes;
        let half_turns = l.real(FRAC_1_PI);
        let half = l.real(0.5);
        let from = down(l, lowered(l, self.low * half_turns, WIDENING) - half);
        let to = up(l, raised(l, self.high * half_turns, WIDENING) - half);
        let huge = self.is_huge_angle();
        let pole = huge | to.floor().ge(from);
        domain.note(pole, l.mask(false));
        let at = inlined!(|x: L::Real| {
            let (s, c) = Self::point(l, x).sine_cosine_thin();
            s / c
        });
        let (low, high) = (at(self.low), at(self.high));
        Self::new(l, low.low, high.high).whole_where(pole)
    }

    #[inline(always)]
    pub fn arc_tangent(self) -> Self {
        let l = self.lanes;
        let a = increasing(l, atan_kernel(l, self.low), atan_kernel(l, self.high));
        let [_, half_pi] = HALF_PI;
        Self::new(l, a.low.max(l.real(-half_pi)), a.high.min(l.real(half_pi)))
    }

    /// Arc sine as arctan(x/√((1 − x)(1 + x))); outside [−1, 1] undefined.
    #[inline(always)]
    pub fn arc_sine(self, domain: &mut Domain<L>) -> Self {
        let l = self.lanes;
        let (a, b) = self.clipped_to_one(domain);
        let at = inlined!(|x: Self| {
            let one = Self::splat(l, [1.0, 1.0]);
            (x / ((one - x) * (one + x)).square_root()).arc_tangent()
        });
        Self::new(l, at(a).low, at(b).high)
    }

    /// Arc cosine as 2 arctan √((1 − x)/(1 + x)); outside [−1, 1] undefined.
    #[inline(always)]
    pub fn arc_cosine(self, domain: &mut Domain<L>) -> Self {
        let l = self.lanes;
        let (a, b) = self.clipped_to_one(domain);
        let at = inlined!(|x: Self| {
            let one = Self::splat(l, [1.0, 1.0]);
            let angle = ((one - x) / (one + x)).square_root().arc_tangent();
            angle.times_number(2.0)
        });
        let [_, pi] = PI;
        Self::new(l, at(b).low.max(l.real(0.0)), at(a).high.min(l.real(pi)))
    }

    /// Both ends moved into [−1, 1].
    #[inline(always)]
    fn clipped_to_one(self, domain: &mut Domain<L>) -> (Self, Self) {
        let l = self.lanes;
        let one = l.real(1.0);
        let inside = self.low.ge(-one) & self.high.le(one);
        domain.note(!inside, self.low.gt(one) | self.high.lt(-one));
        let clip = inlined!(|x: L::Real| Self::point(l, x.max(-one).min(one)));
        (clip(self.low), clip(self.high))
    }

    /// Angle of the point (x, y) = (other, self).
    ///
    /// Away from the origin and the negative x axis the angle is monotone along each edge of the
    /// box, so that its extremes are at corners. The rounded quotient is off by u, which passes to
    /// its arc tangent at most undiminished: together with the kernel below 2⁻⁵⁰·⁵, hence the
    /// doubled widening. Where the box may meet the negative x axis the angle may jump, and is
    /// only known to lie in [−π, π].
    #[inline(always)]
    pub fn arc_tangent_of_quotient(self, other: Self, domain: &mut Domain<L>) -> Self {
        let l = self.lanes;
        let zero = l.real(0.0);
        let (x, y) = (other, self);
        let corner = inlined!(|x: L::Real, y: L::Real| {
            // The quotient of the smaller by the larger magnitude; x ≥ |y|: arctan(y/x);
            // y > 0: π/2 − arctan(x/y); y < 0: −π/2 − arctan(x/y); x < 0: ±π + arctan(y/x).
            let steep = y.abs().gt(x.abs());
            let (numerator, denominator) = (l.select(steep, -x, y), l.select(steep, y, x));
            let angle = atan_kernel(l, numerator / denominator);
            let flat = l.select(x.lt(zero), l.real(2.0 * FRAC_PI_2), zero);
            let constant = l.select(steep, l.real(FRAC_PI_2), flat);
            let constant = l.select(y.lt(zero), -constant, constant);
            constant + angle
        });
        let [a, b] = [corner(x.low, y.low), corner(x.low, y.high)];
        let [c, d] = [corner(x.high, y.low), corner(x.high, y.high)];
        let Self { low, high, .. } = Self::around(l, [a, b, c, d], 2.0 * WIDENING);
        let origin = x.may_be_zero() & y.may_be_zero();
        let cut = !x.low.ge(zero) & y.low.lt(zero) & !y.high.lt(zero);
        domain.note(origin | cut, x.is_zero() & y.is_zero());
        let pi = l.real(PI[1]);
        let anywhere = Self::new(l, -pi, pi);
        let angle = Self::new(l, low.max(-pi), high.min(pi));
        anywhere.or_where_not(origin | cut, angle)
    }

    /// sinh x: the series within ±1, otherwise (eˣ − e⁻ˣ)/2.
    #[inline(always)]
    pub fn hyperbolic_sine(self) -> Self {
        let l = self.lanes;
        let at = inlined!(|x: L::Real| {
            let small = x.abs().le(l.real(1.0));
            let series = small_sinh_kernel(l, x);
            let point = Self::point(l, x);
            let far = (point.exponential() - (-point).exponential()).times_number(0.5);
            increasing(l, series, series).or_where_not(small, far)
        });
        Self::new(l, at(self.low).low, at(self.high).high)
    }

    /// cosh x = (e^|x| + e^−|x|)/2, which grows with |x|.
    #[inline(always)]
    pub fn hyperbolic_cosine(self) -> Self {
        let l = self.lanes;
        let at = inlined!(|x: L::Real| {
            let point = Self::point(l, x);
            (point.exponential() + (-point).exponential()).times_number(0.5)
        });
        let low = at(self.mignitude()).low.max(l.real(1.0));
        Self::new(l, low, at(self.magnitude()).high)
    }

    /// tanh x = sinh x / cosh x within ±1, otherwise 1 − 2/(e^2|x| + 1) with the sign of x.
    #[inline(always)]
    pub fn hyperbolic_tangent(self) -> Self {
        let l = self.lanes;
        let one = l.real(1.0);
        let at = inlined!(|x: L::Real| {
            let small = x.abs().le(one);
            let point = Self::point(l, x);
            let near = point.hyperbolic_sine() / point.hyperbolic_cosine();
            let unit = Self::splat(l, [1.0, 1.0]);
            // Beyond 20 tanh is within 1e-17 of 1; the clipping keeps the quotient finite.
            let twice = Self::point(l, x.abs().min(l.real(20.0)) * l.real(2.0));
            let far = unit - unit.times_number(2.0) / (twice.exponential() + unit);
            let far_high = l.select(x.abs().gt(l.real(20.0)), one, far.high);
            let far = Self::new(l, far.low, far_high);
            let far = (-far).or_where_not(x.lt(l.real(0.0)), far);
            near.or_where_not(small, far)
        });
        let (low, high) = (at(self.low), at(self.high));
        Self::new(l, low.low.max(-one), high.high.min(one))
    }

    /// xʸ = e^(y ln x), undefined for x ≤ 0.
    #[inline(always)]
    pub fn power(self, exponent: Self, domain: &mut Domain<L>) -> Self {
        let raised = (exponent * self.logarithm(domain)).exponential();
        debug_assert!(!raised.low.lt(self.lanes.real(0.0)).any());
        raised
    }
}
