//! Parallel light from infinity.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Light, Towards, WithoutSurface, scalars, vector};
use crate::declare::{Declaration, Parameter, Quantity, Role};
use crate::math::lanes::{Lanes, Scalar};
use crate::math::vec3::Vec3;

/// The direction towards the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionalLight<T>(pub [T; 3]);

impl<T: Scalar> WithoutSurface<T> for DirectionalLight<T> {
    const DECLARATION: Declaration = Declaration::new(
        "direction",
        "direction in which the light travels",
        Quantity::Direction,
    )
    .beside(&[Parameter::new(
        "irradiance",
        "spectrum, W·m⁻²·nm⁻¹ on a surface that faces the light",
        Quantity::Spectrum(Role::Emission),
    )]);
    const POWER: fn(f64) -> f64 = |area| PI * area;

    fn new(place: DVec3) -> Self {
        Self(scalars(place))
    }
}

impl<T: Scalar> Light<T> for DirectionalLight<T> {
    const NAME: &'static str = "directional light";
    const STRATEGY: &'static str = "by its one direction";

    #[inline(always)]
    fn sample<L: Lanes<Scalar = T>>(&self, l: L, _: Vec3<L::Real>, _u: [L::Real; 2]) -> Towards<L> {
        Towards {
            direction: vector(l, &self.0),
            distance: l.real(f64::INFINITY),
            pdf: l.real(1.0),
            valid: l.mask(true),
        }
    }
}
