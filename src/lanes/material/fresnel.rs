//! Fresnel reflectance of smooth interfaces for unpolarised light.

use crate::math::lanes::{Lanes, Real, Scalar};

/// Cosine of the refracted ray and reflectance at a dielectric interface, for incidence cosine
/// `cosine` ≥ 0 and `eta` = n_transmitted/n_incident; reflectance 1 and cosine 0 where all light
/// is reflected (Born and Wolf, Principles of Optics, 1.5).
#[inline(always)]
pub fn dielectric<L: Lanes>(l: L, cosine: L::Real, eta: L::Real) -> (L::Real, L::Real) {
    let one = l.real(1.0);
    let zero = l.real(0.0);
    // η² cos²θₜ = η² − sin²θᵢ = (η − 1)(η + 1) + cos²θᵢ: no digits are lost at grazing incidence,
    // and equal media reflect nothing.
    let squared = (eta - one).mul_add(eta + one, cosine * cosine);
    let total = !squared.gt(zero);
    let transmitted = squared.max(zero).sqrt() / eta;
    let s = (-eta).mul_add(transmitted, cosine) / eta.mul_add(transmitted, cosine);
    let p = eta.mul_add(cosine, -transmitted) / eta.mul_add(cosine, transmitted);
    let reflectance = s.mul_add(s, p * p) * l.real(0.5);
    (
        l.select(total, zero, transmitted),
        l.select(total, one, reflectance),
    )
}

/// Reflectance of a conductor with ior n + ik in vacuum, for incidence cosine `cosine` ≥ 0
/// (Born and Wolf 14.4.1; the arrangement without complex numbers is that of S. Lagarde, "Memo
/// on Fresnel equations", 2013).
#[inline(always)]
pub fn conductor<T: Scalar>(cosine: T, n: T, k: T) -> T {
    let [s, p] = conductor_polarised(cosine, n, k);
    (s + p) * T::from_f64(0.5)
}

/// The same for light polarised perpendicularly and parallel to the plane of incidence.
#[inline(always)]
pub fn conductor_polarised<T: Scalar>(cosine: T, n: T, k: T) -> [T; 2] {
    let number = T::from_f64;
    let one = number(1.0);
    let c2 = cosine * cosine;
    let s2 = (one - cosine) * (one + cosine);
    let (n2, k2) = (n * n, k * k);
    let t0 = n2 - k2 - s2;
    // |√(η² − s²)|² = a² + b²
    let sum = t0.fused(t0, number(4.0) * n2 * k2).root();
    let a = ((sum + t0) * number(0.5)).larger(T::default()).root();
    let t1 = sum + c2;
    let t2 = number(2.0) * a * cosine;
    let s = (t1 - t2) / (t1 + t2);
    let t3 = c2.fused(sum, s2 * s2);
    let t4 = t2 * s2;
    let p = s * ((t3 - t4) / (t3 + t4));
    [s, p]
}

/// Reflectance at a dielectric interface for one value, as [`dielectric`].
#[inline(always)]
pub fn dielectric_reflectance<T: Scalar>(cosine: T, eta: T) -> T {
    let one = T::from_f64(1.0);
    let zero = T::default();
    let squared = (eta - one).fused(eta + one, cosine * cosine);
    let transmitted = squared.larger(zero).root() / eta;
    let s = (cosine - eta * transmitted) / (cosine + eta * transmitted);
    let p = (eta * cosine - transmitted) / (eta * cosine + transmitted);
    let reflectance = (s * s + p * p) * T::from_f64(0.5);
    if squared > zero { reflectance } else { one }
}
