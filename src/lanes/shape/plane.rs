//! The plane z = 0.

use glam::{DVec2, DVec3};

use super::flat::{self, Outline, flat_span};
use super::kind::{Canonical, Emitter, Question};
use super::lanes::part::{Part, PartKind};
use super::lanes::{self, LaneShape};
use super::line::{LocalRay, Span};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

/// z = 0.
pub struct Plane;

impl Canonical for Plane {
    const NAME: &'static str = "plane";
    const FLAT: bool = true;
    const EMITTER: Emitter = Emitter::Unsampled;
    const FACES: &'static [(usize, &'static [f64])] = flat::FACES;

    fn corners() -> Option<[DVec3; 2]> {
        None
    }

    fn half_range(along: DVec3) -> f64 {
        if along.truncate() == DVec2::ZERO {
            0.0
        } else {
            f64::INFINITY
        }
    }

    fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
        span(ray)
    }

    #[inline(always)]
    fn lane_span<L: Lanes>(l: L, question: &Question<'_, L>) -> lanes::Span<L> {
        flat::lane_span::<L, Self>(l, question)
    }

    fn parts<T: Scalar>(shape: &LaneShape<T>) -> Vec<Part<T>> {
        vec![shape.plane(2, PartKind::Plane)]
    }

    #[inline(always)]
    fn snapped<L: Lanes>(l: L, local: Vec3<L::Real>) -> Vec3<L::Real> {
        flat::snapped(l, local)
    }
}

impl Outline for Plane {
    #[inline(always)]
    fn contains<L: Lanes>(
        l: L,
        _x: L::Real,
        _y: L::Real,
        z: L::Real,
        margin: L::Real,
    ) -> (L::Mask, L::Mask) {
        (z.gt(margin), l.mask(false))
    }
}

/// Every line that is not parallel to the plane meets it.
fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    flat_span(ray, |_| Some(true))
}
