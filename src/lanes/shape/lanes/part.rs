//! The parts of shapes: pieces of surface of which a few numbers say all.

use super::LaneSurface;
use crate::math::lanes::{Lanes, Mask, Real, Scalar};
use crate::math::vec3::Vec3;

/// How the numbers of a part are to be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartKind {
    /// A plane: normal and height.
    Plane,
    /// Two parallel faces: normal, height of the middle, half their distance.
    Faces,
    /// A ball: centre and radius.
    Ball,
    /// Something that only its own file knows.
    Other,
}

#[derive(Debug, Clone, Copy)]
pub struct Part<T> {
    pub kind: PartKind,
    /// Unit normal (outward, or +z of flat shapes), or the centre.
    pub vector: [T; 3],
    /// Height along the normal, or the radius.
    pub level: T,
    /// Half the distance of the two faces, else 0.
    pub half: T,
}

impl<T: Scalar> Part<T> {
    /// The faces x = ±1 of the canonical coordinate that a row of the inverse computes.
    pub fn faces(row: &[f64; 4]) -> Self {
        let [x, y, z, shift] = *row;
        let length = (x * x + y * y + z * z).sqrt();
        Self {
            kind: PartKind::Faces,
            vector: [x, y, z].map(|c| T::from_f64(c / length)),
            level: T::from_f64(-shift / length),
            half: T::from_f64(1.0 / length),
        }
    }

    pub fn other() -> Self {
        let zero = T::default();
        Self {
            kind: PartKind::Other,
            vector: [zero; 3],
            level: zero,
            half: zero,
        }
    }
}

#[derive(Clone, Copy)]
pub struct Outline<L: Lanes> {
    /// Unit normals, or centres.
    pub vector: Vec3<L::Real>,
    /// Heights, or radii.
    pub level: L::Real,
    /// Half the distances of pairs of faces, else 0.
    pub half: L::Real,
    pub faces: L::Mask,
    pub balls: L::Mask,
}

impl<L: Lanes> Outline<L> {
    /// The points p moved onto the surfaces, and the unit outward normals there; what is asked of
    /// lanes whose part is [`PartKind::Other`] means nothing.
    #[inline(always)]
    pub fn surface(&self, l: L, p: Vec3<L::Real>) -> LaneSurface<L> {
        let mut normal = self.vector;
        let mut level = self.level;
        if self.faces.any() {
            // The face on p's side of the middle; a sign is 1 or −1, so nothing is rounded twice.
            let side = l.real(1.0).copysign(normal.dot(p) - level);
            let sign = l.select(self.faces, side, l.real(1.0));
            normal = normal.scale(sign);
            level = level.mul_add(sign, self.half);
        }
        // The foot of p on the plane.
        let mut point = p.along(normal, level - normal.dot(p));
        if self.balls.any() {
            let outward = (p - self.vector).normalized(l);
            let on = self.vector.along(outward, self.level);
            normal = Vec3::select(l, self.balls, outward, normal);
            point = Vec3::select(l, self.balls, on, point);
        }
        LaneSurface { point, normal }
    }
}
