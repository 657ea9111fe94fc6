//! Functions of constants whose values are rational.

use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use super::MOST_BITS;
use super::error::Problem;
use crate::field::structure::square_root;
use crate::field::tape::Unary;

pub(super) fn whole_power(c: &BigRational, n: i32) -> Result<BigRational, Problem> {
    if c.is_zero() {
        return match n {
            0 => Ok(BigRational::one()),
            1.. => Ok(BigRational::zero()),
            _ => Err(Problem::Undefined("a division by zero")),
        };
    }
    // |c|ⁿ has at least (bits − 1) · n bits; ±1 have one bit whatever n.
    let bits = c.numer().bits().max(c.denom().bits()) - 1;
    if bits.saturating_mul(n.unsigned_abs().into()) > MOST_BITS {
        return Err(Problem::TooManyDigits);
    }
    if bits == 0 {
        return Ok(if n % 2 == 0 { c * c } else { c.clone() });
    }
    Ok(c.pow(n))
}

/// f(c) where that is known to be rational; `None` leaves the function on the tape.
pub(super) fn unary(function: Unary, c: &BigRational) -> Result<Option<BigRational>, Problem> {
    let undefined = |what| Err(Problem::Undefined(what));
    let zero = || Some(BigRational::zero());
    Ok(match function {
        Unary::Negative => Some(-c),
        Unary::Absolute => Some(c.abs()),
        Unary::SquareRoot if c.is_negative() => {
            return undefined("the square root of a negative number");
        }
        Unary::SquareRoot => square_root(c),
        Unary::Logarithm if !c.is_positive() => {
            return undefined("the logarithm of a number that is not positive");
        }
        Unary::Logarithm if c.is_one() => zero(),
        Unary::ArcSine | Unary::ArcCosine if c.abs() > BigRational::one() => {
            return undefined("the arc of a sine or cosine beyond ±1");
        }
        Unary::ArcCosine if c.is_one() => zero(),
        Unary::Exponential | Unary::Cosine | Unary::HyperbolicCosine if c.is_zero() => {
            Some(BigRational::one())
        }
        Unary::Sine
        | Unary::Tangent
        | Unary::ArcSine
        | Unary::ArcTangent
        | Unary::HyperbolicSine
        | Unary::HyperbolicTangent
            if c.is_zero() =>
        {
            zero()
        }
        _ => None,
    })
}
