//! Tapes in f64: the value and the gradient of a field at a point.

use std::ops::Mul;

use glam::DVec3;
use num_rational::BigRational;
use num_traits::ToPrimitive;

use super::differentiate::{Differentiable, Gradients};
use super::tape::{Algebra, Binary, Tape, Unary};

/// A tape with its constants rounded to f64 once.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    tape: Tape,
    constants: Vec<f64>,
}

impl Field {
    pub fn new(tape: &Tape) -> Self {
        let constants = tape.constants().iter().map(nearest).collect();
        let tape = tape.clone();
        Self { tape, constants }
    }

    pub fn tape(&self) -> &Tape {
        &self.tape
    }

    /// The constants by index, each the nearest f64.
    pub fn constants(&self) -> &[f64] {
        &self.constants
    }

    /// f(p); NaN where it is undefined.
    pub fn value(&self, p: DVec3) -> f64 {
        let value = self.tape.evaluate(&self.at(p), &mut Vec::new());
        value.unwrap_or(f64::NAN)
    }

    /// ∇f(p); not finite where it is undefined.
    pub fn gradient(&self, p: DVec3) -> DVec3 {
        let numbers = self.at(p);
        let found = self.tape.evaluate(&Gradients(&numbers), &mut Vec::new());
        found.map_or(DVec3::NAN, |found| {
            DVec3::from_array(found.gradient.map(|d| d.unwrap_or(0.0)))
        })
    }

    fn at(&self, point: DVec3) -> Numbers<'_> {
        Numbers {
            constants: &self.constants,
            point,
        }
    }
}

/// The nearest f64; infinite beyond the range.
pub fn nearest(exact: &BigRational) -> f64 {
    exact.to_f64().unwrap_or(f64::NAN)
}

struct Numbers<'a> {
    constants: &'a [f64],
    point: DVec3,
}

impl Algebra for Numbers<'_> {
    type Value = f64;

    fn coordinate(&self, axis: usize) -> f64 {
        self.point[axis]
    }

    fn constant(&self, index: usize, _: &BigRational) -> f64 {
        self.constants[index]
    }

    fn unary(&self, f: Unary, a: &f64) -> f64 {
        unary(f, *a)
    }

    fn binary(&self, function: Binary, a: &f64, b: &f64) -> f64 {
        binary(function, *a, *b)
    }

    fn whole_power(&self, a: &f64, n: i32) -> f64 {
        let power = repeated(*a, n.unsigned_abs(), 1.0);
        if n < 0 { 1.0 / power } else { power }
    }
}

impl Differentiable for Numbers<'_> {
    fn number(&self, x: f64) -> f64 {
        x
    }

    fn where_negative(&self, s: &f64, below: &f64, above: &f64) -> f64 {
        if *s < 0.0 { *below } else { *above }
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
        Binary::Minimum => {
            if a < b {
                a
            } else {
                b
            }
        }
        Binary::Maximum => {
            if a > b {
                a
            } else {
                b
            }
        }
        Binary::ArcTangent2 => libm::atan2(a, b),
        Binary::Power if a < 0.0 => f64::NAN,
        Binary::Power => libm::pow(a, b),
    }
}
