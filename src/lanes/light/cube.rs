//! Parallelepipeds: cubes under any affine map.

use glam::DVec3;

use super::{Emitting, Light, Plane, Towards, area_pdf, by_area, signed, vector};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;
use crate::shape::Emitter;

/// Any parallelepiped, as six parallelograms; a point is chosen by area on those that face the receiver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeLight<T> {
    faces: [Face<T>; 6],
    /// How far from a face's plane a receiver may be and still count as on it.
    margin: T,
    emits: [bool; 2],
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Face<T> {
    plane: Plane<T>,
    area: T,
}

impl<T: Scalar> CubeLight<T> {
    /// From the centre, the three half-edges and the unit outward normals of the faces towards
    /// them.
    ///
    /// The inner walls of a cube that emits inward receive its light; points *on* them must count as
    /// inside. With unit roundoff u they are off by at most 4u (|c| + 4 (|a| + |b| + |c|)), as those of
    /// a sphere with the sum of the half-edges as radius; doubled for the height's own rounding.
    pub fn new(centre: DVec3, half: [DVec3; 3], normals: [DVec3; 3], emits: [bool; 2]) -> Self {
        let face = |i: usize| {
            let axis = i / 2;
            let sign = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
            let (a, b) = (half[(axis + 1) % 3], half[(axis + 2) % 3]);
            Face {
                plane: Plane::new(centre + sign * half[axis], [a, b], sign * normals[axis]),
                area: T::from_f64(4.0 * a.cross(b).length()),
            }
        };
        let extent: f64 = half.iter().map(|h| h.length()).sum();
        let margin = if emits[1] {
            8.0 * T::ROUNDOFF * (centre.length() + 4.0 * extent)
        } else {
            0.0
        };
        Self {
            margin: T::from_f64(margin),
            faces: std::array::from_fn(face),
            emits,
        }
    }

    /// Areas of the faces that a point could be lit by: from outside those that face it, from
    /// inside all but the one that it lies on, if that side emits; with their sum.
    #[inline(always)]
    fn visible<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> ([L::Real; 6], L::Real) {
        let zero = l.real(0.0);
        let margin = l.splat(self.margin);
        let mut heights = [zero; 6];
        let mut outside = l.mask(false);
        for (height, face) in heights.iter_mut().zip(&self.faces) {
            *height = (p - vector(l, &face.plane.centre)).dot(face.plane.normal(l));
            outside = outside | height.gt(margin);
        }
        let mut areas = [zero; 6];
        let mut total = zero;
        for ((area, face), height) in areas.iter_mut().zip(&self.faces).zip(heights) {
            let front = outside & height.gt(zero) & l.mask(self.emits[0]);
            let back = !outside & height.lt(-margin) & l.mask(self.emits[1]);
            let lit = front | back;
            *area = l.select(lit, l.splat(face.area), zero);
            total = total + *area;
        }
        (areas, total)
    }
}

impl<T: Scalar> Light<T> for CubeLight<T> {
    const STRATEGY: &'static str = "by the area of its visible faces";

    fn of_shape(shape: &Emitting<'_>) -> Option<(Self, f64)> {
        if shape.form != Emitter::Cube {
            return None;
        }
        let half @ [a, b, c] = shape.to_world.columns();
        let normals = [0, 1, 2].map(|axis| shape.normal(axis));
        let light = Self::new(shape.to_world.translation(), half, normals, shape.emits);
        let area = 8.0 * (a.cross(b).length() + b.cross(c).length() + c.cross(a).length());
        Some((light, area))
    }

    #[inline(never)]
    fn sample<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        [u, v]: [L::Real; 2],
    ) -> Towards<L> {
        l.vectorize(inlined!(|| {
            let (areas, total) = self.visible(l, p);
            let (zero, one) = (l.real(0.0), l.real(1.0));
            let target = u * total;
            let mut below = zero;
            let mut to = Vec3::new(zero, zero, one);
            let mut normal = to;
            let mut height = zero;
            for (face, area) in self.faces.iter().zip(areas) {
                // The last face with area whose share begins at or below the target wins.
                let here = target.ge(below) & area.gt(zero);
                let share = (target - below) / area;
                let x = signed(l, share.max(zero).min(one));
                let to_face = face.plane.towards_centre(l, p);
                let face_normal = face.plane.normal(l);
                let point = face.plane.towards(l, to_face, [x, signed(l, v)]);
                to = Vec3::select(l, here, point, to);
                normal = Vec3::select(l, here, face_normal, normal);
                height = l.select(here, to_face.dot(face_normal), height);
                below = below + area;
            }
            let mut towards = by_area(l, to, normal, height, one / total, [true, true]);
            towards.valid = towards.valid & total.gt(zero);
            towards
        }))
    }

    /// 0 for faces that sampling leaves to scattered rays.
    #[inline(never)]
    fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        normal: Vec3<L::Real>,
    ) -> L::Real {
        l.vectorize(inlined!(|| {
            let (areas, total) = self.visible(l, p);
            // The face that was met is the one whose normal is the hit's, up to rounding.
            let zero = l.real(0.0);
            let (mut likeness, mut height, mut cosine) = (-l.real(2.0), zero, zero);
            let mut lit = zero;
            for (face, area) in self.faces.iter().zip(areas) {
                let face_normal = face.plane.normal(l);
                let like = face_normal.dot(normal);
                let here = like.gt(likeness);
                let to_face = face.plane.towards_centre(l, p);
                likeness = l.select(here, like, likeness);
                height = l.select(here, to_face.dot(face_normal), height);
                cosine = l.select(here, direction.dot(face_normal), cosine);
                lit = l.select(here, area, lit);
            }
            let pdf = area_pdf(cosine, height, l.real(1.0) / total);
            l.select(lit.gt(zero), pdf, zero)
        }))
    }
}
