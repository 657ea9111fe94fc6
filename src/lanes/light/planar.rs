//! Parallelograms and ellipses.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Emitting, Light, Plane, Towards, area_pdf, by_area, signed};
use crate::math::lanes::{Lanes, Scalar};
use crate::math::vec3::Vec3;
use crate::sample::warp::square_to_disk;
use crate::shape::Emitter;

/// Any parallelogram or ellipse: centre ± two half-axes, sampled by area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarLight<T> {
    plane: Plane<T>,
    /// An ellipse.
    round: bool,
    inverse_area: T,
    emits: [bool; 2],
}

impl<T: Scalar> PlanarLight<T> {
    /// From its centre and half-axes; `normal` is the unit normal of the front.
    pub fn new(
        centre: DVec3,
        half: [DVec3; 2],
        normal: DVec3,
        round: bool,
        emits: [bool; 2],
    ) -> Self {
        Self {
            plane: Plane::new(centre, half, normal),
            round,
            inverse_area: T::from_f64(1.0 / area(half, round)),
            emits,
        }
    }
}

fn area([a, b]: [DVec3; 2], round: bool) -> f64 {
    a.cross(b).length() * if round { PI } else { 4.0 }
}

impl<T: Scalar> Light<T> for PlanarLight<T> {
    const STRATEGY: &'static str = "by area";
    const FLAT: bool = true;

    fn of_shape(shape: &Emitting<'_>) -> Option<(Self, f64)> {
        if !matches!(shape.form, Emitter::Disk | Emitter::Rectangle) {
            return None;
        }
        let [a, b, _] = shape.to_world.columns();
        let round = shape.form == Emitter::Disk;
        let centre = shape.to_world.translation();
        let light = Self::new(centre, [a, b], shape.normal(2), round, shape.emits);
        Some((light, area([a, b], round)))
    }

    #[inline(always)]
    fn sample<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        [u, v]: [L::Real; 2],
    ) -> Towards<L> {
        let (x, y) = if self.round {
            square_to_disk(l, u, v)
        } else {
            (signed(l, u), signed(l, v))
        };
        let (to_centre, normal) = (self.plane.towards_centre(l, p), self.plane.normal(l));
        by_area(
            l,
            self.plane.towards(l, to_centre, [x, y]),
            normal,
            to_centre.dot(normal),
            l.splat(self.inverse_area),
            self.emits,
        )
    }

    #[inline(always)]
    fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        _: Vec3<L::Real>,
    ) -> L::Real {
        let normal = self.plane.normal(l);
        let height = self.plane.towards_centre(l, p).dot(normal);
        area_pdf(direction.dot(normal), height, l.splat(self.inverse_area))
    }
}
