//! Numbers of one or two f64 a lane, each with a bound of its rounding errors.

use super::lanes::{Lanes, Real};

/// Eight f64 in memory, one cache line.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub struct Row(pub [f64; 8]);

pub trait Word<L: Lanes<Scalar = f64>>: Copy {
    /// Rows that a packet of such numbers takes in memory.
    const ROWS: usize;
    /// Error of a sum or product, relative to the sum or product of the operands' magnitudes.
    const UNIT: f64;
    fn real(l: L, x: L::Real) -> Self;
    /// The same constant, given as a sum, in every lane.
    fn constant(l: L, parts: [f64; 2]) -> Self;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn times_real(self, x: L::Real) -> Self;
    fn fused(self, a: Self, b: Self) -> Self;
    /// The nearest f64.
    fn head(self) -> L::Real;
    /// Lane by lane `a` where the mask is true, else `b`.
    fn select(l: L, mask: L::Mask, a: Self, b: Self) -> Self;
    fn load(l: L, rows: &[Row], i: usize) -> Self;
    fn store(self, l: L, rows: &mut [Row], i: usize);
}

#[derive(Clone, Copy)]
pub struct Plain<L: Lanes>(pub L::Real);

/// An unevaluated sum of two f64, the second at most half a unit in the last place of the first.
///
/// Sums take the exact sum of the high words and add the low ones to its error; three roundings of
/// numbers below 2u (|a| + |b|) and the exact renormalisation cost less than 4u² (|a| + |b|).
/// Products leave out the product of the low words, u² |a b|, and round sums below u, 2u and
/// 3u |a b|: less than 8u² |a b| together (Joldes, Muller, Popescu 2017, algorithms 5 and 12, with
/// bounds in the magnitudes of the operands, which is what sums of majorants need).
#[derive(Clone, Copy)]
pub struct Pair<L: Lanes> {
    high: L::Real,
    low: L::Real,
}

impl<L: Lanes<Scalar = f64>> Word<L> for Plain<L> {
    const ROWS: usize = 1;
    const UNIT: f64 = f64::EPSILON / 2.0;
    methods! {
        fn real(_: L, x: L::Real) -> Self = Self(x);
        fn constant(l: L, parts: [f64; 2]) -> Self = Self(l.real(parts[0]));
        fn plus(self, other: Self) -> Self = Self(self.0 + other.0);
        fn minus(self, other: Self) -> Self = Self(self.0 - other.0);
        fn times(self, other: Self) -> Self = Self(self.0 * other.0);
        fn times_real(self, x: L::Real) -> Self = Self(self.0 * x);
        fn fused(self, a: Self, b: Self) -> Self = Self(self.0.mul_add(a.0, b.0));
        fn head(self) -> L::Real = self.0;
        fn select(l: L, mask: L::Mask, a: Self, b: Self) -> Self = Self(l.select(mask, a.0, b.0));
        fn load(l: L, rows: &[Row], i: usize) -> Self = Self(l.load(&rows[i].0));
        fn store(self, l: L, rows: &mut [Row], i: usize) -> () = l.store(self.0, &mut rows[i].0);
    }
}

impl<L: Lanes<Scalar = f64>> Pair<L> {
    methods! {
        fn new(high: L::Real, low: L::Real) -> Self = Self { high, low };
        pub fn tail(self) -> L::Real = self.low;
    }

    /// The exact sum of two numbers, as a normalised pair.
    #[inline(always)]
    pub fn normalised(high: L::Real, low: L::Real) -> Self {
        let (high, low) = two_sum::<L>(high, low);
        Self::new(high, low)
    }

    /// The same where |e| ≤ 3u |p|, which makes the fast sum exact (Dekker 1971).
    #[inline(always)]
    fn fast_normalised(p: L::Real, e: L::Real) -> Self {
        let high = p + e;
        Self::new(high, e - (high - p))
    }
}

/// a + b = s + e exactly (Knuth 1969).
#[inline(always)]
fn two_sum<L: Lanes>(a: L::Real, b: L::Real) -> (L::Real, L::Real) {
    let s = a + b;
    let part = s - a;
    (s, (a - (s - part)) + (b - part))
}

impl<L: Lanes<Scalar = f64>> Word<L> for Pair<L> {
    const ROWS: usize = 2;
    const UNIT: f64 = 2.0 * f64::EPSILON * f64::EPSILON;
    methods! {
        fn real(l: L, x: L::Real) -> Self = Self::new(x, l.real(0.0));
        fn constant(l: L, [high, low]: [f64; 2]) -> Self = Self::new(l.real(high), l.real(low));
        fn minus(self, other: Self) -> Self = self.plus(Self::new(-other.high, -other.low));
        fn fused(self, a: Self, b: Self) -> Self = self.times(a).plus(b);
        fn head(self) -> L::Real = self.high;
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        let (s, e) = two_sum::<L>(self.high, other.high);
        Self::normalised(s, e + (self.low + other.low))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        let p = self.high * other.high;
        let e = self.high.mul_add(other.high, -p);
        let e = self.high.mul_add(other.low, e);
        Self::fast_normalised(p, self.low.mul_add(other.high, e))
    }
    #[inline(always)]
    fn times_real(self, x: L::Real) -> Self {
        let p = self.high * x;
        Self::fast_normalised(p, self.low.mul_add(x, self.high.mul_add(x, -p)))
    }
    #[inline(always)]
    fn select(l: L, mask: L::Mask, a: Self, b: Self) -> Self {
        let low = l.select(mask, a.low, b.low);
        Self::new(l.select(mask, a.high, b.high), low)
    }
    #[inline(always)]
    fn load(l: L, rows: &[Row], i: usize) -> Self {
        Self::new(l.load(&rows[2 * i].0), l.load(&rows[2 * i + 1].0))
    }
    #[inline(always)]
    fn store(self, l: L, rows: &mut [Row], i: usize) {
        l.store(self.high, &mut rows[2 * i].0);
        l.store(self.low, &mut rows[2 * i + 1].0);
    }
}
