//! Lanes of f64, eight to a packet.

use fearless_simd::prelude::*;
use fearless_simd::{f64x8, mask64x8, u64x8};

use super::vector::{compares_once, lanes, mask, real, reversed_bytes};
use super::{Int, Lanes, Mask, Real};
use crate::math::instructions::Instructions;
use crate::math::lookup::{self, SMALL};
use crate::math::scalar_lane::SHIFT;

/// Double precision: f64 × 8.
#[derive(Clone, Copy)]
pub struct Double<S: Simd>(pub S);

mask!(mask64x8, 8);
real!(f64x8, mask64x8);

/// The low 32 bits of each 64-bit lane.
#[inline(always)]
fn low32<S: Simd>(x: u64x8<S>) -> u64x8<S> {
    x & u64x8::splat(x.token(), 0xffff_ffff)
}

impl<S: Simd> Int for u64x8<S> {
    type Mask = mask64x8<S>;
    methods! {
        fn plus(self, other: Self) -> Self = low32(self + other);
        fn minus(self, other: Self) -> Self = low32(self - other);
        fn times(self, other: Self) -> Self = low32(self * other);
        fn left(self, by: u32) -> Self = low32(self << by);
        fn right(self, by: u32) -> Self = self >> by;
        fn reversed(self) -> Self = reversed_bytes(self.token(), self.bitcast()).bitcast();
        fn same(self, other: Self) -> Self::Mask = self.simd_eq(other);
        fn below(self, other: Self) -> Self::Mask = self.simd_lt(other);
    }
}

impl<S: Simd> Lanes for Double<S> {
    type Scalar = f64;
    type Real = f64x8<S>;
    type Int = u64x8<S>;
    type Narrow = Self;
    type Mask = mask64x8<S>;
    const COUNT: usize = 8;
    const UNIFORM_BITS: u32 = 32;
    lanes!(f64x8, mask64x8, f64, 8);

    methods! {
        fn int(self, x: u32) -> Self::Int = u64x8::splat(self.0, x.into());
        fn int_lane(self, x: Self::Int, i: usize) -> u32 = x[i & 7] as u32;
        fn lookup(self, table: &[f64; SMALL], i: Self::Int) -> Self::Real = lookup::double(self.0, table, i);
    }
    #[inline(always)]
    fn load_int(self, from: &[u32]) -> Self::Int {
        let mut wide = [0u64; 8];
        for (w, &x) in wide.iter_mut().zip(&from[..8]) {
            *w = x.into();
        }
        u64x8::simd_from(self.0, wide)
    }
    #[inline(always)]
    fn store_int(self, x: Self::Int, to: &mut [u32]) {
        let wide: [u64; 8] = x.into();
        for (&w, y) in wide.iter().zip(&mut to[..8]) {
            *y = w as u32;
        }
    }
    #[inline(always)]
    fn lookup_int(self, table: &[u32; SMALL], index: Self::Int) -> Self::Int {
        let index: [u64; 8] = index.into();
        let mut out = [0; 8];
        for (out, i) in out.iter_mut().zip(index) {
            *out = table[i as usize % SMALL].into();
        }
        u64x8::simd_from(self.0, out)
    }
    #[inline(always)]
    fn with_int_lane(self, mut x: Self::Int, i: usize, value: u32) -> Self::Int {
        x[i & 7] = value.into();
        x
    }
    #[inline(always)]
    fn truncate(self, x: Self::Real) -> Self::Int {
        low32((SimdFloat::floor(x) + self.real(SHIFT)).bitcast())
    }
    #[inline(always)]
    fn to_real(self, x: Self::Int) -> Self::Real {
        // The bits of 2⁵² with the integer as its lowest digits.
        let shifted = x | u64x8::splat(self.0, SHIFT.to_bits());
        let real: f64x8<S> = shifted.bitcast();
        real - self.real(SHIFT)
    }
    #[inline(always)]
    fn split_exponent(self, x: Self::Real) -> (Self::Real, Self::Real) {
        let bits: u64x8<S> = x.bitcast();
        let mantissa = (bits & u64x8::splat(self.0, 0x000f_ffff_ffff_ffff))
            | u64x8::splat(self.0, 0x3ff0_0000_0000_0000);
        let exponent = self.to_real(bits.right(52)) - self.real(1023.0);
        (mantissa.bitcast(), exponent)
    }
    #[inline(always)]
    fn power_of_two(self, e: Self::Real) -> Self::Real {
        // The sum's low bits are the biased exponent; the shift leaves nothing else.
        let biased: u64x8<S> = (e + self.real(SHIFT + 1023.0)).bitcast();
        (biased << 52).bitcast()
    }
}
