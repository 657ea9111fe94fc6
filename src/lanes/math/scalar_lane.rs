//! One lane as lanes: what is written over [`Lanes`] runs for a single number too, with the bits
//! that each lane of a packet would have, in instructions that every machine has.

use super::instructions::Instructions;
use super::lanes::{Int, Lanes, Mask, Real};
use super::lookup::SMALL;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OneSingle;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct One;

impl Mask for bool {
    const COUNT: u32 = 1;
    methods! {
        fn any(self) -> bool = self;
        fn bits(self) -> u32 = self.into();
    }
}

impl Int for u32 {
    type Mask = bool;
    methods! {
        fn plus(self, other: Self) -> Self = self.wrapping_add(other);
        fn minus(self, other: Self) -> Self = self.wrapping_sub(other);
        fn times(self, other: Self) -> Self = self.wrapping_mul(other);
        fn reversed(self) -> Self = self.reverse_bits();
        fn left(self, by: u32) -> Self = self << by;
        fn right(self, by: u32) -> Self = self >> by;
        fn same(self, other: Self) -> bool = self == other;
        fn below(self, other: Self) -> bool = self < other;
    }
}

macro_rules! one {
    ($one:ident, $scalar:ident, uniform: $uniform:literal) => {
        impl Real for $scalar {
            type Mask = bool;
            methods! {
                fn mul_add(self, a: Self, b: Self) -> Self = $scalar::mul_add(self, a, b);
                fn sqrt(self) -> Self = $scalar::sqrt(self);
                fn abs(self) -> Self = $scalar::abs(self);
                fn floor(self) -> Self = $scalar::floor(self);
                fn round(self) -> Self = $scalar::round_ties_even(self);
                fn copysign(self, sign: Self) -> Self = $scalar::copysign(self, sign);
                fn min(self, other: Self) -> Self = if self < other { self } else { other };
                fn max(self, other: Self) -> Self = if self > other { self } else { other };
                fn lt(self, other: Self) -> bool = self < other;
                fn le(self, other: Self) -> bool = self <= other;
                fn gt(self, other: Self) -> bool = self > other;
                fn ge(self, other: Self) -> bool = self >= other;
                fn same(self, other: Self) -> bool = self == other;
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
            methods! {
                fn instructions(self) -> Instructions = Instructions::Scalar;
                fn narrow(self) -> Self = self;
                fn real(self, x: f64) -> $scalar = x as $scalar;
                fn splat(self, x: $scalar) -> $scalar = x;
                fn int(self, x: u32) -> u32 = x;
                fn mask(self, x: bool) -> bool = x;
                fn mask_from_bits(self, bits: u32) -> bool = bits & 1 == 1;
                fn load(self, from: &[$scalar]) -> $scalar = from[0];
                fn store(self, x: $scalar, to: &mut [$scalar]) -> () = to[0] = x;
                fn load_int(self, from: &[u32]) -> u32 = from[0];
                fn store_int(self, x: u32, to: &mut [u32]) -> () = to[0] = x;
                fn lookup(self, table: &[$scalar; SMALL], i: u32) -> $scalar = table[i as usize % SMALL];
                fn lookup_int(self, table: &[u32; SMALL], i: u32) -> u32 = table[i as usize % SMALL];
                fn lane(self, x: $scalar, _: usize) -> $scalar = x;
                fn int_lane(self, x: u32, _: usize) -> u32 = x;
                fn with_lane(self, _: $scalar, _: usize, value: $scalar) -> $scalar = value;
                fn with_int_lane(self, _: u32, _: usize, value: u32) -> u32 = value;
                fn select(self, m: bool, a: $scalar, b: $scalar) -> $scalar = if m { a } else { b };
                fn select_int(self, m: bool, a: u32, b: u32) -> u32 = if m { a } else { b };
                fn truncate(self, x: $scalar) -> u32 = $scalar::truncated(x);
                fn to_real(self, x: u32) -> $scalar = $scalar::of_word(x);
                fn power_of_two(self, e: $scalar) -> $scalar = $scalar::power_of_two(e);
                fn compress_into(self, x: $scalar, _: bool, to: &mut [$scalar]) -> () = to[0] = x;
                fn compress_int_into(self, x: u32, _: bool, to: &mut [u32]) -> () = to[0] = x;
            }
            #[inline(always)]
            fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
                f()
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
        }
    };
}

/// Conversions that differ between the precisions. Arguments outside the ranges that [`Lanes`] states
/// give the same bits in f64 as in a packet.
trait Converted {
    fn truncated(self) -> u32;
    fn of_word(x: u32) -> Self;
    fn power_of_two(e: Self) -> Self;
}

impl Converted for f32 {
    methods! {
        fn truncated(self) -> u32 = self as i32 as u32;
        fn of_word(x: u32) -> f32 = x as i32 as f32;
        fn power_of_two(e: f32) -> f32 = f32::from_bits((e + 127.0).truncated() << 23);
    }
}

/// 2⁵²: added to a smaller number, it puts its integer part into the low bits of the significand.
pub(super) const SHIFT: f64 = 4_503_599_627_370_496.0;

impl Converted for f64 {
    methods! {
        fn truncated(self) -> u32 = (self.floor() + SHIFT).to_bits() as u32;
        fn of_word(x: u32) -> f64 = x.into();
        fn power_of_two(e: f64) -> f64 = f64::from_bits((e + (SHIFT + 1023.0)).to_bits() << 52);
    }
}

one!(OneSingle, f32, uniform: 24);
one!(One, f64, uniform: 32);
