//! The rectangle z = 0, |x| ≤ 1, |y| ≤ 1.

use glam::DVec3;

use super::flat::{self, Outline, flat_span};
use super::kind::{Canonical, Emitter, Question};
use super::lanes::part::{Part, PartKind};
use super::lanes::{self, LaneShape};
use super::line::{LocalRay, Span};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

/// z = 0, |x| ≤ 1, |y| ≤ 1.
pub struct Rectangle;

impl Canonical for Rectangle {
    const NAME: &'static str = "rectangle";
    const FLAT: bool = true;
    const EMITTER: Emitter = Emitter::Rectangle;
    const FACES: &'static [(usize, &'static [f64])] = flat::FACES;

    fn corners() -> Option<[DVec3; 2]> {
        Some([DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)])
    }

    fn half_range(along: DVec3) -> f64 {
        along.truncate().abs().element_sum()
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

impl Outline for Rectangle {
    #[inline(always)]
    fn contains<L: Lanes>(
        _l: L,
        x: L::Real,
        y: L::Real,
        z: L::Real,
        margin: L::Real,
    ) -> (L::Mask, L::Mask) {
        let depth = z - x.abs().max(y.abs());
        (depth.gt(margin), depth.lt(-margin))
    }
}

/// The point on z = 0 must have |x| ≤ 1 and |y| ≤ 1.
fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    flat_span(ray, |crossing| {
        let t = crossing.fraction(ray)?;
        match (ray.within(0, &t), ray.within(1, &t)) {
            (Some(false), _) | (_, Some(false)) => Some(false),
            (x, y) => x.and(y),
        }
    })
}
