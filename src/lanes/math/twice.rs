//! Two packets side by side.
//!
//! The loop's arithmetic is a long chain of dependent operations. A second, independent packet fills the
//! time in which the first one waits. No lane sees its neighbours, so the bits stay the same.

use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

use super::instructions::Instructions;
use super::lanes::{Int, Lanes, Mask, Real};
use super::lookup::SMALL;

/// Two packets as one, of twice as many lanes.
#[derive(Clone, Copy)]
pub struct Twice<L>(pub L);

/// The values of the first packet and of the second.
#[derive(Clone, Copy)]
pub struct Pair<V>(pub V, pub V);

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<V: $trait<Output = V>> $trait for Pair<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);
operator!(BitAnd, bitand);
operator!(BitOr, bitor);
operator!(BitXor, bitxor);

impl<V: Neg<Output = V>> Neg for Pair<V> {
    type Output = Self;
    methods! { fn neg(self) -> Self = Self(-self.0, -self.1); }
}

impl<V: Not<Output = V>> Not for Pair<V> {
    type Output = Self;
    methods! { fn not(self) -> Self = Self(!self.0, !self.1); }
}

impl<M: Mask> Mask for Pair<M> {
    const COUNT: u32 = 2 * M::COUNT;
    methods! {
        fn any(self) -> bool = (self.0 | self.1).any();
        fn bits(self) -> u32 = self.0.bits() | self.1.bits() << M::COUNT;
    }
}

macro_rules! forward {
    ($(fn $method:ident(self $(, $other:ident)?) -> $result:ident;)*) => {
        $(
            #[inline(always)]
            fn $method(self $(, $other: Self)?) -> forward!(@ $result) {
                Pair(self.0.$method($($other.0)?), self.1.$method($($other.1)?))
            }
        )*
    };
    (@ Itself) => { Self };
    (@ Truth) => { Self::Mask };
}

impl<R: Real> Real for Pair<R> {
    type Mask = Pair<R::Mask>;
    methods! {
        fn mul_add(self, a: Self, b: Self) -> Self =
            Self(self.0.mul_add(a.0, b.0), self.1.mul_add(a.1, b.1));
    }
    forward! {
        fn sqrt(self) -> Itself;
        fn abs(self) -> Itself;
        fn min(self, other) -> Itself;
        fn max(self, other) -> Itself;
        fn floor(self) -> Itself;
        fn round(self) -> Itself;
        fn copysign(self, sign) -> Itself;
        fn lt(self, other) -> Truth;
        fn le(self, other) -> Truth;
        fn gt(self, other) -> Truth;
        fn ge(self, other) -> Truth;
        fn same(self, other) -> Truth;
    }
}

impl<I: Int> Int for Pair<I> {
    type Mask = Pair<I::Mask>;
    forward! {
        fn plus(self, other) -> Itself;
        fn minus(self, other) -> Itself;
        fn times(self, other) -> Itself;
        fn reversed(self) -> Itself;
        fn same(self, other) -> Truth;
        fn below(self, other) -> Truth;
    }
    methods! {
        fn left(self, by: u32) -> Self = Self(self.0.left(by), self.1.left(by));
        fn right(self, by: u32) -> Self = Self(self.0.right(by), self.1.right(by));
    }
}

/// Methods that give the same value to both packets.
macro_rules! alike {
    ($(fn $method:ident(x: $type:ty) -> $result:ident;)*) => {
        $(
            #[inline(always)]
            fn $method(self, x: $type) -> Self::$result {
                let x = self.0.$method(x);
                Pair(x, x)
            }
        )*
    };
}

/// Methods that are applied to one packet after the other.
macro_rules! each {
    ($(fn $method:ident($($x:ident: $type:ident),*) -> $result:ident;)*) => {
        $(
            #[inline(always)]
            fn $method(self $(, $x: Self::$type)*) -> Self::$result {
                Pair(self.0.$method($($x.0),*), self.0.$method($($x.1),*))
            }
        )*
    };
}

/// What is done alike to reals and to integers.
macro_rules! values {
    (
        $value:ident of $scalar:ty:
        $load:ident, $store:ident, $lookup:ident, $lane:ident, $with_lane:ident, $select:ident,
        $compress:ident
    ) => {
        methods! {
            fn $load(self, from: &[$scalar]) -> Self::$value =
                Pair(self.0.$load(from), self.0.$load(&from[L::COUNT..]));
            fn $lookup(self, table: &[$scalar; SMALL], index: Self::Int) -> Self::$value =
                Pair(self.0.$lookup(table, index.0), self.0.$lookup(table, index.1));
        }
        each! { fn $select(m: Mask, a: $value, b: $value) -> $value; }
        #[inline(always)]
        fn $store(self, x: Self::$value, to: &mut [$scalar]) {
            self.0.$store(x.0, to);
            self.0.$store(x.1, &mut to[L::COUNT..]);
        }
        #[inline(always)]
        fn $lane(self, x: Self::$value, i: usize) -> $scalar {
            if i < L::COUNT {
                self.0.$lane(x.0, i)
            } else {
                self.0.$lane(x.1, i - L::COUNT)
            }
        }
        #[inline(always)]
        fn $with_lane(self, x: Self::$value, i: usize, value: $scalar) -> Self::$value {
            if i < L::COUNT {
                Pair(self.0.$with_lane(x.0, i, value), x.1)
            } else {
                Pair(x.0, self.0.$with_lane(x.1, i - L::COUNT, value))
            }
        }
        #[inline(always)]
        fn $compress(self, x: Self::$value, keep: Self::Mask, to: &mut [$scalar]) {
            self.0.$compress(x.0, keep.0, to);
            let kept = keep.0.bits().count_ones() as usize;
            self.0.$compress(x.1, keep.1, &mut to[kept..]);
        }
    };
}

impl<L: Lanes> Lanes for Twice<L> {
    type Scalar = L::Scalar;
    type Real = Pair<L::Real>;
    type Int = Pair<L::Int>;
    type Narrow = L::Narrow;
    type Mask = Pair<L::Mask>;
    const COUNT: usize = 2 * L::COUNT;
    const UNIFORM_BITS: u32 = L::UNIFORM_BITS;

    methods! {
        fn instructions(self) -> Instructions = self.0.instructions();
        fn narrow(self) -> L::Narrow = self.0.narrow();
    }
    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        self.0.vectorize(f)
    }
    alike! {
        fn real(x: f64) -> Real;
        fn splat(x: Self::Scalar) -> Real;
        fn int(x: u32) -> Int;
        fn mask(x: bool) -> Mask;
    }
    #[inline(always)]
    fn mask_from_bits(self, bits: u32) -> Self::Mask {
        Pair(
            self.0.mask_from_bits(bits & ((1 << L::COUNT) - 1)),
            self.0.mask_from_bits(bits >> L::COUNT),
        )
    }
    values! { Real of Self::Scalar: load, store, lookup, lane, with_lane, select, compress_into }
    values! {
        Int of u32:
        load_int, store_int, lookup_int, int_lane, with_int_lane, select_int, compress_int_into
    }
    each! {
        fn truncate(x: Real) -> Int;
        fn to_real(x: Int) -> Real;
        fn power_of_two(e: Real) -> Real;
    }
    #[inline(always)]
    fn split_exponent(self, x: Self::Real) -> (Self::Real, Self::Real) {
        let (low, high) = (self.0.split_exponent(x.0), self.0.split_exponent(x.1));
        (Pair(low.0, high.0), Pair(low.1, high.1))
    }
}
