//! One lane as lanes: what is written over [`Lanes`] runs for a single number too, with the bits
//! that each lane of a packet would have, in instructions that every machine has.

use super::instructions::Instructions;
use super::lanes::{Int, Lanes, Mask, Real, delegate};
use super::lookup::SMALL;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OneSingle;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct One;

impl Mask for bool {
    const COUNT: u32 = 1;
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.into()
    }
}

impl Int for u32 {
    type Mask = bool;
    delegate! {
        fn plus(self, other) -> Self = u32::wrapping_add;
        fn minus(self, other) -> Self = u32::wrapping_sub;
        fn times(self, other) -> Self = u32::wrapping_mul;
        fn reversed(self) -> Self = u32::reverse_bits;
    }
    #[inline(always)]
    fn left(self, by: u32) -> Self {
        self << by
    }
    #[inline(always)]
    fn right(self, by: u32) -> Self {
        self >> by
    }
    #[inline(always)]
    fn same(self, other: Self) -> bool {
        self == other
    }
    #[inline(always)]
    fn below(self, other: Self) -> bool {
        self < other
    }
}

macro_rules! one {
    ($one:ident, $scalar:ident, uniform: $uniform:literal) => {
        impl Real for $scalar {
            type Mask = bool;
            delegate! {
                fn mul_add(self, a, b) -> Self = $scalar::mul_add;
                fn sqrt(self) -> Self = $scalar::sqrt;
                fn abs(self) -> Self = $scalar::abs;
                fn floor(self) -> Self = $scalar::floor;
                fn round(self) -> Self = $scalar::round_ties_even;
                fn copysign(self, sign) -> Self = $scalar::copysign;
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn gt(self, other: Self) -> bool {
                self > other
            }
            #[inline(always)]
            fn ge(self, other: Self) -> bool {
                self >= other
            }
            #[inline(always)]
            fn same(self, other: Self) -> bool {
                self == other
            }
        }

        impl Lanes for $one {
            type Narrow = Self;
            type Scalar = $scalar;
            type Real = $scalar;
            type Int = u32;
            type Mask = bool;
            const COUNT: usize = 1;
            const UNIFORM_BITS: u32 = $uniform;

            #[inline(always)]
            fn instructions(self) -> Instructions {
                Instructions::Scalar
            }
            #[inline(always)]
            fn narrow(self) -> Self {
                self
            }
            #[inline(always)]
            fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
                f()
            }
            #[inline(always)]
            fn real(self, x: f64) -> $scalar {
                x as $scalar
            }
            #[inline(always)]
            fn splat(self, x: $scalar) -> $scalar {
                x
            }
            #[inline(always)]
            fn int(self, x: u32) -> u32 {
                x
            }
            #[inline(always)]
            fn mask(self, x: bool) -> bool {
                x
            }
            #[inline(always)]
            fn mask_from_bits(self, bits: u32) -> bool {
                bits & 1 == 1
            }
            #[inline(always)]
            fn load(self, from: &[$scalar]) -> $scalar {
                from[0]
            }
            #[inline(always)]
            fn store(self, x: $scalar, to: &mut [$scalar]) {
                to[0] = x;
            }
            #[inline(always)]
            fn load_int(self, from: &[u32]) -> u32 {
                from[0]
            }
            #[inline(always)]
            fn store_int(self, x: u32, to: &mut [u32]) {
                to[0] = x;
            }
            #[inline(always)]
            fn lookup(self, table: &[$scalar; SMALL], index: u32) -> $scalar {
                table[index as usize % SMALL]
            }
            #[inline(always)]
            fn lookup_int(self, table: &[u32; SMALL], index: u32) -> u32 {
                table[index as usize % SMALL]
            }
            #[inline(always)]
            fn lane(self, x: $scalar, _: usize) -> $scalar {
                x
            }
            #[inline(always)]
            fn int_lane(self, x: u32, _: usize) -> u32 {
                x
            }
            #[inline(always)]
            fn with_lane(self, _: $scalar, _: usize, value: $scalar) -> $scalar {
                value
            }
            #[inline(always)]
            fn with_int_lane(self, _: u32, _: usize, value: u32) -> u32 {
                value
            }
            #[inline(always)]
            fn select(self, m: bool, a: $scalar, b: $scalar) -> $scalar {
                if m { a } else { b }
            }
            #[inline(always)]
            fn select_int(self, m: bool, a: u32, b: u32) -> u32 {
                if m { a } else { b }
            }
            #[inline(always)]
            fn truncate(self, x: $scalar) -> u32 {
                $scalar::truncated(x)
            }
            #[inline(always)]
            fn to_real(self, x: u32) -> $scalar {
                $scalar::of_word(x)
            }
            #[inline(always)]
            fn split_exponent(self, x: $scalar) -> ($scalar, $scalar) {
                // The digits below the leading one, and the exponent of 1.
                const DIGITS: u32 = $scalar::MANTISSA_DIGITS - 1;
                let one = $scalar::to_bits(1.0);
                let bits = x.to_bits();
                let mantissa = bits & ((1 << DIGITS) - 1) | one;
                let exponent = (bits >> DIGITS) as $scalar - (one >> DIGITS) as $scalar;
                ($scalar::from_bits(mantissa), exponent)
            }
            #[inline(always)]
            fn power_of_two(self, e: $scalar) -> $scalar {
                $scalar::power_of_two(e)
            }
            #[inline(always)]
            fn compress_into(self, x: $scalar, _: bool, to: &mut [$scalar]) {
                to[0] = x;
            }
            #[inline(always)]
            fn compress_int_into(self, x: u32, _: bool, to: &mut [u32]) {
                to[0] = x;
            }
        }
    };
}

/// Conversions that the two precisions do in ways of their own; of f64, numbers outside the ranges
/// that [`Lanes`] states get the bits that packets give them.
trait Converted {
    fn truncated(self) -> u32;
    fn of_word(x: u32) -> Self;
    fn power_of_two(e: Self) -> Self;
}

impl Converted for f32 {
    #[inline(always)]
    fn truncated(self) -> u32 {
        self as i32 as u32
    }
    #[inline(always)]
    fn of_word(x: u32) -> f32 {
        x as i32 as f32
    }
    #[inline(always)]
    fn power_of_two(e: f32) -> f32 {
        f32::from_bits((e + 127.0).truncated() << 23)
    }
}

/// 2⁵²: added to a smaller number, it puts its integer part into the low bits of the significand.
const SHIFT: f64 = 4_503_599_627_370_496.0;

impl Converted for f64 {
    #[inline(always)]
    fn truncated(self) -> u32 {
        (self.floor() + SHIFT).to_bits() as u32
    }
    #[inline(always)]
    fn of_word(x: u32) -> f64 {
        x.into()
    }
    #[inline(always)]
    fn power_of_two(e: f64) -> f64 {
        f64::from_bits((e + (SHIFT + 1023.0)).to_bits() << 52)
    }
}

one!(OneSingle, f32, uniform: 24);
one!(One, f64, uniform: 32);
