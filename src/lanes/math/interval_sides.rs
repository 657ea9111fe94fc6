//! Functions that jump, on one side of the jump: what lies beyond is left out, so that the
//! enclosures are those of a continuous function, if unbounded ones.
//!
//! Together the two sides hold every value that the function has where it is defined.

use super::instructions::DoubleLanes;
use super::interval::{Domain, Interval, up};
use super::lanes::Real;

impl<L: DoubleLanes> Interval<L> {
    /// x / y for the positive y where `side`, for the negative ones elsewhere; void where there
    /// are none.
    ///
    /// With y in [l, h], l ≥ 0: the quotient's extremes are x/l and x/h, by the sign of x; x/0 is
    /// infinite, and 0/0 is NaN, which becomes unbounded.
    #[inline(always)]
    pub fn quotient_beside_zero(self, other: Self, side: L::Mask, domain: &mut Domain<L>) -> Self {
        let l = self.lanes;
        let zero = l.real(0.0);
        let x = self.or_where_not(side, -self);
        let y = other.or_where_not(side, -other);
        let nearest = y.low.max(zero);
        domain.note(l.mask(false), !y.high.gt(zero));
        let low = x.low / l.select(x.low.ge(zero), y.high, nearest);
        let high = x.high / l.select(x.high.ge(zero), nearest, y.high);
        Self::outward(l, low, high)
    }

    /// tan x after the last pole (`side`: the values up to that at the upper end) or before the
    /// first one (those from the value at the lower end); the ordinary enclosure without a pole,
    /// and nothing known of intervals that may hold two.
    #[inline(always)]
    pub fn tangent_beside_pole(self, side: L::Mask) -> Self {
        let l = self.lanes;
        let mut pole = Domain::unbroken(l);
        let ordinary = self.tangent(&mut pole);
        // 3 is less than π.
        let single = up(l, self.high - self.low).lt(l.real(3.0));
        let unbounded = Self::whole(l);
        let mut ignored = Domain::unbroken(l);
        let first = Self::point(l, self.low).tangent(&mut ignored);
        let last = Self::point(l, self.high).tangent(&mut ignored);
        let after = Self::new(l, unbounded.low, last.high);
        let before = Self::new(l, first.low, unbounded.high);
        let beside = after.or_where_not(side, before);
        let beside = beside.or_where_not(single, unbounded);
        beside.or_where_not(pole.broken, ordinary)
    }

    /// Angle of the point (x, y) = (other, self) for y ≥ 0 where `side`, for y < 0 elsewhere; void
    /// where there is no such y. The lower half is the mirror image of the upper one.
    #[inline(always)]
    pub fn angle_beside_cut(self, other: Self, side: L::Mask, domain: &mut Domain<L>) -> Self {
        let l = self.lanes;
        let zero = l.real(0.0);
        let y = self.or_where_not(side, -self);
        domain.note(l.mask(false), y.high.lt(zero));
        let upper = Self::new(l, y.low.max(zero), y.high.max(zero));
        let mut ignored = Domain::unbroken(l);
        let angle = upper.arc_tangent_of_quotient(other, &mut ignored);
        let angle = Self::new(l, angle.low.max(zero), angle.high);
        angle.or_where_not(side, -angle)
    }
}
