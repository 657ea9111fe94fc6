//! Tapes in lanes of either precision, of which f64 at a point is one: values and gradients.

use std::ops::Mul;

use glam::DVec3;
use num_rational::BigRational;
use num_traits::ToPrimitive;

use super::differentiate::{Differentiable, Gradients, WithGradient};
use super::tape::{Algebra, Binary, Tape, Unary};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::scalar_lane::One;
use crate::math::vec3::Vec3;

/// A tape with its constants rounded once.
#[derive(Debug, Clone, PartialEq)]
pub struct Field<T = f64> {
    pub tape: Tape,
    /// By index on the tape, each the nearest of its type.
    pub(super) constants: Vec<T>,
}

impl<T: Scalar> Field<T> {
    pub fn new(tape: &Tape) -> Self {
        let rounded = |c: &BigRational| T::from_f64(nearest(c));
        let constants = tape.constants().iter().map(rounded).collect();
        let tape = tape.clone();
        Self { tape, constants }
    }

    /// The field at object points, negative inside; NaN where it is undefined. Several packets
    /// at once share the work of reading the tape; `scratch` has room for its results.
    #[inline(always)]
    pub fn values<L: Lanes<Scalar = T>, const W: usize>(
        &self,
        l: L,
        points: [Vec3<L::Real>; W],
        scratch: &mut Vec<[L::Real; W]>,
    ) -> [L::Real; W] {
        let values = self.tape.evaluate(&self.at(l, points), scratch);
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

impl Field {
    /// f(p); NaN where it is undefined.
    pub fn value(&self, p: DVec3) -> f64 {
        let [value] = self.values(One, [Vec3::splat(One, p)], &mut Vec::new());
        value
    }

    /// ∇f(p); not finite where it is undefined.
    pub fn gradient(&self, p: DVec3) -> DVec3 {
        let (_, Vec3 { x, y, z }) = self.with_gradient(One, Vec3::splat(One, p));
        DVec3::new(x, y, z)
    }
}

/// The nearest f64; infinite beyond the range.
pub fn nearest(exact: &BigRational) -> f64 {
    exact.to_f64().unwrap_or(f64::NAN)
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

/// A function of a lane's number and its value in f64, one lane after the other.
#[inline(never)]
fn by_lane<L: Lanes>(l: L, a: L::Real, f: impl Fn(usize, f64) -> f64) -> L::Real {
    let mut result = a;
    for i in 0..L::COUNT {
        let value = f(i, l.lane(a, i).to_f64());
        result = l.with_lane(result, i, L::Scalar::from_f64(value));
    }
    result
}

impl<L: Lanes, const W: usize> Packets<'_, L, W> {
    #[inline(always)]
    fn each(&self, f: impl Fn(usize) -> L::Real) -> [L::Real; W] {
        each(self.lanes.real(0.0), f)
    }
}

impl<L: Lanes, const W: usize> Algebra for Packets<'_, L, W> {
    type Value = [L::Real; W];
    methods! {
        fn coordinate(&self, axis: usize) -> Self::Value = self.points[axis];
        fn constant(&self, index: usize, _: &BigRational) -> Self::Value =
            [self.lanes.splat(self.constants[index]); W];
    }

    #[inline(always)]
    fn unary(&self, function: Unary, a: &Self::Value) -> Self::Value {
        match function {
            Unary::Negative => self.each(inlined!(|i: usize| -a[i])),
            Unary::SquareRoot => self.each(inlined!(|i: usize| a[i].sqrt())),
            Unary::Absolute => self.each(inlined!(|i: usize| a[i].abs())),
            _ => {
                let of = |_, x| unary(function, x);
                self.each(inlined!(|i: usize| by_lane(self.lanes, a[i], of)))
            }
        }
    }

    #[inline(always)]
    fn binary(&self, function: Binary, a: &Self::Value, b: &Self::Value) -> Self::Value {
        // Chosen once, not for each packet.
        macro_rules! each {
            (|$x:ident, $y:ident| $value:expr) => {
                self.each(inlined!(|i: usize| {
                    let ($x, $y) = (a[i], b[i]);
                    $value
                }))
            };
        }
        let l = self.lanes;
        match function {
            Binary::Sum => each!(|x, y| x + y),
            Binary::Difference => each!(|x, y| x - y),
            Binary::Product => each!(|x, y| x * y),
            Binary::Quotient => each!(|x, y| x / y),
            Binary::Minimum => each!(|x, y| x.min(y)),
            Binary::Maximum => each!(|x, y| x.max(y)),
            Binary::ArcTangent2 | Binary::Power => {
                each!(|x, y| by_lane(l, x, |i, x| { binary(function, x, l.lane(y, i).to_f64()) }))
            }
        }
    }

    #[inline(always)]
    fn whole_power(&self, a: &Self::Value, n: i32) -> Self::Value {
        if n == 2 {
            return self.each(inlined!(|i: usize| a[i] * a[i]));
        }
        let one = self.lanes.real(1.0);
        self.each(inlined!(|i: usize| {
            let power = repeated(a[i], n.unsigned_abs(), one);
            if n < 0 { one / power } else { power }
        }))
    }
}

impl<L: Lanes, const W: usize> Differentiable for Packets<'_, L, W> {
    methods! { fn number(&self, x: f64) -> Self::Value = [self.lanes.real(x); W]; }

    #[inline(always)]
    fn where_negative(
        &self,
        s: &Self::Value,
        below: &Self::Value,
        above: &Self::Value,
    ) -> Self::Value {
        let (l, zero) = (self.lanes, self.lanes.real(0.0));
        self.each(inlined!(|i: usize| l.select(
            s[i].lt(zero),
            below[i],
            above[i]
        )))
    }
}

/// aⁿ by squaring and multiplying, from the highest bit of n down: always the same products.
#[inline(always)]
pub fn repeated<V: Copy + Mul<Output = V>>(a: V, n: u32, one: V) -> V {
    if n == 0 {
        return one;
    }
    let mut power = a;
    for bit in (0..n.ilog2()).rev() {
        power = power * power;
        if n >> bit & 1 == 1 {
            power = power * a;
        }
    }
    power
}

/// f(a) in f64, the same bits on every machine.
pub fn unary(function: Unary, a: f64) -> f64 {
    match function {
        Unary::Negative => -a,
        Unary::SquareRoot => a.sqrt(),
        Unary::Absolute => a.abs(),
        Unary::Exponential => libm::exp(a),
        Unary::Logarithm => libm::log(a),
        Unary::Sine => libm::sin(a),
        Unary::Cosine => libm::cos(a),
        Unary::Tangent => libm::tan(a),
        Unary::ArcSine => libm::asin(a),
        Unary::ArcCosine => libm::acos(a),
        Unary::ArcTangent => libm::atan(a),
        Unary::HyperbolicSine => libm::sinh(a),
        Unary::HyperbolicCosine => libm::cosh(a),
        Unary::HyperbolicTangent => libm::tanh(a),
    }
}

/// f(a, b) in f64, the same bits on every machine; the second where a minimum or maximum is not
/// decided.
pub fn binary(function: Binary, a: f64, b: f64) -> f64 {
    match function {
        Binary::Sum => a + b,
        Binary::Difference => a - b,
        Binary::Product => a * b,
        Binary::Quotient => a / b,
        Binary::Minimum => Real::min(a, b),
        Binary::Maximum => Real::max(a, b),
        Binary::ArcTangent2 => libm::atan2(a, b),
        Binary::Power if a < 0.0 => f64::NAN,
        Binary::Power => libm::pow(a, b),
    }
}
