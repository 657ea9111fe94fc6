//! Automatic differentiation over intervals: a value and its derivative along a line.
//!
//! The derivative holds every slope that the function has in the interval, and between the
//! slopes on both sides where it has a kink (|x|, minimum, maximum): what the mean value theorem
//! needs of a Lipschitz function (Clarke 1983, *Optimization and Nonsmooth Analysis*, ch. 2.3).

use super::instructions::DoubleLanes;
use super::interval::{Domain, Interval};
use super::lanes::Real;

#[derive(Clone, Copy)]
pub struct Jet<L: DoubleLanes> {
    pub value: Interval<L>,
    pub slope: Interval<L>,
}

impl<L: DoubleLanes> Jet<L> {
    methods! {
        pub fn new(value: Interval<L>, slope: Interval<L>) -> Self = Self { value, slope };
        pub fn negated(self) -> Self = Self::new(-self.value, -self.slope);
        pub fn plus(self, other: Self) -> Self =
            Self::new(self.value + other.value, self.slope + other.slope);
        pub fn minus(self, other: Self) -> Self =
            Self::new(self.value - other.value, self.slope - other.slope);
        /// A function of this value whose derivative is `rate`.
        pub fn chained(self, value: Interval<L>, rate: Interval<L>) -> Self =
            Self::new(value, self.slope * rate);
    }

    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        let slope = self.slope * other.value + self.value * other.slope;
        Self::new(self.value * other.value, slope)
    }

    #[inline(always)]
    pub fn quotient(self, other: Self, domain: &mut Domain<L>) -> Self {
        let value = self.value.quotient_noted(other.value, domain);
        Self::new(value, (self.slope - value * other.slope) / other.value)
    }

    #[inline(always)]
    pub fn whole_power(self, n: i32, domain: &mut Domain<L>) -> Self {
        if n < 0 {
            domain.note(self.value.may_be_zero(), self.value.is_zero());
        }
        let rate = match n {
            0 => Interval::splat(self.value.lanes, [0.0, 0.0]),
            // One less than the smallest exponent is no i32.
            i32::MIN => Interval::whole(self.value.lanes),
            _ => self.value.whole_power(n - 1).times_number(f64::from(n)),
        };
        self.chained(self.value.whole_power(n), rate)
    }

    #[inline(always)]
    pub fn absolute(self) -> Self {
        let l = self.value.lanes;
        let zero = l.real(0.0);
        let magnitude = self.slope.magnitude();
        let kink = Interval::new(l, -magnitude, magnitude);
        let smooth = (-self.slope).or_where_not(self.value.high.lt(zero), self.slope);
        let slope = kink.or_where_not(self.value.may_be_zero(), smooth);
        Self::new(self.value.absolute(), slope)
    }

    #[inline(always)]
    pub fn smaller(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        let both = self.slope.hull(other.slope);
        let slope = self.slope.or_where_not(x.high.lt(y.low), both);
        let slope = other.slope.or_where_not(y.high.lt(x.low), slope);
        Self::new(x.smaller(y), slope)
    }

    #[inline(always)]
    pub fn larger(self, other: Self) -> Self {
        self.negated().smaller(other.negated()).negated()
    }

    /// Slope of the angle of the point (other, self): (x y′ − y x′)/(x² + y²).
    #[inline(always)]
    pub fn slope_of_angle(self, other: Self) -> Interval<L> {
        let turn = other.value * self.slope - self.value * other.slope;
        turn / (other.value.squared() + self.value.squared())
    }

    /// Slope of aᵇ from its value and ln a: aᵇ (b′ ln a + b a′/a).
    #[inline(always)]
    pub fn slope_of_power(
        self,
        exponent: Self,
        power: Interval<L>,
        logarithm: Interval<L>,
    ) -> Interval<L> {
        let rate = exponent.slope * logarithm + exponent.value * self.slope / self.value;
        power * rate
    }
}
