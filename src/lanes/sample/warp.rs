//! Maps of the unit square: sample and pdf in pairs.

use crate::math::functions::{sin_cos_eighth, sin_cos_turns};
use crate::math::lanes::{Lanes, Real};
use crate::math::vec3::Vec3;

/// The unit square to the unit disk, concentric (P. Shirley and K. Chiu 1997); density 1/π.
#[inline(always)]
pub fn square_to_disk<L: Lanes>(l: L, u: L::Real, v: L::Real) -> (L::Real, L::Real) {
    let two = l.real(2.0);
    let one = l.real(1.0);
    let a = two.mul_add(u, -one);
    let b = two.mul_add(v, -one);
    let x_major = a.abs().gt(b.abs());
    let (radius, other) = (l.select(x_major, a, b), l.select(x_major, b, a));
    let ratio = l.select(radius.same(l.real(0.0)), l.real(0.0), other / radius);
    // An eighth of a turn at ratio 1.
    let (s, c) = sin_cos_eighth(l, ratio * l.real(0.125));
    let (along, across) = (radius * c, radius * s);
    (
        l.select(x_major, along, across),
        l.select(x_major, across, along),
    )
}

/// A direction about +z with density cos θ/π (Malley's method: a disk lifted to the hemisphere).
/// The cosine is kept positive, so that no direction lies in the surface.
#[inline(always)]
pub fn cosine_hemisphere<L: Lanes>(l: L, u: L::Real, v: L::Real) -> Vec3<L::Real> {
    let (x, y) = square_to_disk(l, u, v);
    let squared = (-x).mul_add(x, (-y).mul_add(y, l.real(1.0)));
    // The smallest cos² that the rounding of 1 − x² − y² can tell from zero.
    let least = l.real(1.0 / (1u64 << L::UNIFORM_BITS) as f64);
    Vec3::new(x, y, squared.max(least).sqrt())
}

/// The density of [`cosine_hemisphere`]: cos θ/π, sr⁻¹.
#[inline(always)]
pub fn cosine_hemisphere_pdf<L: Lanes>(l: L, cosine: L::Real) -> L::Real {
    cosine * l.real(std::f64::consts::FRAC_1_PI)
}

/// The unit square to the unit sphere, density 1/(4π): z uniform (Archimedes).
#[inline(always)]
pub fn uniform_sphere<L: Lanes>(l: L, u: L::Real, v: L::Real) -> Vec3<L::Real> {
    let z = l.real(-2.0).mul_add(u, l.real(1.0));
    let radius = (-z).mul_add(z, l.real(1.0)).max(l.real(0.0)).sqrt();
    let (s, c) = sin_cos_turns(l, v);
    Vec3::new(radius * c, radius * s, z)
}
