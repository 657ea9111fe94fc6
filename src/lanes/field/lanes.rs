//! Tapes in lanes: values and gradients of a field at a packet of points.

use num_rational::BigRational;

use crate::field::differentiate::{Differentiable, Gradients, WithGradient};
use crate::field::evaluate;
use crate::field::tape::{Algebra, Binary, Tape, Unary};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;

/// A tape with its constants rounded once.
#[derive(Debug, Clone)]
pub struct LaneField<T> {
    tape: Tape,
    constants: Vec<T>,
}

/// Room for the results of a tape at `W` packets, so that they need not be allocated each time.
pub struct Scratch<L: Lanes, const W: usize>(Vec<[L::Real; W]>);

impl<L: Lanes, const W: usize> Default for Scratch<L, W> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: Scalar> LaneField<T> {
    pub fn new(tape: &Tape) -> Self {
        let rounded = |c: &BigRational| T::from_f64(evaluate::nearest(c));
        let constants = tape.constants().iter().map(rounded).collect();
        let tape = tape.clone();
        Self { tape, constants }
    }

    /// The field at object points, negative inside; NaN where it is undefined. Several packets
    /// at once share the work of reading the tape.
    #[inline(always)]
    pub fn values<L: Lanes<Scalar = T>, const W: usize>(
        &self,
        l: L,
        points: [Vec3<L::Real>; W],
        scratch: &mut Scratch<L, W>,
    ) -> [L::Real; W] {
        let values = self.tape.evaluate(&self.at(l, points), &mut scratch.0);
        values.unwrap_or_else(|| [l.real(f64::NAN); W])
    }

    /// Its value and its gradient; not finite where that is undefined.
    #[inline(always)]
    pub fn with_gradient<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
    ) -> (L::Real, Vec3<L::Real>) {
        let packet = self.at(l, [p]);
        let found = self.tape.evaluate(&Gradients(&packet), &mut Vec::new());
        let Some(WithGradient { value, gradient }) = found else {
            let nothing = l.real(f64::NAN);
            return (nothing, Vec3::new(nothing, nothing, nothing));
        };
        let [x, y, z] = gradient.map(|d| d.map_or(l.real(0.0), |[d]| d));
        (value[0], Vec3::new(x, y, z))
    }

    #[inline(always)]
    fn at<L: Lanes<Scalar = T>, const W: usize>(
        &self,
        lanes: L,
        points: [Vec3<L::Real>; W],
    ) -> Packets<'_, L, W> {
        let zero = lanes.real(0.0);
        Packets {
            lanes,
            constants: &self.constants,
            points: [
                each(zero, inlined!(|i: usize| points[i].x)),
                each(zero, inlined!(|i: usize| points[i].y)),
                each(zero, inlined!(|i: usize| points[i].z)),
            ],
        }
    }
}

struct Packets<'a, L: Lanes, const W: usize> {
    lanes: L,
    constants: &'a [L::Scalar],
    points: [[L::Real; W]; 3],
}

/// An array by index, made from `start`. The functions that the standard library has for this are
/// not sure to be inlined, and what calculates in lanes must be.
#[inline(always)]
pub fn each<R: Copy, const W: usize>(start: R, f: impl Fn(usize) -> R) -> [R; W] {
    let mut array = [start; W];
    for (i, value) in array.iter_mut().enumerate() {
        *value = f(i);
    }
    array
}

#[inline(never)]
fn by_lane<L: Lanes>(l: L, function: Unary, a: L::Real) -> L::Real {
    let mut result = a;
    for i in 0..L::COUNT {
        let value = evaluate::unary(function, l.lane(a, i).to_f64());
        result = l.with_lane(result, i, L::Scalar::from_f64(value));
    }
    result
}

#[inline(never)]
fn by_lane_of_two<L: Lanes>(l: L, function: Binary, a: L::Real, b: L::Real) -> L::Real {
    let mut result = a;
    for i in 0..L::COUNT {
        let value = evaluate::binary(function, l.lane(a, i).to_f64(), l.lane(b, i).to_f64());
        result = l.with_lane(result, i, L::Scalar::from_f64(value));
    }
    result
}

/// A function of two values; those of arithmetic in lanes.
#[inline(always)]
fn of_two<L: Lanes>(l: L, function: Binary, a: L::Real, b: L::Real) -> L::Real {
    match function {
        Binary::Sum => a + b,
        Binary::Difference => a - b,
        Binary::Product => a * b,
        Binary::Quotient => a / b,
        Binary::Minimum => a.min(b),
        Binary::Maximum => a.max(b),
        Binary::ArcTangent2 | Binary::Power => by_lane_of_two(l, function, a, b),
    }
}

impl<L: Lanes, const W: usize> Algebra for Packets<'_, L, W> {
    type Value = [L::Real; W];

    #[inline(always)]
    fn coordinate(&self, axis: usize) -> Self::Value {
        self.points[axis]
    }

    #[inline(always)]
    fn constant(&self, index: usize, _: &BigRational) -> Self::Value {
        [self.lanes.splat(self.constants[index]); W]
    }

    #[inline(always)]
    fn unary(&self, function: Unary, a: &Self::Value) -> Self::Value {
        let zero = self.lanes.real(0.0);
        match function {
            Unary::Negative => each(zero, inlined!(|i: usize| -a[i])),
            Unary::SquareRoot => each(zero, inlined!(|i: usize| a[i].sqrt())),
            Unary::Absolute => each(zero, inlined!(|i: usize| a[i].abs())),
            _ => each(
                zero,
                inlined!(|i: usize| by_lane(self.lanes, function, a[i])),
            ),
        }
    }

    #[inline(always)]
    fn binary(&self, function: Binary, a: &Self::Value, b: &Self::Value) -> Self::Value {
        // The function is told apart once, not for each packet.
        let zero = self.lanes.real(0.0);
        macro_rules! known {
            ($function:expr) => {
                each(
                    zero,
                    inlined!(|i: usize| of_two(self.lanes, $function, a[i], b[i])),
                )
            };
        }
        match function {
            Binary::Sum => known!(Binary::Sum),
            Binary::Difference => known!(Binary::Difference),
            Binary::Product => known!(Binary::Product),
            _ => known!(function),
        }
    }

    #[inline(always)]
    fn whole_power(&self, a: &Self::Value, n: i32) -> Self::Value {
        let (zero, one) = (self.lanes.real(0.0), self.lanes.real(1.0));
        if n == 2 {
            return each(zero, inlined!(|i: usize| a[i] * a[i]));
        }
        each(
            zero,
            inlined!(|i: usize| {
                let power = evaluate::repeated(a[i], n.unsigned_abs(), one);
                if n < 0 { one / power } else { power }
            }),
        )
    }
}

impl<L: Lanes, const W: usize> Differentiable for Packets<'_, L, W> {
    #[inline(always)]
    fn number(&self, x: f64) -> Self::Value {
        [self.lanes.real(x); W]
    }

    #[inline(always)]
    fn where_negative(
        &self,
        s: &Self::Value,
        below: &Self::Value,
        above: &Self::Value,
    ) -> Self::Value {
        let zero = self.lanes.real(0.0);
        each(
            zero,
            inlined!(|i: usize| self.lanes.select(s[i].lt(zero), below[i], above[i])),
        )
    }
}
