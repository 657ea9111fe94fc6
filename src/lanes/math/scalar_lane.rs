//! One lane of f64 as lanes: what is written over [`Lanes`] runs for a single number too, with
//! the bits that each of eight lanes would have.

use super::lanes::{Int, Lanes, Mask, Real};
use super::lookup::SMALL;

/// One f64.
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

impl Real for f64 {
    type Mask = bool;
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        f64::mul_add(self, a, b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
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
    fn floor(self) -> Self {
        f64::floor(self)
    }
    #[inline(always)]
    fn round(self) -> Self {
        self.round_ties_even()
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        f64::copysign(self, sign)
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

impl Int for u32 {
    type Mask = bool;
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self.wrapping_mul(other)
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
    fn reversed(self) -> Self {
        self.reverse_bits()
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

impl Lanes for One {
    type Narrow = Self;
    type Scalar = f64;
    type Real = f64;
    type Int = u32;
    type Mask = bool;
    const COUNT: usize = 1;
    const UNIFORM_BITS: u32 = 32;

    #[inline(always)]
    fn narrow(self) -> Self {
        self
    }
    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }
    #[inline(always)]
    fn real(self, x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn splat(self, x: f64) -> f64 {
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
    fn load(self, from: &[f64]) -> f64 {
        from[0]
    }
    #[inline(always)]
    fn store(self, x: f64, to: &mut [f64]) {
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
    fn lookup(self, table: &[f64; SMALL], index: u32) -> f64 {
        table[index as usize % SMALL]
    }
    #[inline(always)]
    fn lookup_int(self, table: &[u32; SMALL], index: u32) -> u32 {
        table[index as usize % SMALL]
    }
    #[inline(always)]
    fn lane(self, x: f64, _: usize) -> f64 {
        x
    }
    #[inline(always)]
    fn int_lane(self, x: u32, _: usize) -> u32 {
        x
    }
    #[inline(always)]
    fn with_lane(self, _: f64, _: usize, value: f64) -> f64 {
        value
    }
    #[inline(always)]
    fn with_int_lane(self, _: u32, _: usize, value: u32) -> u32 {
        value
    }
    #[inline(always)]
    fn select(self, m: bool, a: f64, b: f64) -> f64 {
        if m { a } else { b }
    }
    #[inline(always)]
    fn select_int(self, m: bool, a: u32, b: u32) -> u32 {
        if m { a } else { b }
    }
    #[inline(always)]
    fn truncate(self, x: f64) -> u32 {
        // As eight lanes do it: numbers outside the stated range get the same bits.
        (x.floor() + 4_503_599_627_370_496.0).to_bits() as u32
    }
    #[inline(always)]
    fn to_real(self, x: u32) -> f64 {
        x.into()
    }
    #[inline(always)]
    fn split_exponent(self, x: f64) -> (f64, f64) {
        let bits = x.to_bits();
        let mantissa = (bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000;
        let exponent = f64::from((bits >> 52) as u32) - 1023.0;
        (f64::from_bits(mantissa), exponent)
    }
    #[inline(always)]
    fn power_of_two(self, e: f64) -> f64 {
        f64::from_bits((e + (4_503_599_627_370_496.0 + 1023.0)).to_bits() << 52)
    }
    #[inline(always)]
    fn compress_into(self, x: f64, _: bool, to: &mut [f64]) {
        to[0] = x;
    }
    #[inline(always)]
    fn compress_int_into(self, x: u32, _: bool, to: &mut [u32]) {
        to[0] = x;
    }
}
