//! Lanes of f32, sixteen to a packet.

use fearless_simd::prelude::*;
use fearless_simd::{f32x16, i32x16, mask32x16, u32x16};

use super::vector::{compares_once, lanes, mask, real, reversed_bytes};
use super::{Int, Lanes, Mask, Real};
use crate::math::instructions::Instructions;
use crate::math::lookup::{self, SMALL};

/// Single precision: f32 × 16.
#[derive(Clone, Copy)]
pub struct Single<S: Simd>(pub S);

mask!(mask32x16, 16);
real!(f32x16, mask32x16);

impl<S: Simd> Int for u32x16<S> {
    type Mask = mask32x16<S>;
    methods! {
        fn plus(self, other: Self) -> Self = self + other;
        fn minus(self, other: Self) -> Self = self - other;
        fn times(self, other: Self) -> Self = self * other;
        fn left(self, by: u32) -> Self = self << by;
        fn right(self, by: u32) -> Self = self >> by;
        fn reversed(self) -> Self = reversed_bytes(self.token(), self.bitcast()).bitcast();
        fn same(self, other: Self) -> Self::Mask = self.simd_eq(other);
        fn below(self, other: Self) -> Self::Mask = self.simd_lt(other);
    }
}

impl<S: Simd> Lanes for Single<S> {
    type Scalar = f32;
    type Real = f32x16<S>;
    type Int = u32x16<S>;
    type Narrow = Self;
    type Mask = mask32x16<S>;
    const COUNT: usize = 16;
    const UNIFORM_BITS: u32 = 24;
    lanes!(f32x16, mask32x16, f32, 16);

    methods! {
        fn int(self, x: u32) -> Self::Int = u32x16::splat(self.0, x);
        fn load_int(self, from: &[u32]) -> Self::Int = u32x16::from_slice(self.0, &from[..16]);
        fn store_int(self, x: Self::Int, to: &mut [u32]) -> () = x.store_slice(&mut to[..16]);
        fn int_lane(self, x: Self::Int, i: usize) -> u32 = x[i & 15];
    }
    #[inline(always)]
    fn lookup(self, table: &[f32; SMALL], index: Self::Int) -> Self::Real {
        let table = f32x16::from_slice(self.0, table);
        lookup::single(self.0, table.bitcast(), index).bitcast()
    }
    #[inline(always)]
    fn lookup_int(self, table: &[u32; SMALL], index: Self::Int) -> Self::Int {
        lookup::single(self.0, u32x16::from_slice(self.0, table), index)
    }
    #[inline(always)]
    fn with_int_lane(self, mut x: Self::Int, i: usize, value: u32) -> Self::Int {
        x[i & 15] = value;
        x
    }
    #[inline(always)]
    fn truncate(self, x: Self::Real) -> Self::Int {
        let signed: i32x16<S> = x.to_int();
        signed.bitcast()
    }
    #[inline(always)]
    fn to_real(self, x: Self::Int) -> Self::Real {
        let signed: i32x16<S> = x.bitcast();
        signed.to_float()
    }
    #[inline(always)]
    fn split_exponent(self, x: Self::Real) -> (Self::Real, Self::Real) {
        let bits: u32x16<S> = x.bitcast();
        let mantissa = (bits & self.int(0x007f_ffff)) | self.int(0x3f80_0000);
        let exponent = self.to_real(bits.right(23)) - self.real(127.0);
        (mantissa.bitcast(), exponent)
    }
    #[inline(always)]
    fn power_of_two(self, e: Self::Real) -> Self::Real {
        (self.truncate(e + self.real(127.0)) << 23).bitcast()
    }
}
