//! Exact dyadic numbers, mantissa · 2^exponent with integers of any size: the last tier.

use std::cmp::Ordering;

use num_bigint::{BigInt, Sign};
use num_traits::float::FloatCore;

use super::number::Number;

/// An exact dyadic rational. Sums, differences, products and signs are exact.
#[derive(Debug, Clone)]
pub struct Exact {
    mantissa: BigInt,
    exponent: i64,
}

/// Relative precision, in bits, of quotients and roots: enough for a value that loses 900 bits to
/// cancellation afterwards, more than the ratio of any origin within 1e250 to any object's size.
pub const VALUE_BITS: u64 = 1024;

impl Exact {
    pub fn integer(mantissa: BigInt) -> Self {
        Self::new(mantissa, 0)
    }

    fn new(mantissa: BigInt, exponent: i64) -> Self {
        Self { mantissa, exponent }
    }

    /// m and e of the number m · 2ᵉ.
    pub fn parts(&self) -> (&BigInt, i64) {
        (&self.mantissa, self.exponent)
    }

    /// Shift the mantissa so that it has at least `bits` bits and the exponent is even.
    fn widened_to(&self, bits: u64) -> (BigInt, i64) {
        let mut shift = bits.saturating_sub(self.mantissa.bits());
        if (self.exponent - shift as i64) % 2 != 0 {
            shift += 1;
        }
        (&self.mantissa << shift, self.exponent - shift as i64)
    }

    /// Position of the leading bit, as for log₂|x|; `None` for zero.
    pub fn magnitude(&self) -> Option<i64> {
        (self.mantissa.sign() != Sign::NoSign)
            .then(|| self.exponent + self.mantissa.bits() as i64 - 1)
    }

    /// self · 2^exponent.
    pub fn shifted(&self, exponent: i64) -> Self {
        Self::new(self.mantissa.clone(), self.exponent + exponent)
    }

    /// Whether this is that number, which must be finite.
    pub(super) fn is(&self, x: f64) -> bool {
        self.minus(&Self::of(x)).mantissa.sign() == Sign::NoSign
    }
}

impl Number for Exact {
    /// Zero for a number that is not finite, which callers exclude.
    fn scaled(x: f64, exponent: i32) -> Self {
        debug_assert!(x.is_finite());
        let (mantissa, power, sign) = x.integer_decode();
        if mantissa == 0 || !x.is_finite() {
            return Self::integer(BigInt::ZERO);
        }
        let trailing = mantissa.trailing_zeros();
        Self::new(
            BigInt::from(mantissa >> trailing) * sign,
            i64::from(power) + i64::from(trailing) + i64::from(exponent),
        )
    }

    fn enclosing(x: &Exact) -> Self {
        x.clone()
    }

    fn plus(&self, other: &Self) -> Self {
        let (low, high) = if self.exponent <= other.exponent {
            (self, other)
        } else {
            (other, self)
        };
        if high.mantissa.sign() == Sign::NoSign {
            return low.clone();
        }
        if low.mantissa.sign() == Sign::NoSign {
            return high.clone();
        }
        let shift = (high.exponent - low.exponent) as u64;
        Self::new((&high.mantissa << shift) + &low.mantissa, low.exponent)
    }

    fn times(&self, other: &Self) -> Self {
        let exponent = self.exponent + other.exponent;
        Self::new(&self.mantissa * &other.mantissa, exponent)
    }

    fn negated(&self) -> Self {
        Self::new(-&self.mantissa, self.exponent)
    }

    fn sign(&self) -> Option<Ordering> {
        Some(self.mantissa.cmp(&BigInt::ZERO))
    }

    /// Truncated to [`VALUE_BITS`]; 0 where the divisor is 0.
    fn divided_by(&self, other: &Self) -> Self {
        if other.mantissa.sign() == Sign::NoSign {
            return other.clone();
        }
        let (dividend, exponent) = self.widened_to(VALUE_BITS + other.mantissa.bits());
        Self::new(dividend / &other.mantissa, exponent - other.exponent)
    }

    /// Truncated to [`VALUE_BITS`]; 0 for negative numbers.
    fn square_root(&self) -> Self {
        let (radicand, exponent) = self.widened_to(2 * VALUE_BITS);
        Self::new(radicand.max(BigInt::ZERO).sqrt(), exponent / 2)
    }

    /// Rounded to nearest (in the subnormal range within one unit).
    fn to_f64(&self) -> f64 {
        let excess = self.mantissa.bits().saturating_sub(64);
        let magnitude = self.mantissa.magnitude();
        // 64 leading bits with a sticky last bit round like the whole number does.
        let mut leading = (magnitude >> excess).iter_u64_digits().next().unwrap_or(0);
        if excess > 0 && magnitude.trailing_zeros().unwrap_or(0) < excess {
            leading |= 1;
        }
        let exponent = (self.exponent + excess as i64).clamp(-4000, 4000) as i32;
        let value = libm::ldexp(leading as f64, exponent);
        if self.mantissa.sign() == Sign::Minus {
            -value
        } else {
            value
        }
    }

    fn error(&self) -> f64 {
        0.0
    }
}
