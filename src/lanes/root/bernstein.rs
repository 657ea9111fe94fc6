//! The first root on [0, 1] of polynomials in Bernstein form, eight at a time, with proof.
//!
//! The number of roots within (0, 1) is at most the number of sign changes of the Bernstein
//! coefficients, and less by an even number (Descartes' rule; Lane and Riesenfeld 1981). With
//! coefficients known within a bound, certain signs decide: all the same is *absent*, one change is
//! one simple root, anything else is split (de Casteljau) where the control polygon has its first
//! minimum below zero, and the first part looked at first. A root is refined by Newton's method within a
//! bracket (the safeguarded solver of Yuksel 2022 is the model) and then enclosed by certain signs
//! on both sides. What the bound or the number of splits does not decide is *undecided*.

use crate::math::lanes::{Lanes, Mask, Real};
use crate::math::words::Word;

/// Degrees that are solved; others are raised to the next.
pub const DEGREES: [usize; 6] = [2, 4, 6, 8, 12, 24];

/// Most coefficients.
pub const MOST: usize = 25;

/// Splits before a lane gives up. A split at a minimum decides unless the minimum is within the
/// bound of zero; a polynomial of degree n has n/2 of them, and each is found in a few steps.
/// A root with a close pair of complex ones is narrowed by halves, down to their distance, which
/// takes as many more as there are digits more: so this is for each word of a number.
const MOST_SPLITS: usize = 32;

/// Steps of Newton's method, which doubles the digits in each, or halvings where it does not.
const MOST_STEPS: usize = 24;

/// The polynomials apart from their coefficients.
pub struct Question<L: Lanes> {
    /// Bound of the coefficients' error.
    pub error: L::Real,
    /// Polynomials whose value at 0 is a root already known, up to `start_error`: it does not
    /// count.
    pub on_root: L::Mask,
    /// Bound of the value there.
    pub start_error: L::Real,
    /// How many times 1 is known to be a root, in all lanes: that many last coefficients are zero.
    pub roots_at_end: usize,
    /// Factor on the bound of the solver's own rounding: 1, or 0 for tests to see that the bound is
    /// needed.
    pub accounted: f64,
    pub active: L::Mask,
}

/// The first roots, as far as they were decided.
#[derive(Clone, Copy)]
pub struct Roots<L: Lanes> {
    pub found: L::Mask,
    pub absent: L::Mask,
    /// The polynomial is negative before the root, or everywhere.
    pub negative: L::Mask,
    pub root: L::Real,
    /// It is not before this.
    pub low: L::Real,
    /// Nor after this.
    pub high: L::Real,
    /// Where the search ended in lanes that are neither: a root of higher multiplicity is near.
    pub doubt: L::Real,
}

struct Signs<L: Lanes> {
    /// All certainly positive.
    positive: L::Mask,
    /// One certain change from positive to negative, with one uncertain sign between at most.
    one_change: L::Mask,
    /// Positive up to two uncertain ones at the end: the value and the slope there may be zero.
    touching: L::Mask,
}

/// C(n, i + 1) from C(n, i), exactly: they stay below 2²², and the products below 2²⁷.
#[inline(always)]
fn next_binomial(n: usize, i: usize, c: u32) -> u32 {
    c * (n - i) as u32 / (i + 1) as u32
}

/// Error that one split adds to coefficients below 1. A level rounds a difference and a product
/// below 2 and a sum below 1: 7U with the sum of magnitudes that double-double sums go by.
pub const fn split_error(degree: usize, unit: f64) -> f64 {
    8.0 * degree as f64 * unit
}

/// The signs of coefficients. In the lanes of `known` the first one may have any sign.
#[inline(always)]
fn signs<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    c: &[W],
    error: L::Real,
    known: L::Mask,
) -> Signs<L> {
    let first = c[0].head();
    let nobody = l.mask(false);
    let mut plus = first.gt(error) | known;
    let (mut waiting, mut minus, mut touching) = (nobody, nobody, nobody);
    for c in &c[1..] {
        let c = c.head();
        let (positive, negative) = (c.gt(error), c.lt(-error));
        let uncertain = !positive & !negative;
        touching = uncertain & waiting;
        minus = negative & (plus | waiting | minus);
        waiting = uncertain & plus;
        plus = plus & positive;
    }
    Signs {
        positive: plus,
        one_change: minus,
        touching,
    }
}

/// Where the first minimum of the control polygon that may be below zero is, by the derivative's
/// polygon; the middle where there is none.
#[inline(always)]
fn minimum<L: Lanes<Scalar = f64>, W: Word<L>>(l: L, c: &[W], error: L::Real) -> L::Real {
    let zero = l.real(0.0);
    let mut open = l.mask(true);
    let (mut place, mut fall, mut turn) = (l.real(0.5), zero, l.real(1.0));
    let share = 1.0 / (c.len() - 2) as f64;
    for i in 1..c.len() - 1 {
        let (before, after) = (c[i].minus(c[i - 1]).head(), c[i + 1].minus(c[i]).head());
        let lowest = before.lt(zero) & after.ge(zero) & c[i].head().le(error) & open;
        place = l.select(lowest, l.real((i - 1) as f64 * share), place);
        fall = l.select(lowest, before, fall);
        turn = l.select(lowest, before - after, turn);
        open = open & !lowest;
    }
    let at = (fall / turn).mul_add(l.real(share), place);
    // Away from the ends, for progress.
    at.max(l.real(1.0 / 64.0)).min(l.real(63.0 / 64.0))
}

/// Splits `after` at a point: the first part goes into `before`.
#[inline(always)]
#[expect(
    clippy::needless_range_loop,
    reason = "iterators over lanes are not always inlined"
)]
fn split<L: Lanes<Scalar = f64>, W: Word<L>>(after: &mut [W], before: &mut [W], at: L::Real) {
    before[0] = after[0];
    let count = after.len();
    for level in 1..count {
        for i in 0..count - level {
            after[i] = after[i + 1].minus(after[i]).times_real(at).plus(after[i]);
        }
        before[level] = after[0];
    }
}

/// `a` in the lanes of a mask, else `b`.
#[inline(always)]
fn merged<L: Lanes<Scalar = f64>, W: Word<L>>(l: L, mask: L::Mask, a: &[W], b: &mut [W]) {
    for i in 0..a.len() {
        b[i] = W::select(l, mask, a[i], b[i]);
    }
}

/// A part of [0, 1] with one root.
struct Segment<L: Lanes<Scalar = f64>, W: Word<L>, const M: usize> {
    coefficients: [W; M],
    from: L::Real,
    width: L::Real,
}

impl<L: Lanes<Scalar = f64>, W: Word<L>, const M: usize> Segment<L, W, M> {
    #[inline(always)]
    fn take(&mut self, l: L, mask: L::Mask, coefficients: &[W], from: L::Real, width: L::Real) {
        merged(l, mask, coefficients, &mut self.coefficients);
        self.from = l.select(mask, from, self.from);
        self.width = l.select(mask, width, self.width);
    }
}

/// Multiplies by `sign`, with zeros from `counted` on, and returns the largest magnitude.
#[inline(always)]
fn turned<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    rest: &mut [W],
    counted: usize,
    sign: L::Real,
) -> L::Real {
    let mut largest = l.real(0.0);
    for c in &mut rest[counted..] {
        *c = W::constant(l, [0.0; 2]);
    }
    for c in rest.iter_mut() {
        *c = c.times_real(sign);
        largest = largest.max(c.head().abs());
    }
    largest
}

/// The first roots in (0, 1) of polynomials with the first `count` of these Bernstein coefficients.
#[inline(always)]
pub fn first_roots<L: Lanes<Scalar = f64>, W: Word<L>, const M: usize>(
    l: L,
    given: &[W; M],
    count: usize,
    question: &Question<L>,
) -> Roots<L> {
    let (zero, one) = (l.real(0.0), l.real(1.0));
    let nobody = l.mask(false);
    let mut coefficients = *given;
    let rest = &mut coefficients[..count];
    // Turned so that they are positive at first; a start on a root has the sign that follows it.
    let start = rest[0].head();
    let mut known = question.on_root & !start.abs().gt(question.start_error);
    let negative = l.select(known, rest[1].head(), start).lt(zero);
    let sign = l.select(negative, -one, one);
    let counted = count - question.roots_at_end.min(count - 1);
    let largest = turned(l, rest, counted, sign);
    // One split's worth pays for `value`, too.
    let own = split_error(count - 1, W::UNIT) * question.accounted;
    let per_split = largest * l.real(own);
    let mut error = question.error + per_split;
    let (mut before, mut after) = (*given, *given);
    let mut segment = Segment {
        coefficients: *given,
        from: zero,
        width: one,
    };
    let (mut from, mut at) = (zero, one);
    // A start whose sign is unknown stays so in every first part.
    let (mut found, mut absent, mut given_up) = (nobody, nobody, !known & !start.abs().gt(error));
    let mut fresh = question.active & !given_up;
    let (mut doubt, mut part) = (one, one);
    for _ in 0..MOST_SPLITS * W::ROWS {
        let s = signs(l, &rest[..counted], error, known);
        let alone = fresh & s.one_change;
        if alone.any() {
            segment.take(l, alone, rest, from, one - from);
            found = found | alone;
        }
        absent = absent | (fresh & s.positive);
        given_up = given_up | (fresh & s.touching);
        let open = question.active & !found & !absent & !given_up;
        if !open.any() {
            break;
        }
        // What is left of a part that was not decided as a whole comes first.
        let next = l.select(part.lt(one), part, minimum(l, rest, error));
        at = l.select(fresh, next, at);
        doubt = l.select(open, at.mul_add(one - from, from), doubt);
        let (before, after) = (&mut before[..count], &mut after[..count]);
        after.copy_from_slice(rest);
        split(after, before, at);
        // A lane's bound is that of its own splits, not of those that others still need.
        error = l.select(open, error + per_split, error);
        let s = signs(l, before, error, known);
        let alone = open & s.one_change;
        if alone.any() {
            segment.take(l, alone, before, from, at * (one - from));
            found = found | alone;
        }
        given_up = given_up | (open & s.touching);
        fresh = open & s.positive;
        let left = l.select(part.gt(at), (part - at) / (one - at), one);
        part = l.select(fresh, left, l.select(open, at, part));
        if fresh.any() {
            merged(l, fresh, after, rest);
            from = l.select(fresh, at.mul_add(one - from, from), from);
            known = known & !fresh;
        }
        at = at * minimum(l, before, error);
    }
    let mut roots = Roots {
        found,
        absent,
        negative,
        root: zero,
        low: zero,
        high: one,
        doubt,
    };
    if found.any() {
        let [root, low, high] = refined(l, &segment.coefficients, count, error, found);
        // Two roundings a split in `from`, and three here, of numbers below 1.
        let slack = l.real((2 * MOST_SPLITS * W::ROWS + 3) as f64 * f64::EPSILON / 2.0);
        roots.root = root.mul_add(segment.width, segment.from);
        roots.low = low.mul_add(segment.width, segment.from) - slack;
        roots.high = high.mul_add(segment.width, segment.from) + slack;
    }
    roots
}

/// The value at x in [0, 1] of a form with coefficients C(n, i) cᵢ: Σ C(n, i) cᵢ xⁱ (1 − x)ⁿ⁻ⁱ by
/// Horner's rule, with 1 − x rounded once. The error is below (5n + 3)U times the largest cᵢ.
#[inline(always)]
fn value<L: Lanes<Scalar = f64>, W: Word<L>>(l: L, scaled: &[W], x: L::Real) -> L::Real {
    let x = W::real(l, x);
    let y = W::real(l, l.real(1.0)).minus(x);
    let mut power = x;
    let mut sum = scaled[0];
    for (i, c) in scaled.iter().enumerate().skip(1) {
        sum = sum.fused(y, c.times(power));
        if i < scaled.len() - 1 {
            power = power.times(x);
        }
    }
    sum.head()
}

/// Where the control polygon crosses zero.
#[inline(always)]
fn crossing<L: Lanes<Scalar = f64>, W: Word<L>>(l: L, c: &[W]) -> L::Real {
    let zero = l.real(0.0);
    let (mut place, mut above, mut fall) = (zero, zero, l.real(1.0));
    for i in 1..c.len() {
        let (before, after) = (c[i - 1].head(), c[i].head());
        let crosses = before.gt(zero) & !after.gt(zero);
        place = l.select(crosses, l.real((i - 1) as f64), place);
        above = l.select(crosses, before, above);
        fall = l.select(crosses, before - after, fall);
    }
    (above / fall + place) * l.real(1.0 / (c.len() - 1) as f64)
}

/// The only root of polynomials that go from positive to negative, with its enclosure.
#[inline(always)]
fn refined<L: Lanes<Scalar = f64>, W: Word<L>, const M: usize>(
    l: L,
    segment: &[W; M],
    count: usize,
    error: L::Real,
    active: L::Mask,
) -> [L::Real; 3] {
    let (zero, one, half) = (l.real(0.0), l.real(1.0), l.real(0.5));
    // Powers of x by differences: good to a few digits less than the coefficients.
    let (mut powers, mut scaled) = ([zero; M], *segment);
    let (powers, scaled) = (&mut powers[..count], &mut scaled[..count]);
    for (power, c) in powers.iter_mut().zip(scaled.iter()) {
        *power = c.head();
    }
    for level in 1..count {
        for i in (level..count).rev() {
            powers[i] = powers[i] - powers[i - 1];
        }
    }
    let mut binomial = 1;
    for i in 0..count {
        let times = l.real(f64::from(binomial));
        scaled[i] = scaled[i].times_real(times);
        powers[i] = powers[i] * times;
        binomial = next_binomial(count - 1, i, binomial);
    }
    let (mut low, mut high) = (zero, one);
    let mut x = crossing(l, &segment[..count]);
    let mut slope = -one;
    // Lanes whose estimate is good enough stand still, so that a root does not depend, in its last
    // digits, on which others are sought beside it.
    let mut moving = active;
    for _ in 0..MOST_STEPS {
        let (mut f, mut d) = (powers[count - 1], zero);
        for c in powers[..count - 1].iter().rev() {
            d = d.mul_add(x, f);
            f = f.mul_add(x, *c);
        }
        let ahead = f.gt(zero);
        low = l.select(ahead, x, low);
        high = l.select(ahead, high, x);
        slope = l.select(moving, d, slope);
        let next = x - f / d;
        // At a root the next estimate is an end of the bracket.
        let inside = next.ge(low) & next.le(high);
        let next = l.select(inside, next, (low + high) * half);
        let step = (next - x).abs();
        x = l.select(moving, next, x);
        // The next step is of the order of the square of this one, and the slope right to as much
        // of itself, where the root is not much closer to a minimum than 2⁻²⁰ of the segment.
        moving = moving & step.gt(l.real(1.0 / (1u64 << 40) as f64));
        if !moving.any() {
            break;
        }
    }
    enclosed(l, scaled, error, active, x, slope)
}

/// Improves the estimate by accurate values and encloses the root by certain signs.
#[inline(always)]
fn enclosed<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    scaled: &[W],
    error: L::Real,
    active: L::Mask,
    estimate: L::Real,
    slope: L::Real,
) -> [L::Real; 3] {
    let (zero, one) = (l.real(0.0), l.real(1.0));
    let steepness = slope.abs().max(l.real(f64::MIN_POSITIVE));
    let x = (estimate + value(l, scaled, estimate) / steepness)
        .max(zero)
        .min(one);
    let mut width = (error / steepness).mul_add(l.real(1.5), l.real(2.0 * f64::EPSILON));
    let (mut low, mut high) = (zero, one);
    let mut open = active;
    // Twelve widths reach 8¹¹ = 2³³ times the first; a side without a certain sign by then keeps the
    // end of [0, 1].
    for _ in 0..12 {
        let (a, b) = ((x - width).max(zero), (x + width).min(one));
        let before = value(l, scaled, a).gt(error);
        let after = value(l, scaled, b).lt(-error);
        low = l.select(before, a.max(low), low);
        high = l.select(after, b.min(high), high);
        open = open & !(before & after);
        if !open.any() {
            break;
        }
        width = width * l.real(8.0);
    }
    [x.max(low).min(high), low, high]
}
