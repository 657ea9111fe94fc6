//! Lanes: the numbers of the inner loop.
//!
//! The loop is written once over [`Lanes`]: [`Single`] is f32 × 16, [`Double`] is f64 × 8, always
//! as many logical lanes whatever the machine, so that the bits of an image do not depend on the
//! instruction set. Every operation is IEEE-exact or fused on all of them; approximate
//! reciprocals are not offered.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use super::lookup::{self, SMALL};
use fearless_simd::prelude::*;
use fearless_simd::{
    Level, f32x16, f64x8, i32x16, mask32x16, mask64x8, u8x16, u8x64, u32x16, u64x8,
};

/// Most lanes of a packet.
pub const WIDEST: usize = 32;

/// The scalar stored in one lane, as arrays keep it.
pub trait Scalar:
    Copy
    + Default
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// Unit roundoff u of round-to-nearest: 2⁻²⁴ or 2⁻⁵³.
    const ROUNDOFF: f64;
    /// The nearest value of this type.
    fn from_f64(x: f64) -> Self;
    /// Exact widening.
    fn to_f64(self) -> f64;
    /// `self · a + b`, rounded once.
    fn fused(self, a: Self, b: Self) -> Self;
    /// Square root, correctly rounded.
    fn root(self) -> Self;
    /// The larger; the other operand where one is NaN.
    fn larger(self, other: Self) -> Self;
}

impl Scalar for f32 {
    const ROUNDOFF: f64 = 1.0 / 16_777_216.0;
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.into()
    }
    #[inline(always)]
    fn fused(self, a: Self, b: Self) -> Self {
        self.mul_add(a, b)
    }
    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

impl Scalar for f64 {
    const ROUNDOFF: f64 = 1.0 / 9_007_199_254_740_992.0;
    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn fused(self, a: Self, b: Self) -> Self {
        self.mul_add(a, b)
    }
    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

/// One truth value a lane.
pub trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> + 'static
{
    /// Number of lanes.
    const COUNT: u32;
    /// Whether any lane is true.
    fn any(self) -> bool;
    /// Lane `i` in bit `i`.
    fn bits(self) -> u32;
}

/// One real number a lane.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// Truth values of comparisons.
    type Mask: Mask;
    /// `self · a + b`, rounded once.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// `self < other ? self : other`: the smaller; `other` where they are equal or one is NaN.
    fn min(self, other: Self) -> Self;
    /// `self > other ? self : other`: the larger; `other` where they are equal or one is NaN.
    fn max(self, other: Self) -> Self;
    /// Largest integer not above.
    fn floor(self) -> Self;
    /// Nearest integer, ties to even.
    fn round(self) -> Self;
    /// The magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// `self < other`; false for NaN, as all comparisons.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self ≤ other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `self > other`.
    fn gt(self, other: Self) -> Self::Mask;
    /// `self ≥ other`.
    fn ge(self, other: Self) -> Self::Mask;
    /// `self = other`.
    fn same(self, other: Self) -> Self::Mask;
}

/// One unsigned 32-bit number a lane; arithmetic is modulo 2³².
pub trait Int:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> + 'static
{
    /// Truth values of comparisons.
    type Mask: Mask;
    /// Sum modulo 2³².
    fn plus(self, other: Self) -> Self;
    /// Difference modulo 2³².
    fn minus(self, other: Self) -> Self;
    /// Product modulo 2³².
    fn times(self, other: Self) -> Self;
    /// Shift left by a constant, dropping what leaves 32 bits.
    fn left(self, by: u32) -> Self;
    /// Shift right by a constant.
    fn right(self, by: u32) -> Self;
    /// The 32 bits in reverse order.
    fn reversed(self) -> Self;
    /// Equality.
    fn same(self, other: Self) -> Self::Mask;
    /// Unsigned `self < other`.
    fn below(self, other: Self) -> Self::Mask;
}

/// A width and precision of lanes on some instruction set, as a token that makes values.
pub trait Lanes: Copy + Send + Sync + 'static {
    /// Scalars in arrays.
    type Scalar: Scalar;
    /// Reals.
    type Real: Real<Mask = Self::Mask>;
    /// Unsigned integers.
    type Int: Int<Mask = Self::Mask>;
    /// As many lanes as one packet has, where these are several packets.
    type Narrow: Lanes<Scalar = Self::Scalar>;
    /// Truth values.
    type Mask: Mask;
    /// Number of lanes.
    const COUNT: usize;
    /// Bits of a uniform variate that the significand holds.
    const UNIFORM_BITS: u32;

    /// The token of one packet.
    fn narrow(self) -> Self::Narrow;
    /// Runs `f` compiled for this instruction set; wrapped in a function that is not inlined, the
    /// boundary of a stage.
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R;
    /// The same value, rounded to this precision, in every lane.
    fn real(self, x: f64) -> Self::Real;
    /// The same scalar in every lane.
    fn splat(self, x: Self::Scalar) -> Self::Real;
    /// The same integer in every lane.
    fn int(self, x: u32) -> Self::Int;
    /// The same truth value in every lane.
    fn mask(self, x: bool) -> Self::Mask;
    /// Lane `i` true where bit `i` is set.
    fn mask_from_bits(self, bits: u32) -> Self::Mask;
    /// The first `COUNT` scalars of a slice.
    fn load(self, from: &[Self::Scalar]) -> Self::Real;
    /// Stores into the first `COUNT` places of a slice.
    fn store(self, x: Self::Real, to: &mut [Self::Scalar]);
    /// The first `COUNT` integers of a slice.
    fn load_int(self, from: &[u32]) -> Self::Int;
    /// Stores into the first `COUNT` places of a slice.
    fn store_int(self, x: Self::Int, to: &mut [u32]);
    /// `table[index]` lane by lane; an index outside reads the last entry.
    fn gather(self, table: &[Self::Scalar], index: Self::Int) -> Self::Real;
    /// `table[index]` lane by lane, for indices below 16.
    fn lookup(self, table: &[Self::Scalar; SMALL], index: Self::Int) -> Self::Real;
    /// The same in a table of integers.
    fn lookup_int(self, table: &[u32; SMALL], index: Self::Int) -> Self::Int;
    /// One lane.
    fn lane(self, x: Self::Real, i: usize) -> Self::Scalar;
    /// One lane of an integer.
    fn int_lane(self, x: Self::Int, i: usize) -> u32;
    /// With one lane replaced.
    fn with_lane(self, x: Self::Real, i: usize, value: Self::Scalar) -> Self::Real;
    /// With one lane replaced.
    fn with_int_lane(self, x: Self::Int, i: usize, value: u32) -> Self::Int;
    /// Lane by lane `a` where the mask is true, else `b`.
    fn select(self, m: Self::Mask, a: Self::Real, b: Self::Real) -> Self::Real;
    /// Lane by lane `a` where the mask is true, else `b`.
    fn select_int(self, m: Self::Mask, a: Self::Int, b: Self::Int) -> Self::Int;
    /// Truncation of reals in [0, 2³¹).
    fn truncate(self, x: Self::Real) -> Self::Int;
    /// Exact conversion of integers below 2²⁴; larger ones are rounded.
    fn to_real(self, x: Self::Int) -> Self::Real;
    /// Splits positive normal x = m · 2ᵉ with m in [1, 2): (m, e).
    fn split_exponent(self, x: Self::Real) -> (Self::Real, Self::Real);
    /// 2ᵉ for whole e within the exponents of normal numbers.
    fn power_of_two(self, e: Self::Real) -> Self::Real;
    /// Stores the true lanes, in order, into the first of `COUNT` places; what the other places
    /// get is unspecified.
    fn compress_into(self, x: Self::Real, keep: Self::Mask, to: &mut [Self::Scalar]);
    /// The same of integers.
    fn compress_int_into(self, x: Self::Int, keep: Self::Mask, to: &mut [u32]);

    /// Uniform variate in [0, 1) from 32 random bits, rounded *down* so that 1 cannot occur.
    #[inline(always)]
    fn uniform(self, bits: Self::Int) -> Self::Real {
        let kept = bits.right(32 - Self::UNIFORM_BITS);
        self.to_real(kept) * self.real(1.0 / (1u64 << Self::UNIFORM_BITS) as f64)
    }
}

/// Gives a closure back. An attribute may stand on an argument but not on the right of `let`, and
/// a closure over lanes must be inlined to be compiled for the instruction set of its caller.
#[inline(always)]
pub fn inlined<F>(f: F) -> F {
    f
}

/// Single precision: f32 × 16.
#[derive(Clone, Copy)]
pub struct Single<S: Simd>(pub S);

/// Double precision: f64 × 8.
#[derive(Clone, Copy)]
pub struct Double<S: Simd>(pub S);

macro_rules! mask_impl {
    ($mask:ident, $count:literal) => {
        impl<S: Simd> Mask for $mask<S> {
            const COUNT: u32 = $count;
            #[inline(always)]
            fn any(self) -> bool {
                self.any_true()
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                self.to_bitmask() as u32
            }
        }
    };
}

mask_impl!(mask32x16, 16);
mask_impl!(mask64x8, 8);

/// Whether an instruction set has a fused multiply-add; known at compile time once inlined.
#[inline(always)]
fn fuses(level: Level) -> bool {
    #[cfg(target_arch = "x86_64")]
    return matches!(level, Level::Avx2(_) | Level::Avx512(_));
    #[cfg(not(target_arch = "x86_64"))]
    return !level.is_fallback();
}

/// Whether the instruction set's own minimum and maximum are `a < b ? a : b` and `a > b ? a : b`,
/// as `minps` and its kin are on x86.
#[inline(always)]
fn compares_once() -> bool {
    cfg!(target_arch = "x86_64")
}

/// The fused multiply-add in software: one copy, for it is long.
#[inline(never)]
fn fused_by_call_single<S: Simd>(x: f32x16<S>, a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
    x.mul_add_precise(a, b)
}

/// The fused multiply-add in software: one copy, for it is long.
#[inline(never)]
fn fused_by_call_double<S: Simd>(x: f64x8<S>, a: f64x8<S>, b: f64x8<S>) -> f64x8<S> {
    x.mul_add_precise(a, b)
}

macro_rules! real_impl {
    ($real:ident, $mask:ident, $fused_by_call:ident) => {
        impl<S: Simd> Real for $real<S> {
            type Mask = $mask<S>;
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                if fuses(self.token().level()) {
                    self.mul_add_precise(a, b)
                } else {
                    $fused_by_call(self, a, b)
                }
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if compares_once() {
                    SimdBase::min(self, other)
                } else {
                    self.simd_lt(other).select(self, other)
                }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if compares_once() {
                    SimdBase::max(self, other)
                } else {
                    self.simd_gt(other).select(self, other)
                }
            }
            #[inline(always)]
            fn floor(self) -> Self {
                SimdFloat::floor(self)
            }
            #[inline(always)]
            fn round(self) -> Self {
                self.round_ties_even()
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                SimdFloat::copysign(self, sign)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                self.simd_le(other)
            }
            #[inline(always)]
            fn gt(self, other: Self) -> Self::Mask {
                self.simd_gt(other)
            }
            #[inline(always)]
            fn ge(self, other: Self) -> Self::Mask {
                self.simd_ge(other)
            }
            #[inline(always)]
            fn same(self, other: Self) -> Self::Mask {
                self.simd_eq(other)
            }
        }
    };
}

real_impl!(f32x16, mask32x16, fused_by_call_single);
real_impl!(f64x8, mask64x8, fused_by_call_double);

/// Reverses the order of the bits in each byte, and of the bytes as `order` says in each 16.
#[inline(always)]
fn reversed_bytes<S: Simd>(simd: S, bytes: u8x64<S>, order: [u8; 16]) -> u8x64<S> {
    /// The four bits of the index reversed.
    const NIBBLES: [u8; 16] = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];
    let repeated = inlined(
        #[inline(always)]
        |block: [u8; 16]| u8x64::block_splat(u8x16::simd_from(simd, block)),
    );
    let table = repeated(NIBBLES);
    let low = u8x64::splat(simd, 0x0f);
    let bytes = bytes.swizzle_dyn_within_blocks(repeated(order));
    let high_nibbles = table.swizzle_dyn_within_blocks(bytes & low) << 4;
    let low_nibbles = table.swizzle_dyn_within_blocks((bytes >> 4) & low);
    high_nibbles | low_nibbles
}

impl<S: Simd> Int for u32x16<S> {
    type Mask = mask32x16<S>;
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self - other
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self * other
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
        const ORDER: [u8; 16] = [3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12];
        reversed_bytes(self.token(), self.bitcast(), ORDER).bitcast()
    }
    #[inline(always)]
    fn same(self, other: Self) -> Self::Mask {
        self.simd_eq(other)
    }
    #[inline(always)]
    fn below(self, other: Self) -> Self::Mask {
        self.simd_lt(other)
    }
}

/// The low 32 bits of each 64-bit lane.
#[inline(always)]
fn low32<S: Simd>(x: u64x8<S>) -> u64x8<S> {
    x & u64x8::splat(x.token(), 0xffff_ffff)
}

impl<S: Simd> Int for u64x8<S> {
    type Mask = mask64x8<S>;
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        low32(self + other)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        low32(self - other)
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        low32(self * other)
    }
    #[inline(always)]
    fn left(self, by: u32) -> Self {
        low32(self << by)
    }
    #[inline(always)]
    fn right(self, by: u32) -> Self {
        self >> by
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        const ORDER: [u8; 16] = [3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12];
        reversed_bytes(self.token(), self.bitcast(), ORDER).bitcast()
    }
    #[inline(always)]
    fn same(self, other: Self) -> Self::Mask {
        self.simd_eq(other)
    }
    #[inline(always)]
    fn below(self, other: Self) -> Self::Mask {
        self.simd_lt(other)
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

    #[inline(always)]
    fn narrow(self) -> Self {
        self
    }
    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        self.0.vectorize(f)
    }
    #[inline(always)]
    fn real(self, x: f64) -> Self::Real {
        f32x16::splat(self.0, x as f32)
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self::Real {
        f32x16::splat(self.0, x)
    }
    #[inline(always)]
    fn int(self, x: u32) -> Self::Int {
        u32x16::splat(self.0, x)
    }
    #[inline(always)]
    fn mask(self, x: bool) -> Self::Mask {
        mask32x16::splat(self.0, x)
    }
    #[inline(always)]
    fn mask_from_bits(self, bits: u32) -> Self::Mask {
        mask32x16::from_bitmask(self.0, bits.into())
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> Self::Real {
        f32x16::from_slice(self.0, &from[..16])
    }
    #[inline(always)]
    fn store(self, x: Self::Real, to: &mut [f32]) {
        x.store_slice(&mut to[..16]);
    }
    #[inline(always)]
    fn load_int(self, from: &[u32]) -> Self::Int {
        u32x16::from_slice(self.0, &from[..16])
    }
    #[inline(always)]
    fn store_int(self, x: Self::Int, to: &mut [u32]) {
        x.store_slice(&mut to[..16]);
    }
    #[inline(always)]
    fn gather(self, table: &[f32], index: Self::Int) -> Self::Real {
        let last = table.len() - 1;
        let index: [u32; 16] = index.into();
        let mut out = [0.0; 16];
        for (value, i) in out.iter_mut().zip(index) {
            *value = table[(i as usize).min(last)];
        }
        f32x16::simd_from(self.0, out)
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
    fn lane(self, x: Self::Real, i: usize) -> f32 {
        x[i & 15]
    }
    #[inline(always)]
    fn int_lane(self, x: Self::Int, i: usize) -> u32 {
        x[i & 15]
    }
    #[inline(always)]
    fn with_lane(self, mut x: Self::Real, i: usize, value: f32) -> Self::Real {
        x[i & 15] = value;
        x
    }
    #[inline(always)]
    fn with_int_lane(self, mut x: Self::Int, i: usize, value: u32) -> Self::Int {
        x[i & 15] = value;
        x
    }
    #[inline(always)]
    fn select(self, m: Self::Mask, a: Self::Real, b: Self::Real) -> Self::Real {
        m.select(a, b)
    }
    #[inline(always)]
    fn select_int(self, m: Self::Mask, a: Self::Int, b: Self::Int) -> Self::Int {
        m.select(a, b)
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
    #[inline(always)]
    fn compress_into(self, x: Self::Real, keep: Self::Mask, to: &mut [Self::Scalar]) {
        self.store(x.compress(keep), to);
    }
    #[inline(always)]
    fn compress_int_into(self, x: Self::Int, keep: Self::Mask, to: &mut [u32]) {
        self.store_int(x.compress(keep), to);
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

    #[inline(always)]
    fn narrow(self) -> Self {
        self
    }
    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        self.0.vectorize(f)
    }
    #[inline(always)]
    fn real(self, x: f64) -> Self::Real {
        f64x8::splat(self.0, x)
    }
    #[inline(always)]
    fn splat(self, x: f64) -> Self::Real {
        f64x8::splat(self.0, x)
    }
    #[inline(always)]
    fn int(self, x: u32) -> Self::Int {
        u64x8::splat(self.0, x.into())
    }
    #[inline(always)]
    fn mask(self, x: bool) -> Self::Mask {
        mask64x8::splat(self.0, x)
    }
    #[inline(always)]
    fn mask_from_bits(self, bits: u32) -> Self::Mask {
        mask64x8::from_bitmask(self.0, bits.into())
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> Self::Real {
        f64x8::from_slice(self.0, &from[..8])
    }
    #[inline(always)]
    fn store(self, x: Self::Real, to: &mut [f64]) {
        x.store_slice(&mut to[..8]);
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
    fn gather(self, table: &[f64], index: Self::Int) -> Self::Real {
        let last = table.len() - 1;
        let index: [u64; 8] = index.into();
        let mut out = [0.0; 8];
        for (value, i) in out.iter_mut().zip(index) {
            *value = table[(i as usize).min(last)];
        }
        f64x8::simd_from(self.0, out)
    }
    #[inline(always)]
    fn lookup(self, table: &[f64; SMALL], index: Self::Int) -> Self::Real {
        lookup::double(self.0, table, index)
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
    fn lane(self, x: Self::Real, i: usize) -> f64 {
        x[i & 7]
    }
    #[inline(always)]
    fn int_lane(self, x: Self::Int, i: usize) -> u32 {
        x[i & 7] as u32
    }
    #[inline(always)]
    fn with_lane(self, mut x: Self::Real, i: usize, value: f64) -> Self::Real {
        x[i & 7] = value;
        x
    }
    #[inline(always)]
    fn with_int_lane(self, mut x: Self::Int, i: usize, value: u32) -> Self::Int {
        x[i & 7] = value.into();
        x
    }
    #[inline(always)]
    fn select(self, m: Self::Mask, a: Self::Real, b: Self::Real) -> Self::Real {
        m.select(a, b)
    }
    #[inline(always)]
    fn select_int(self, m: Self::Mask, a: Self::Int, b: Self::Int) -> Self::Int {
        m.select(a, b)
    }
    #[inline(always)]
    fn truncate(self, x: Self::Real) -> Self::Int {
        // Adding 2⁵² puts the integer part into the low bits of the significand.
        let shifted = SimdFloat::floor(x) + self.real(4_503_599_627_370_496.0);
        let bits: u64x8<S> = shifted.bitcast();
        low32(bits)
    }
    #[inline(always)]
    fn to_real(self, x: Self::Int) -> Self::Real {
        let shifted = x | u64x8::splat(self.0, 0x4330_0000_0000_0000);
        let real: f64x8<S> = shifted.bitcast();
        real - self.real(4_503_599_627_370_496.0)
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
        let biased: u64x8<S> = (e + self.real(4_503_599_627_370_496.0 + 1023.0)).bitcast();
        (biased << 52).bitcast()
    }
    #[inline(always)]
    fn compress_into(self, x: Self::Real, keep: Self::Mask, to: &mut [Self::Scalar]) {
        self.store(x.compress(keep), to);
    }
    #[inline(always)]
    fn compress_int_into(self, x: Self::Int, keep: Self::Mask, to: &mut [u32]) {
        self.store_int(x.compress(keep), to);
    }
}
