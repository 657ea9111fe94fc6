//! Isotropic point lights.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Light, Towards, WithoutSurface, scalars, vector};
use crate::declare::{Declaration, Parameter, Quantity, Role};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;

/// A point that sends the same radiant intensity I in all directions: irradiance I cos/d².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLight<T>(pub [T; 3]);

impl<T: Scalar> WithoutSurface<T> for PointLight<T> {
    const DECLARATION: Declaration =
        Declaration::new("point", "position", Quantity::Point).beside(&[Parameter::new(
            "intensity",
            "spectrum, W·sr⁻¹·nm⁻¹",
            Quantity::Spectrum(Role::Emission),
        )]);
    const POWER: fn(f64) -> f64 = |_| 4.0 * PI;

    fn new(place: DVec3) -> Self {
        Self(scalars(place))
    }
}

impl<T: Scalar> Light<T> for PointLight<T> {
    const NAME: &'static str = "point light";
    const STRATEGY: &'static str = "by its one direction";

    #[inline(always)]
    fn sample<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>, _u: [L::Real; 2]) -> Towards<L> {
        let to = vector(l, &self.0) - p;
        let squared = to.length_squared();
        let distance = squared.sqrt();
        Towards {
            direction: to.scale(l.real(1.0) / distance),
            distance,
            pdf: squared,
            valid: squared.gt(l.real(0.0)),
        }
    }
}
