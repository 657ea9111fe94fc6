//! Elementary functions of lanes: the same bits on every instruction set.
//!
//! Each is a range reduction and a truncated series whose remainder, written beside it, is below
//! half a unit in the last place of the precision in use; with the rounding of the evaluation the
//! results are good to 2½ ulp (sine, cosine), 3½ ulp (logarithm) and, *absolutely*, 0.3 ulp of 1
//! (angle in turns) on the stated domain. Sampling only needs a map and *its own* density to
//! agree, which does not depend on these errors to first order.

use super::lanes::{Int, Lanes, Real};

/// Whether lanes are single precision, known at compile time.
#[inline(always)]
fn single<L: Lanes>() -> bool {
    L::UNIFORM_BITS == 24
}

/// Σ cᵢ xⁱ by Horner's rule.
#[inline(always)]
pub(super) fn polynomial<L: Lanes>(l: L, x: L::Real, coefficients: &[f64]) -> L::Real {
    let mut sum = l.real(coefficients[coefficients.len() - 1]);
    for &c in coefficients.iter().rev().skip(1) {
        sum = sum.mul_add(x, l.real(c));
    }
    sum
}

/// The series `sign`ᵏ / (first + `step` k)!, whose factorials must be exact in f64: up to 18!.
pub(super) const fn over_factorials<const N: usize>(first: u32, step: u32, sign: f64) -> [f64; N] {
    let mut series = [0.0; N];
    let (mut k, mut n, mut factorial, mut numerator) = (0, 0, 1.0, 1.0);
    while k < N {
        while n < first + step * k as u32 {
            n += 1;
            factorial *= n as f64;
        }
        series[k] = numerator / factorial;
        numerator *= sign;
        k += 1;
    }
    series
}

/// The series `sign`ᵏ / (2k + 1).
pub(super) const fn over_odd<const N: usize>(sign: f64) -> [f64; N] {
    let mut series = [0.0; N];
    let (mut k, mut numerator) = (0, 1.0);
    while k < N {
        series[k] = numerator / (2 * k + 1) as f64;
        numerator *= sign;
        k += 1;
    }
    series
}

/// Taylor series of sin x / x in x².
pub(super) const SIN: [f64; 9] = over_factorials(1, 2, -1.0);
/// Taylor series of cos x in x².
pub(super) const COS: [f64; 9] = over_factorials(0, 2, -1.0);
/// Taylor series of arctan x / x in x².
pub(super) const ARCTAN: [f64; 21] = over_odd(-1.0);

/// (sin x, cos x) for |x| ≤ π/4 by Taylor series in x².
#[inline(always)]
fn near_zero<L: Lanes>(l: L, x: L::Real) -> (L::Real, L::Real) {
    let xx = x * x;
    let (sines, cosines) = if single::<L>() { (5, 6) } else { (9, 9) };
    (
        polynomial(l, xx, &SIN[..sines]) * x,
        polynomial(l, xx, &COS[..cosines]),
    )
}

/// (sin 2πu, cos 2πu) for |u| ≤ 1/8: [`sin_cos_turns`] where no range is to be reduced.
#[inline(always)]
pub fn sin_cos_eighth<L: Lanes>(l: L, u: L::Real) -> (L::Real, L::Real) {
    near_zero(l, u * l.real(std::f64::consts::TAU))
}

/// (sin 2πu, cos 2πu) for |u| ≤ 2.
///
/// u = q/4 + r with |r| ≤ 1/8 exactly; Taylor series in (2πr)². Remainders at 2πr = π/4: single
/// (π/4)¹¹/11! = 1.8e-9 and (π/4)¹²/12! = 1.2e-10, double (π/4)¹⁹/19! = 8e-20 and
/// (π/4)¹⁸/18! = 2e-18.
#[inline(always)]
pub fn sin_cos_turns<L: Lanes>(l: L, u: L::Real) -> (L::Real, L::Real) {
    let quarter = (u * l.real(4.0)).round();
    let x = quarter.mul_add(l.real(-0.25), u) * l.real(std::f64::consts::TAU);
    let near = near_zero(l, x);
    // + 8 keeps the quadrant number positive; 8 ≡ 0 (mod 4).
    in_quadrant(l, l.truncate(quarter + l.real(8.0)), near)
}

/// (sin, cos) of an angle from those of what it exceeds so many right angles by.
#[inline(always)]
pub(super) fn in_quadrant<L: Lanes>(
    l: L,
    quadrant: L::Int,
    (s, c): (L::Real, L::Real),
) -> (L::Real, L::Real) {
    let quadrant = quadrant & l.int(3);
    let odd = (quadrant & l.int(1)).same(l.int(1));
    let sin_negative = (quadrant & l.int(2)).same(l.int(2));
    let cos_negative = (quadrant.plus(l.int(1)) & l.int(2)).same(l.int(2));
    let sine = l.select(odd, c, s);
    let cosine = l.select(odd, s, c);
    (
        l.select(sin_negative, -sine, sine),
        l.select(cos_negative, -cosine, cosine),
    )
}

/// Natural logarithm of positive normal numbers.
///
/// x = m·2ᵉ with m in [√½, √2); ln m = 2 artanh s, s = (m − 1)/(m + 1), |s| ≤ 0.1716.
/// Remainders relative to 2s: single s¹⁰/11 = 2e-9, double s²²/23 = 6e-19.
#[inline(always)]
pub fn ln<L: Lanes>(l: L, x: L::Real) -> L::Real {
    const ARTANH: [f64; 11] = over_odd(1.0);
    let one = l.real(1.0);
    let (m, e) = l.split_exponent(x);
    let large = m.gt(l.real(std::f64::consts::SQRT_2));
    let m = l.select(large, m * l.real(0.5), m);
    let e = l.select(large, e + one, e);
    let s = (m - one) / (m + one);
    let terms = if single::<L>() { 5 } else { 11 };
    let series = polynomial(l, s * s, &ARTANH[..terms]);
    e.mul_add(l.real(std::f64::consts::LN_2), (s + s) * series)
}

/// Inverse tangent of y/x in the right quadrant, in turns (−½, ½]; 0 for (0, 0).
///
/// The ratio of the smaller to the larger magnitude, a in [0, 1], is reduced by
/// arctan a = π/8 + arctan((a − t)/(1 + a t)), t = tan(π/8), to |z| ≤ t = 0.4142. Remainders of
/// the series: single t²⁰/21 = 1e-9, double t⁴²/43 = 2e-18.
#[inline(always)]
pub fn atan2_turns<L: Lanes>(l: L, y: L::Real, x: L::Real) -> L::Real {
    const TAN_PI_8: f64 = std::f64::consts::SQRT_2 - 1.0;
    let one = l.real(1.0);
    let zero = l.real(0.0);
    let (ax, ay) = (x.abs(), y.abs());
    let swap = ay.gt(ax);
    let (small, large) = (l.select(swap, ax, ay), l.select(swap, ay, ax));
    let t = l.real(TAN_PI_8);
    // arctan(a) − π/8 with a = small/large, in one division.
    let z = (small - t * large) / t.mul_add(small, large);
    let z = l.select(large.gt(zero), z, -t);
    let zz = z * z;
    let terms = if single::<L>() { 10 } else { 21 };
    let series = polynomial(l, zz, &ARCTAN[..terms]);
    let turns = (z * series).mul_add(l.real(1.0 / std::f64::consts::TAU), one * l.real(0.0625));
    let turns = l.select(swap, l.real(0.25) - turns, turns);
    let turns = l.select(x.lt(zero), l.real(0.5) - turns, turns);
    turns.copysign(y)
}
