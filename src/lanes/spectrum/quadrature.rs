//! Integrals over wavelength, piece by piece between kinks.

use super::Spectrum;

/// Integral of `f` over [a, b] by Gauss and Legendre's two-point rule, which is exact for
/// polynomials up to degree 3 — the product of two linear pieces has degree 2 — and looks only
/// at inner points, so jumps at the ends do no harm.
pub fn gauss<const N: usize>(a: f64, b: f64, f: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    // 1/√3 (Abramowitz & Stegun 1964, table 25.4).
    const NODE: f64 = 0.577_350_269_189_625_8;
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let (left, right) = (f(middle - half * NODE), f(middle + half * NODE));
    std::array::from_fn(|i| half * (left[i] + right[i]))
}

/// Integral of `f` over [a, b] in pieces that end at the kinks of `spectrum`.
pub fn between_kinks<const N: usize>(
    spectrum: &Spectrum,
    a: f64,
    b: f64,
    f: impl Fn(f64) -> [f64; N],
) -> [f64; N] {
    let mut sum = [0.0; N];
    let mut from = a;
    for to in spectrum.kinks_between(a, b).iter().copied().chain([b]) {
        let piece = gauss(from, to, &f);
        for (total, part) in sum.iter_mut().zip(piece) {
            *total += part;
        }
        from = to;
    }
    sum
}
