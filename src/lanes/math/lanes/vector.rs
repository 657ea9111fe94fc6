//! What vectors of both precisions have in common.

use fearless_simd::prelude::*;
use fearless_simd::{u8x16, u8x64};

/// Whether the instruction set's own minimum and maximum are `a < b ? a : b` and `a > b ? a : b`,
/// as `minps` and its kin are on x86.
#[inline(always)]
pub fn compares_once() -> bool {
    cfg!(target_arch = "x86_64")
}

macro_rules! mask {
    ($mask:ident, $count:literal) => {
        impl<S: Simd> Mask for $mask<S> {
            const COUNT: u32 = $count;
            methods! {
                fn any(self) -> bool = self.any_true();
                fn bits(self) -> u32 = self.to_bitmask() as u32;
            }
        }
    };
}

macro_rules! real {
    ($real:ident, $mask:ident) => {
        impl<S: Simd> Real for $real<S> {
            type Mask = $mask<S>;
            methods! {
                fn mul_add(self, a: Self, b: Self) -> Self = self.mul_add_precise(a, b);
                fn sqrt(self) -> Self = SimdFloat::sqrt(self);
                fn abs(self) -> Self = SimdBase::abs(self);
                fn floor(self) -> Self = SimdFloat::floor(self);
                fn round(self) -> Self = self.round_ties_even();
                fn copysign(self, sign: Self) -> Self = SimdFloat::copysign(self, sign);
                fn lt(self, other: Self) -> Self::Mask = self.simd_lt(other);
                fn le(self, other: Self) -> Self::Mask = self.simd_le(other);
                fn gt(self, other: Self) -> Self::Mask = self.simd_gt(other);
                fn ge(self, other: Self) -> Self::Mask = self.simd_ge(other);
                fn same(self, other: Self) -> Self::Mask = self.simd_eq(other);
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
        }
    };
}

/// The methods of [`super::Lanes`] that both precisions have in common.
macro_rules! lanes {
    ($real:ident, $mask:ident, $scalar:ty, $count:literal) => {
        methods! {
            fn instructions(self) -> Instructions = Instructions::of(self.0.level());
            fn narrow(self) -> Self = self;
            fn real(self, x: f64) -> Self::Real = $real::splat(self.0, x as $scalar);
            fn splat(self, x: $scalar) -> Self::Real = $real::splat(self.0, x);
            fn mask(self, x: bool) -> Self::Mask = $mask::splat(self.0, x);
            fn mask_from_bits(self, bits: u32) -> Self::Mask = $mask::from_bitmask(self.0, bits.into());
            fn load(self, from: &[$scalar]) -> Self::Real = $real::from_slice(self.0, &from[..$count]);
            fn store(self, x: Self::Real, to: &mut [$scalar]) -> () = x.store_slice(&mut to[..$count]);
            fn lane(self, x: Self::Real, i: usize) -> $scalar = x[i & ($count - 1)];
            fn select(self, m: Self::Mask, a: Self::Real, b: Self::Real) -> Self::Real = m.select(a, b);
            fn select_int(self, m: Self::Mask, a: Self::Int, b: Self::Int) -> Self::Int = m.select(a, b);
        }
        #[inline(always)]
        fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
            self.0.vectorize(f)
        }
        #[inline(always)]
        fn with_lane(self, mut x: Self::Real, i: usize, value: $scalar) -> Self::Real {
            x[i & ($count - 1)] = value;
            x
        }
        #[inline(always)]
        fn compress_into(self, x: Self::Real, keep: Self::Mask, to: &mut [$scalar]) {
            self.store(x.compress(keep), to);
        }
        #[inline(always)]
        fn compress_int_into(self, x: Self::Int, keep: Self::Mask, to: &mut [u32]) {
            self.store_int(x.compress(keep), to);
        }
    };
}

pub(super) use {lanes, mask, real};

/// Reverses the order of the bits in each byte and of the bytes in each group of four: of the low 32
/// bits of numbers of 32 or 64 bits.
#[inline(always)]
pub fn reversed_bytes<S: Simd>(simd: S, bytes: u8x64<S>) -> u8x64<S> {
    const ORDER: [u8; 16] = [3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12];
    /// The four bits of the index reversed.
    const NIBBLES: [u8; 16] = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];
    let repeated = inlined!(|block: [u8; 16]| u8x64::block_splat(u8x16::simd_from(simd, block)));
    let table = repeated(NIBBLES);
    let low = u8x64::splat(simd, 0x0f);
    let bytes = bytes.swizzle_dyn_within_blocks(repeated(ORDER));
    let high_nibbles = table.swizzle_dyn_within_blocks(bytes & low) << 4;
    let low_nibbles = table.swizzle_dyn_within_blocks((bytes >> 4) & low);
    high_nibbles | low_nibbles
}
