//! Deliberate mistakes in the loop itself, to see whether the statistical suite notices them. They
//! are made in builds with the feature `planted` alone, which the renderer that ships does not have.

use crate::math::lanes::{Lanes, Real, Scalar};

/// What is done wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Planted {
    /// Direct light on a diffuse surface lacks the cosine.
    Cosine,
    /// Conductors count the perpendicular polarisation twice.
    Polarisation,
}

/// Whether a mistake is made.
#[inline(always)]
fn makes(planted: Option<Planted>, mistake: Planted) -> bool {
    cfg!(feature = "planted") && planted == Some(mistake)
}

/// The weight of sampled light at a surface that it meets under `cosine`.
#[inline(always)]
pub fn light_weight<L: Lanes>(
    l: L,
    planted: Option<Planted>,
    weight: L::Real,
    cosine: L::Real,
) -> L::Real {
    if makes(planted, Planted::Cosine) {
        // Along the surface the factor would have no bound.
        weight / cosine.max(l.real(0.01))
    } else {
        weight
    }
}

/// The reflectance for unpolarised light, from those of both polarisations.
#[inline(always)]
pub fn unpolarised<T: Scalar>(planted: Option<Planted>, [s, p]: [T; 2]) -> T {
    if makes(planted, Planted::Polarisation) {
        (s + s + p) * T::from_f64(1.0 / 3.0)
    } else {
        (s + p) * T::from_f64(0.5)
    }
}
