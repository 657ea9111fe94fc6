//! The first root on [0, 1] of polynomials in Bernstein form, eight at a time, with proof.
//!
//! The number of roots within (0, 1) is at most the number of sign changes of the Bernstein
//! coefficients, and less by an even number (Descartes' rule; Lane and Riesenfeld 1981). With
//! coefficients known within a bound, certain signs decide: all the same is *absent*, one change is
//! one simple root, anything else is split (de Casteljau) near the smallest coefficient, first part
//! first. A root is refined by Newton's method without bounds (the safeguarded polynomial
//! solver of Yuksel 2022 is its model), and the result enclosed by certain signs on both sides.
//! What the bound or the number of splits does not allow is *undecided*.

use crate::math::lanes::{Lanes, Mask, Real};
use crate::math::words::{Row, Word};

/// Highest degree.
pub const LARGEST_DEGREE: usize = 24;
const ROOM: usize = 2 * (LARGEST_DEGREE + 1);

/// Splits before a lane gives up: four halvings of every piece a polynomial of high degree can
/// have, and room for the search along a grazing one.
const MOST_SPLITS: usize = 48;

/// Steps of Newton's method, which doubles the digits in each, or halvings where it does not.
const MOST_STEPS: usize = 12;

/// Polynomials.
pub struct Problem<'a, L: Lanes> {
    /// degree + 1 Bernstein coefficients.
    pub coefficients: &'a [Row],
    /// Highest power.
    pub degree: usize,
    /// Bound of the coefficients' error.
    pub error: L::Real,
    /// Polynomials whose value at 0 is a root already known, up to `start_error`: it does not count.
    pub on_root: L::Mask,
    /// Bound of the value there.
    pub start_error: L::Real,
    /// Those that are asked for.
    pub active: L::Mask,
}

/// What is known of the first roots.
#[derive(Clone, Copy)]
pub struct Roots<L: Lanes> {
    /// There is one.
    pub found: L::Mask,
    /// There is none.
    pub absent: L::Mask,
    /// The polynomial is negative before the root, or everywhere.
    pub negative: L::Mask,
    /// Estimate of the root.
    pub root: L::Real,
    /// It is not before this.
    pub low: L::Real,
    /// Nor after this.
    pub high: L::Real,
}

/// Signs of a row of coefficients.
struct Signs<L: Lanes> {
    /// All certainly positive.
    positive: L::Mask,
    /// One certain change from positive to negative, with one uncertain sign between at most.
    one_change: L::Mask,
    /// Positive up to two uncertain ones at the end: the value and the slope there may be zero.
    touching: L::Mask,
    /// Where the smallest coefficient stands, as a share of the degree; within (0, 1).
    smallest: L::Real,
}

/// Reads the signs. `known` are the lanes whose first coefficient may have any sign.
#[inline(always)]
fn signs<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    rows: &[Row; ROOM],
    degree: usize,
    error: L::Real,
    known: L::Mask,
) -> Signs<L> {
    let first = W::load(l, rows, 0).head();
    let mut plus = first.gt(error) | known;
    let mut waiting = !plus & !first.lt(-error);
    let mut minus = l.mask(false);
    let mut touching = l.mask(false);
    let mut least = l.real(f64::INFINITY);
    let mut smallest = l.real(0.5);
    let share = 1.0 / degree as f64;
    for i in 1..=degree {
        let c = W::load(l, rows, i).head();
        let (positive, negative) = (c.gt(error), c.lt(-error));
        let uncertain = !positive & !negative;
        touching = uncertain & waiting;
        minus = negative & (plus | waiting | minus);
        waiting = uncertain & plus;
        plus = plus & positive;
        if i < degree {
            let smaller = c.lt(least);
            least = l.select(smaller, c, least);
            smallest = l.select(smaller, l.real(i as f64 * share), smallest);
        }
    }
    Signs {
        positive: plus,
        one_change: minus,
        touching,
        smallest,
    }
}

/// Splits `rest` at `at`: the part before, and the part after in its place.
#[inline(always)]
fn split<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    rest: &[Row; ROOM],
    degree: usize,
    at: L::Real,
    before: &mut [Row; ROOM],
    after: &mut [Row; ROOM],
) {
    after[..W::ROWS * (degree + 1)].copy_from_slice(&rest[..W::ROWS * (degree + 1)]);
    W::load(l, after, 0).store(l, before, 0);
    for level in 1..=degree {
        let mut a = W::load(l, after, 0);
        for i in 0..=degree - level {
            let b = W::load(l, after, i + 1);
            let c = b.minus(a).times_real(at).plus(a);
            c.store(l, after, i);
            if i == 0 {
                c.store(l, before, level);
            }
            a = b;
        }
    }
}

/// Copies the lanes of a mask.
#[inline(always)]
fn take<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    mask: L::Mask,
    from: &[Row; ROOM],
    to: &mut [Row; ROOM],
    degree: usize,
) {
    for i in 0..=degree {
        let (a, b) = (W::load(l, from, i), W::load(l, to, i));
        W::select(l, mask, a, b).store(l, to, i);
    }
}

/// The first roots in (0, 1).
#[inline(always)]
pub fn first_roots<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    problem: &Problem<'_, L>,
    binomials: &[f64],
) -> Roots<L> {
    let degree = problem.degree;
    let (zero, one) = (l.real(0.0), l.real(1.0));
    let nobody = l.mask(false);
    let mut rest = [Row::default(); ROOM];
    // Turned so that they are positive at first; a start on a root has the sign that follows it.
    let start = W::load(l, problem.coefficients, 0).head();
    let near_zero = !start.abs().gt(problem.start_error);
    let mut known = problem.on_root & near_zero;
    let second = W::load(l, problem.coefficients, 1).head();
    let negative = l.select(known, second, start).lt(zero);
    let sign = l.select(negative, -one, one);
    let mut largest = zero;
    for i in 0..=degree {
        let c = W::load(l, problem.coefficients, i);
        c.times_real(sign).store(l, &mut rest, i);
        largest = largest.max(c.head().abs());
    }
    // With the largest magnitude 1, a level of a split rounds a difference and a product below 2
    // and a sum below 1: 7U with the sum of magnitudes that double-double sums go by. One split's
    // worth pays for `value`, too.
    let per_split = largest * l.real(8.0 * degree as f64 * W::UNIT);
    let mut error = problem.error + per_split;

    let mut segment = rest;
    let (mut segment_from, mut segment_width) = (zero, one);
    let mut from = zero;
    let mut at = one;
    let (mut before, mut after) = ([Row::default(); ROOM], [Row::default(); ROOM]);
    let (mut found, mut absent, mut given_up) = (nobody, nobody, nobody);
    let mut fresh = problem.active;
    for _ in 0..MOST_SPLITS {
        let s = signs::<L, W>(l, &rest, degree, error, known);
        let alone = fresh & s.one_change;
        if alone.any() {
            take::<L, W>(l, alone, &rest, &mut segment, degree);
            segment_from = l.select(alone, from, segment_from);
            segment_width = l.select(alone, one - from, segment_width);
            found = found | alone;
        }
        absent = absent | (fresh & s.positive);
        given_up = given_up | (fresh & s.touching);
        at = l.select(fresh, s.smallest, at);
        let open = problem.active & !found & !absent & !given_up;
        if !open.any() {
            break;
        }
        split::<L, W>(l, &rest, degree, at, &mut before, &mut after);
        error = error + per_split;
        let s = signs::<L, W>(l, &before, degree, error, known);
        let alone = open & s.one_change;
        if alone.any() {
            take::<L, W>(l, alone, &before, &mut segment, degree);
            segment_from = l.select(alone, from, segment_from);
            segment_width = l.select(alone, at * (one - from), segment_width);
            found = found | alone;
        }
        given_up = given_up | (open & s.touching);
        fresh = open & s.positive;
        if fresh.any() {
            take::<L, W>(l, fresh, &after, &mut rest, degree);
            from = l.select(fresh, at.mul_add(one - from, from), from);
            known = known & !fresh;
        }
        at = l.select(open & !fresh, at * s.smallest, at);
    }
    let mut roots = Roots {
        found,
        absent,
        negative,
        root: zero,
        low: zero,
        high: one,
    };
    if found.any() {
        let [root, low, high] = refined::<L, W>(l, &segment, degree, error, found, binomials);
        // Two roundings a split in `from`, and three here, of numbers below 1.
        let slack = l.real((2 * MOST_SPLITS + 3) as f64 * f64::EPSILON / 2.0);
        roots.root = root.mul_add(segment_width, segment_from);
        roots.low = low.mul_add(segment_width, segment_from) - slack;
        roots.high = high.mul_add(segment_width, segment_from) + slack;
    }
    roots
}

/// The value at x in [0, 1], Bernstein form: Σ C(n, i) cᵢ xⁱ (1 − x)ⁿ⁻ⁱ by Horner's rule, with
/// 1 − x rounded once: the error is below (5n + 3)U times the largest coefficient.
#[inline(always)]
fn value<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    scaled: &[Row; ROOM],
    degree: usize,
    x: L::Real,
) -> L::Real {
    let x = W::real(l, x);
    let y = W::real(l, l.real(1.0)).minus(x);
    let mut power = x;
    let mut sum = W::load(l, scaled, 0);
    for i in 1..=degree {
        let term = W::load(l, scaled, i).times(power);
        sum = sum.fused(y, term);
        if i < degree {
            power = power.times(x);
        }
    }
    sum.head()
}

/// The only root of polynomials that go from positive to negative, with its enclosure.
#[inline(always)]
fn refined<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    segment: &[Row; ROOM],
    degree: usize,
    error: L::Real,
    active: L::Mask,
    binomials: &[f64],
) -> [L::Real; 3] {
    let (zero, one, half) = (l.real(0.0), l.real(1.0), l.real(0.5));
    // Powers of x by differences: good to a few digits less than the coefficients.
    let mut powers = [Row::default(); LARGEST_DEGREE + 1];
    let mut scaled = [Row::default(); ROOM];
    for i in 0..=degree {
        let c = W::load(l, segment, i);
        l.store(c.head(), &mut powers[i].0);
        c.times_real(l.real(binomials[i])).store(l, &mut scaled, i);
    }
    for level in 1..=degree {
        for i in (level..=degree).rev() {
            let difference = l.load(&powers[i].0) - l.load(&powers[i - 1].0);
            l.store(difference, &mut powers[i].0);
        }
    }
    for i in 1..degree {
        let c = l.load(&powers[i].0) * l.real(binomials[i]);
        l.store(c, &mut powers[i].0);
    }
    let (mut low, mut high) = (zero, one);
    let first = W::load(l, segment, 0).head();
    let last = W::load(l, segment, degree).head();
    let mut x = first / (first - last);
    let top = l.load(&powers[degree].0);
    let mut slope = -one;
    for _ in 0..MOST_STEPS {
        let (mut f, mut d) = (top, zero);
        for i in (0..degree).rev() {
            d = d.mul_add(x, f);
            f = f.mul_add(x, l.load(&powers[i].0));
        }
        let ahead = f.gt(zero);
        low = l.select(ahead, x, low);
        high = l.select(ahead, high, x);
        slope = d;
        let next = x - f / d;
        let inside = next.gt(low) & next.lt(high);
        let next = l.select(inside, next, (low + high) * half);
        let step = (next - x).abs();
        x = next;
        if !(active & step.gt(l.real(4.0 * f64::EPSILON))).any() {
            break;
        }
    }
    enclosed::<L, W>(l, &scaled, degree, error, active, x, slope)
}

/// Improves the estimate by accurate values and encloses the root by certain signs.
#[inline(always)]
fn enclosed<L: Lanes<Scalar = f64>, W: Word<L>>(
    l: L,
    scaled: &[Row; ROOM],
    degree: usize,
    error: L::Real,
    active: L::Mask,
    estimate: L::Real,
    slope: L::Real,
) -> [L::Real; 3] {
    let (zero, one) = (l.real(0.0), l.real(1.0));
    let within = |x: L::Real| x.max(zero).min(one);
    let slope = -(slope.abs().max(l.real(f64::MIN_POSITIVE)));
    let x = within(estimate - value::<L, W>(l, scaled, degree, estimate) / slope);
    let mut width = (error / -slope).mul_add(l.real(2.0), l.real(2.0 * f64::EPSILON));
    let (mut low, mut high) = (zero, one);
    let mut open = active;
    for _ in 0..6 {
        let (a, b) = (within(x - width), within(x + width));
        let before = value::<L, W>(l, scaled, degree, a).gt(error);
        let after = value::<L, W>(l, scaled, degree, b).lt(-error);
        low = l.select(before, a.max(low), low);
        high = l.select(after, b.min(high), high);
        open = open & !(before & after);
        if !open.any() {
            break;
        }
        width = width * l.real(16.0);
    }
    [x.max(low).min(high), low, high]
}
