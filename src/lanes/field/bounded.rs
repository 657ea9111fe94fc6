//! Numbers that carry a bound of their own rounding error (Higham 2002, ch. 3.3: running error
//! analysis), to distinguish a gradient from the noise of its evaluation.

use std::ops::Mul;

use glam::DVec3;
use num_rational::BigRational;

use super::differentiate::{Differentiable, Gradients, WithGradient};
use super::evaluate::{self, Field, repeated};
use super::tape::{Algebra, Binary, Unary};

/// Unit roundoff 2⁻⁵³.
const U: f64 = f64::EPSILON / 2.0;

/// A value and a bound of its error, itself good to first order.
#[derive(Debug, Clone, Copy)]
struct Bounded {
    value: f64,
    error: f64,
}

impl Bounded {
    /// A result rounded once, whose operands put `inherited` into it.
    fn rounded(value: f64, inherited: f64) -> Self {
        Self {
            value,
            error: inherited + U * value.abs(),
        }
    }
}

impl Mul for Bounded {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let inherited =
            self.value.abs() * b.error + b.value.abs() * self.error + self.error * b.error;
        Self::rounded(self.value * b.value, inherited)
    }
}

/// The gradient of a field at a point and the length of its error, where each coordinate may be off
/// by `blur` and its own rounding.
pub fn gradient(field: &Field, point: DVec3, blur: f64) -> (DVec3, f64) {
    let numbers = Numbers {
        constants: &field.constants,
        point,
        blur,
    };
    let found = field.tape.evaluate(&Gradients(&numbers), &mut Vec::new());
    let Some(WithGradient { gradient, .. }) = found else {
        return (DVec3::NAN, f64::INFINITY);
    };
    let part = |read: fn(Bounded) -> f64| {
        DVec3::from_array(gradient.each_ref().map(|d| d.map_or(0.0, read)))
    };
    (part(|d| d.value), part(|d| d.error).length())
}

struct Numbers<'a> {
    constants: &'a [f64],
    point: DVec3,
    blur: f64,
}

impl Algebra for Numbers<'_> {
    type Value = Bounded;

    fn coordinate(&self, axis: usize) -> Bounded {
        Bounded::rounded(self.point[axis], self.blur)
    }

    fn constant(&self, index: usize, _: &BigRational) -> Bounded {
        Bounded::rounded(self.constants[index], 0.0)
    }

    fn unary(&self, function: Unary, a: &Bounded) -> Bounded {
        let (x, e) = (a.value, a.error);
        let value = evaluate::unary(function, x);
        let slope = match function {
            Unary::Negative | Unary::Absolute => return Bounded { value, error: e },
            // Near 0 the slope is infinite, but a root is never off by more than √e.
            Unary::SquareRoot if x <= e => return Bounded::rounded(value, (2.0 * e).sqrt()),
            Unary::SquareRoot => 0.5 / value,
            Unary::Exponential => value,
            Unary::Logarithm => 1.0 / x,
            Unary::Sine | Unary::Cosine => 1.0,
            Unary::Tangent => 1.0 + value * value,
            Unary::ArcSine | Unary::ArcCosine => 1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            Unary::ArcTangent => 1.0 / (1.0 + x * x),
            Unary::HyperbolicSine => libm::cosh(x),
            Unary::HyperbolicCosine => libm::sinh(x),
            Unary::HyperbolicTangent => 1.0,
        };
        // The functions of the libm crate are good to 1 ulp, twice a rounding.
        Bounded::rounded(value, slope.abs() * e + U * value.abs())
    }

    fn binary(&self, function: Binary, a: &Bounded, b: &Bounded) -> Bounded {
        let value = evaluate::binary(function, a.value, b.value);
        let inherited = match function {
            Binary::Sum | Binary::Difference => a.error + b.error,
            Binary::Product => return *a * *b,
            Binary::Quotient => (a.error + value.abs() * b.error) / (b.value.abs() - b.error),
            Binary::Minimum | Binary::Maximum => {
                let error = a.error.max(b.error);
                return Bounded { value, error };
            }
            Binary::ArcTangent2 => (a.error + b.error) / libm::hypot(a.value, b.value),
            Binary::Power => {
                let relative = b.value * a.error / a.value + libm::log(a.value) * b.error;
                (value * relative).abs() + U * value.abs()
            }
        };
        Bounded::rounded(value, inherited)
    }

    fn whole_power(&self, a: &Bounded, n: i32) -> Bounded {
        let one = self.number(1.0);
        let power = repeated(*a, n.unsigned_abs(), one);
        if n < 0 {
            self.binary(Binary::Quotient, &one, &power)
        } else {
            power
        }
    }
}

impl Differentiable for Numbers<'_> {
    fn number(&self, value: f64) -> Bounded {
        Bounded { value, error: 0.0 }
    }

    fn where_negative(&self, s: &Bounded, below: &Bounded, above: &Bounded) -> Bounded {
        let negative = s.value < 0.0;
        let (chosen, other) = if negative {
            (below, above)
        } else {
            (above, below)
        };
        let mut error = chosen.error;
        if s.value.abs() <= s.error {
            // It may be the other one.
            error = error.max((chosen.value - other.value).abs() + other.error);
        }
        Bounded { error, ..*chosen }
    }
}
