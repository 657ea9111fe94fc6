//! The arithmetics of a program: intervals, intervals with slopes, intervals beside jumps.

use super::super::tape::{Binary, Unary};
use crate::math::instructions::DoubleLanes;
use crate::math::interval::{Domain, Interval};
use crate::math::jet::Jet;
use crate::math::lanes::Real;

/// An arithmetic that evaluates programs.
pub(super) trait Arithmetic<L: DoubleLanes>: Copy {
    fn constant(value: Interval<L>) -> Self;
    fn unary(self, function: Unary, domain: &mut Domain<L>) -> Self;
    fn binary(self, function: Binary, other: Self, domain: &mut Domain<L>) -> Self;
    fn whole_power(self, n: i32, domain: &mut Domain<L>) -> Self;
    fn squared(self) -> Self;
    fn times_number(self, c: f64) -> Self;
    fn plus_constant(self, c: Interval<L>) -> Self;
    fn sine_cosine(self) -> (Self, Self);
}

/// Functions of one value, one copy for each instruction set: they are long.
#[inline(never)]
fn function_of<L: DoubleLanes>(
    function: Unary,
    a: &Interval<L>,
    domain: &mut Domain<L>,
) -> Interval<L> {
    a.lanes.vectorize(inlined!(|| match function {
        Unary::Negative => -*a,
        Unary::SquareRoot => a.square_root_noted(domain),
        Unary::Absolute => a.absolute(),
        Unary::Exponential => a.exponential(),
        Unary::Logarithm => a.logarithm(domain),
        Unary::Sine => a.sine_cosine().0,
        Unary::Cosine => a.sine_cosine().1,
        Unary::Tangent => a.tangent(domain),
        Unary::ArcSine => a.arc_sine(domain),
        Unary::ArcCosine => a.arc_cosine(domain),
        Unary::ArcTangent => a.arc_tangent(),
        Unary::HyperbolicSine => a.hyperbolic_sine(),
        Unary::HyperbolicCosine => a.hyperbolic_cosine(),
        Unary::HyperbolicTangent => a.hyperbolic_tangent(),
    }))
}

/// aᵇ, the angle of the point (b, a): one copy for each instruction set.
#[inline(never)]
fn function_of_two<L: DoubleLanes>(
    function: Binary,
    [a, b]: [&Interval<L>; 2],
    domain: &mut Domain<L>,
) -> Interval<L> {
    a.lanes.vectorize(inlined!(|| match function {
        Binary::Power => a.power(*b, domain),
        _ => a.arc_tangent_of_quotient(*b, domain),
    }))
}

/// The slope of a function of one value: a′ times a factor, or a′ over a divisor.
#[inline(never)]
fn slope_of<L: DoubleLanes>(
    function: Unary,
    a: &Jet<L>,
    value: &Interval<L>,
    domain: &mut Domain<L>,
) -> Interval<L> {
    a.value.lanes.vectorize(inlined!(|| {
        let one = Interval::splat(a.value.lanes, [1.0, 1.0]);
        let (x, y) = (a.value, *value);
        let factor = match function {
            Unary::Negative => -one,
            Unary::Exponential => y,
            Unary::Sine => function_of(Unary::Cosine, &x, domain),
            Unary::Cosine => -function_of(Unary::Sine, &x, domain),
            Unary::Tangent => one + y.squared(),
            Unary::HyperbolicSine => function_of(Unary::HyperbolicCosine, &x, domain),
            Unary::HyperbolicCosine => function_of(Unary::HyperbolicSine, &x, domain),
            Unary::HyperbolicTangent => one - y.squared(),
            _ => one,
        };
        let divisor = match function {
            Unary::SquareRoot => y.times_number(2.0),
            Unary::Logarithm => x,
            Unary::ArcSine => ((one - x) * (one + x)).square_root(),
            Unary::ArcCosine => -((one - x) * (one + x)).square_root(),
            Unary::ArcTangent => one + x.squared(),
            _ => return a.slope * factor,
        };
        a.slope / divisor
    }))
}

/// A whole power: one copy for each instruction set.
#[inline(never)]
fn whole_power_of<L: DoubleLanes>(a: &Jet<L>, n: i32, domain: &mut Domain<L>) -> Jet<L> {
    let l = a.value.lanes;
    l.vectorize(inlined!(|| a.whole_power(n, domain)))
}

impl<L: DoubleLanes> Arithmetic<L> for Interval<L> {
    methods! {
        fn constant(value: Interval<L>) -> Self = value;
        fn unary(self, function: Unary, domain: &mut Domain<L>) -> Self =
            function_of(function, &self, domain);
        fn whole_power(self, n: i32, domain: &mut Domain<L>) -> Self =
            whole_power_of(&Jet::constant(self), n, domain).value;
        fn squared(self) -> Self = Interval::squared(self);
        fn times_number(self, c: f64) -> Self = Interval::times_number(self, c);
        fn plus_constant(self, c: Interval<L>) -> Self = self + c;
        fn sine_cosine(self) -> (Self, Self) = self.sine_cosine_thin();
    }
    #[inline(always)]
    fn binary(self, function: Binary, other: Self, domain: &mut Domain<L>) -> Self {
        match function {
            Binary::Sum => self + other,
            Binary::Difference => self - other,
            Binary::Product => self * other,
            Binary::Quotient => self.quotient_noted(other, domain),
            Binary::Minimum => self.smaller(other),
            Binary::Maximum => self.larger(other),
            Binary::ArcTangent2 | Binary::Power => {
                function_of_two(function, [&self, &other], domain)
            }
        }
    }
}

impl<L: DoubleLanes> Arithmetic<L> for Jet<L> {
    methods! {
        fn constant(value: Interval<L>) -> Self =
            Self::new(value, Interval::splat(value.lanes, [0.0, 0.0]));
        fn whole_power(self, n: i32, domain: &mut Domain<L>) -> Self =
            whole_power_of(&self, n, domain);
        fn squared(self) -> Self =
            self.chained(self.value.squared(), self.value.times_number(2.0));
        fn times_number(self, c: f64) -> Self =
            Self::new(self.value.times_number(c), self.slope.times_number(c));
        fn plus_constant(self, c: Interval<L>) -> Self = Self::new(self.value + c, self.slope);
    }
    #[inline(always)]
    fn unary(self, function: Unary, domain: &mut Domain<L>) -> Self {
        if function == Unary::Absolute {
            return self.absolute();
        }
        let value = function_of(function, &self.value, domain);
        Self::new(value, slope_of(function, &self, &value, domain))
    }
    #[inline(always)]
    fn binary(self, function: Binary, other: Self, domain: &mut Domain<L>) -> Self {
        match function {
            Binary::Sum => self.plus(other),
            Binary::Difference => self.minus(other),
            Binary::Product => self.times(other),
            Binary::Quotient => self.quotient(other, domain),
            Binary::Minimum => self.smaller(other),
            Binary::Maximum => self.larger(other),
            Binary::ArcTangent2 | Binary::Power => {
                let value = function_of_two(function, [&self.value, &other.value], domain);
                let slope = if function == Binary::Power {
                    let logarithm = function_of(Unary::Logarithm, &self.value, domain);
                    self.slope_of_power(other, value, logarithm)
                } else {
                    self.slope_of_angle(other)
                };
                Self::new(value, slope)
            }
        }
    }
    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        let (s, c) = self.value.sine_cosine();
        (self.chained(s, c), self.chained(c, -s))
    }
}

/// An interval on one side of each jump.
#[derive(Clone, Copy)]
pub struct Side<L: DoubleLanes>(pub(super) Interval<L>);

impl<L: DoubleLanes> Arithmetic<L> for Side<L> {
    methods! {
        fn constant(value: Interval<L>) -> Self = Self(value);
        fn squared(self) -> Self = Self(self.0.squared());
        fn times_number(self, c: f64) -> Self = Self(self.0.times_number(c));
        fn plus_constant(self, c: Interval<L>) -> Self = Self(self.0 + c);
    }
    #[inline(always)]
    fn unary(self, function: Unary, domain: &mut Domain<L>) -> Self {
        let side = (function == Unary::Tangent).then(|| domain.next_side());
        Self(match side.flatten() {
            Some(side) => self.0.tangent_beside_pole(side),
            None => function_of(function, &self.0, domain),
        })
    }
    #[inline(always)]
    fn binary(self, function: Binary, other: Self, domain: &mut Domain<L>) -> Self {
        let jumps = matches!(function, Binary::Quotient | Binary::ArcTangent2);
        let side = jumps.then(|| domain.next_side());
        Self(match (function, side.flatten()) {
            (Binary::Quotient, Some(side)) => self.0.quotient_beside_zero(other.0, side, domain),
            (_, Some(side)) => self.0.angle_beside_cut(other.0, side, domain),
            _ => self.0.binary(function, other.0, domain),
        })
    }
    #[inline(always)]
    fn whole_power(self, n: i32, domain: &mut Domain<L>) -> Self {
        let Some(side) = (n < 0).then(|| domain.next_side()).flatten() else {
            return Self(Arithmetic::whole_power(self.0, n, domain));
        };
        let l = self.0.lanes;
        let zero = l.real(0.0);
        // The base on one side of 0, and its power's side.
        let upper = Interval::new(l, self.0.low.max(zero), self.0.high);
        let lower = Interval::new(l, self.0.low, self.0.high.min(zero));
        let empty = side & !self.0.high.gt(zero) | !side & !self.0.low.lt(zero);
        domain.note(l.mask(false), empty);
        let base = upper.or_where_not(side, lower);
        let power = base.whole_power(n.saturating_neg());
        let positive = if n % 2 == 0 { l.mask(true) } else { side };
        let one = Interval::splat(l, [1.0, 1.0]);
        Self(one.quotient_beside_zero(power, positive, domain))
    }
    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        let (s, c) = self.0.sine_cosine_thin();
        (Self(s), Self(c))
    }
}
