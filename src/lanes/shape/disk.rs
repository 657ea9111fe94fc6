//! The disk z = 0, x² + y² ≤ 1.

use std::cmp::Ordering;

use glam::DVec3;

use super::flat::{self, Outline, flat_span};
use super::kind::{Canonical, Emitter, Question};
use super::lanes::part::{Part, PartKind};
use super::lanes::{self, LaneShape};
use super::line::{LocalRay, Span};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

/// z = 0, x² + y² ≤ 1.
pub struct Disk;

impl Canonical for Disk {
    const NAME: &'static str = "disk";
    const FLAT: bool = true;
    const EMITTER: Emitter = Emitter::Disk;
    const FACES: &'static [(usize, &'static [f64])] = flat::FACES;

    fn corners() -> Option<[DVec3; 2]> {
        Some([DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)])
    }

    fn half_range(along: DVec3) -> f64 {
        along.truncate().length()
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

impl Outline for Disk {
    /// The distance of (x, y) from its exact place is at most √2 of the margin, and 1½ pays for
    /// the arithmetic of the squares as well.
    #[inline(always)]
    fn contains<L: Lanes>(
        l: L,
        x: L::Real,
        y: L::Real,
        z: L::Real,
        margin: L::Real,
    ) -> (L::Mask, L::Mask) {
        let u = <L::Scalar as Scalar>::ROUNDOFF;
        let squared = x.mul_add(x, y * y);
        let margin = z.mul_add(l.real(4.0 * u), margin * l.real(1.5));
        let (low, high) = (z - margin, z + margin);
        let inside = low.gt(l.real(0.0)) & squared.lt(low * low);
        (inside, squared.gt(high * high))
    }
}

/// The point on z = 0 must have x² + y² ≤ 1.
fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    flat_span(ray, |crossing| {
        let t = crossing.fraction(ray)?;
        Some(ray.radial(2, &t).0.sign()? != Ordering::Greater)
    })
}
