//! Tapes in lanes: values and gradients of a field at a packet of points.

use num_rational::BigRational;

use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;
use crate::shape::implicit::differentiate::{Differentiable, Gradients, WithGradient};
use crate::shape::implicit::evaluate;
use crate::shape::implicit::tape::{Algebra, Binary, Tape, Unary};

/// A tape with its constants rounded once.
#[derive(Debug, Clone)]
pub struct LaneField<T> {
    tape: Tape,
    constants: Vec<T>,
}

/// Room for the results of a tape, so that they need not be allocated for each point.
pub struct Scratch<L: Lanes>(Vec<L::Real>);

impl<L: Lanes> Default for Scratch<L> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: Scalar> LaneField<T> {
    /// Rounds the constants of a tape.
    pub fn new(tape: &Tape) -> Self {
        let rounded = |c: &BigRational| T::from_f64(evaluate::nearest(c));
        let constants = tape.constants().iter().map(rounded).collect();
        let tape = tape.clone();
        Self { tape, constants }
    }

    /// The field at object points, negative inside; NaN where it is undefined.
    #[inline(always)]
    pub fn value<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        scratch: &mut Scratch<L>,
    ) -> L::Real {
        let value = self.tape.evaluate(&self.at(l, p), &mut scratch.0);
        value.unwrap_or_else(|| l.real(f64::NAN))
    }

    /// Its gradient; not finite where that is undefined.
    #[inline(always)]
    pub fn gradient<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> Vec3<L::Real> {
        let packet = self.at(l, p);
        let found = self.tape.evaluate(&Gradients(&packet), &mut Vec::new());
        let [x, y, z] = found.map_or([None; 3], |WithGradient { gradient, .. }| gradient);
        let zero = l.real(0.0);
        Vec3::new(x.unwrap_or(zero), y.unwrap_or(zero), z.unwrap_or(zero))
    }

    #[inline(always)]
    fn at<L: Lanes<Scalar = T>>(&self, lanes: L, point: Vec3<L::Real>) -> Packet<'_, L> {
        Packet {
            lanes,
            constants: &self.constants,
            point: [point.x, point.y, point.z],
        }
    }
}

/// Lane arithmetic at a packet of points.
struct Packet<'a, L: Lanes> {
    lanes: L,
    constants: &'a [L::Scalar],
    point: [L::Real; 3],
}

/// A function of one value, lane by lane in f64.
#[inline(never)]
fn by_lane<L: Lanes>(l: L, function: Unary, a: L::Real) -> L::Real {
    let mut result = a;
    for i in 0..L::COUNT {
        let value = evaluate::unary(function, l.lane(a, i).to_f64());
        result = l.with_lane(result, i, L::Scalar::from_f64(value));
    }
    result
}

/// A function of two values, lane by lane in f64.
#[inline(never)]
fn by_lane_of_two<L: Lanes>(l: L, function: Binary, a: L::Real, b: L::Real) -> L::Real {
    let mut result = a;
    for i in 0..L::COUNT {
        let value = evaluate::binary(function, l.lane(a, i).to_f64(), l.lane(b, i).to_f64());
        result = l.with_lane(result, i, L::Scalar::from_f64(value));
    }
    result
}

impl<L: Lanes> Algebra for Packet<'_, L> {
    type Value = L::Real;

    #[inline(always)]
    fn coordinate(&self, axis: usize) -> L::Real {
        self.point[axis]
    }

    #[inline(always)]
    fn constant(&self, index: usize, _: &BigRational) -> L::Real {
        self.lanes.splat(self.constants[index])
    }

    #[inline(always)]
    fn unary(&self, function: Unary, a: &L::Real) -> L::Real {
        match function {
            Unary::Negative => -*a,
            Unary::SquareRoot => a.sqrt(),
            Unary::Absolute => a.abs(),
            _ => by_lane(self.lanes, function, *a),
        }
    }

    #[inline(always)]
    fn binary(&self, function: Binary, a: &L::Real, b: &L::Real) -> L::Real {
        let (a, b) = (*a, *b);
        match function {
            Binary::Sum => a + b,
            Binary::Difference => a - b,
            Binary::Product => a * b,
            Binary::Quotient => a / b,
            Binary::Minimum => a.min(b),
            Binary::Maximum => a.max(b),
            Binary::ArcTangent2 | Binary::Power => by_lane_of_two(self.lanes, function, a, b),
        }
    }

    #[inline(always)]
    fn whole_power(&self, a: &L::Real, n: i32) -> L::Real {
        let one = self.lanes.real(1.0);
        let power = evaluate::repeated(*a, n.unsigned_abs(), one);
        if n < 0 { one / power } else { power }
    }
}

impl<L: Lanes> Differentiable for Packet<'_, L> {
    #[inline(always)]
    fn number(&self, x: f64) -> L::Real {
        self.lanes.real(x)
    }

    #[inline(always)]
    fn where_negative(&self, s: &L::Real, below: &L::Real, above: &L::Real) -> L::Real {
        self.lanes
            .select(s.lt(self.lanes.real(0.0)), *below, *above)
    }
}
