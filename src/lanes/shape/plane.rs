//! The plane z = 0.

use glam::{DVec2, DVec3};

use super::flat::Flat;
use super::kind::Emitter;
use super::line::{Fraction, LocalRay};
use crate::math::lanes::{Lanes, Real};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

pub struct Plane;

impl Flat for Plane {
    const NAME: &'static str = "plane";
    const EMITTER: Emitter = Emitter::Unsampled;

    fn corners() -> Option<[DVec3; 2]> {
        None
    }

    fn half_range(along: DVec2) -> f64 {
        if along == DVec2::ZERO {
            0.0
        } else {
            f64::INFINITY
        }
    }

    fn covers<N: Number>(_ray: &LocalRay<N>, _t: &Fraction<N>) -> Option<bool> {
        Some(true)
    }

    #[inline(always)]
    fn contains<L: Lanes>(l: L, at: Vec3<L::Real>, margin: L::Real) -> (L::Mask, L::Mask) {
        (at.z.gt(margin), l.mask(false))
    }
}
