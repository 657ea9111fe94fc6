//! Lanes: the numbers of the inner loop.
//!
//! The loop is written once over [`Lanes`]: [`Single`] is f32 × 16, [`Double`] is f64 × 8, and
//! machines without such vectors take one lane after the other ([`One`]). No lane sees its
//! neighbours and every operation is IEEE-exact or fused in all of them, so that the bits of an
//! image do not depend on the instruction set; approximate reciprocals are not offered.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use fearless_simd::Simd;

use super::instructions::Instructions;
use super::lookup::SMALL;
use super::scalar_lane::{One, OneSingle};

mod double;
mod single;
mod vector;

pub use double::Double;
pub use single::Single;

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
    type Packet<S: Simd>: Lanes<Scalar = Self>;
    /// One of it as lanes.
    type One: Lanes<Scalar = Self>;
    const ONE: Self::One;
    fn packet<S: Simd>(simd: S) -> Self::Packet<S>;
    fn from_f64(x: f64) -> Self;
    fn to_f64(self) -> f64;
    /// `self · a + b`, rounded once.
    fn fused(self, a: Self, b: Self) -> Self;
    fn root(self) -> Self;
    /// The larger; the other operand where one is NaN.
    fn larger(self, other: Self) -> Self;
}

macro_rules! scalar {
    ($scalar:ident, $roundoff:expr, $packet:ident, $one:ident) => {
        impl Scalar for $scalar {
            const ROUNDOFF: f64 = $roundoff;
            type Packet<S: Simd> = $packet<S>;
            type One = $one;
            const ONE: $one = $one;
            methods! {
                fn from_f64(x: f64) -> Self = x as $scalar;
                fn to_f64(self) -> f64 = self.into();
                fn fused(self, a: Self, b: Self) -> Self = $scalar::mul_add(self, a, b);
                fn root(self) -> Self = $scalar::sqrt(self);
                fn larger(self, other: Self) -> Self = if self > other { self } else { other };
            }
            #[inline(always)]
            fn packet<S: Simd>(simd: S) -> $packet<S> {
                $packet(simd)
            }
        }
    };
}

scalar!(f32, 1.0 / 16_777_216.0, Single, OneSingle);
scalar!(f64, 1.0 / 9_007_199_254_740_992.0, Double, One);

/// One truth value a lane.
pub trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> + 'static
{
    const COUNT: u32;
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
    type Mask: Mask;
    /// `self · a + b`, rounded once.
    fn mul_add(self, a: Self, b: Self) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    /// `self < other ? self : other`: the smaller; `other` where they are equal or one is NaN.
    fn min(self, other: Self) -> Self;
    /// `self > other ? self : other`: the larger; `other` where they are equal or one is NaN.
    fn max(self, other: Self) -> Self;
    fn floor(self) -> Self;
    /// Nearest integer, ties to even.
    fn round(self) -> Self;
    /// The magnitude of `self` with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// `self < other`; false for NaN, as all comparisons.
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    fn gt(self, other: Self) -> Self::Mask;
    fn ge(self, other: Self) -> Self::Mask;
    fn same(self, other: Self) -> Self::Mask;
}

/// One unsigned 32-bit number a lane; arithmetic is modulo 2³².
pub trait Int:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> + 'static
{
    type Mask: Mask;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    /// Shift left by a constant, dropping what leaves 32 bits.
    fn left(self, by: u32) -> Self;
    fn right(self, by: u32) -> Self;
    /// The 32 bits in reverse order.
    fn reversed(self) -> Self;
    fn same(self, other: Self) -> Self::Mask;
    /// Unsigned `self < other`.
    fn below(self, other: Self) -> Self::Mask;
}

/// A width and precision of lanes on some instruction set, as a token that makes values.
pub trait Lanes: Copy + Send + Sync + 'static {
    type Scalar: Scalar;
    type Real: Real<Mask = Self::Mask>;
    type Int: Int<Mask = Self::Mask>;
    /// As many lanes as one packet has, where these are several packets.
    type Narrow: Lanes<Scalar = Self::Scalar>;
    type Mask: Mask;
    const COUNT: usize;
    /// Bits of a uniform variate that the significand holds.
    const UNIFORM_BITS: u32;

    fn instructions(self) -> Instructions;
    fn narrow(self) -> Self::Narrow;
    /// Runs `f` compiled for this instruction set; wrapped in a function that is not inlined, the
    /// boundary of a stage.
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R;
    /// The same value, rounded to this precision, in every lane.
    fn real(self, x: f64) -> Self::Real;
    fn splat(self, x: Self::Scalar) -> Self::Real;
    fn int(self, x: u32) -> Self::Int;
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
    /// `table[index]` lane by lane, for indices below 16.
    fn lookup(self, table: &[Self::Scalar; SMALL], index: Self::Int) -> Self::Real;
    fn lookup_int(self, table: &[u32; SMALL], index: Self::Int) -> Self::Int;
    fn lane(self, x: Self::Real, i: usize) -> Self::Scalar;
    fn int_lane(self, x: Self::Int, i: usize) -> u32;
    fn with_lane(self, x: Self::Real, i: usize, value: Self::Scalar) -> Self::Real;
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
    fn compress_int_into(self, x: Self::Int, keep: Self::Mask, to: &mut [u32]);

    /// Uniform variate in [0, 1) from 32 random bits, rounded *down* so that 1 cannot occur.
    #[inline(always)]
    fn uniform(self, bits: Self::Int) -> Self::Real {
        let kept = bits.right(32 - Self::UNIFORM_BITS);
        self.to_real(kept) * self.real(1.0 / (1u64 << Self::UNIFORM_BITS) as f64)
    }
}

/// Gives a closure back: for the macro of the same name.
#[inline(always)]
pub fn inlined<F>(f: F) -> F {
    f
}

/// The same of a closure that is called once. Without the bound it would be taken for one that can be
/// called again, and be called by way of an adapter that is not inlined.
#[inline(always)]
pub fn inlined_once<R, F: FnOnce() -> R>(f: F) -> F {
    f
}
