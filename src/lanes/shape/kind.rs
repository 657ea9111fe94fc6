//! The contract of canonical shapes, and their list.

use glam::DVec3;

use super::lanes::part::Part;
use super::lanes::{LaneRay, LaneShape, LaneSpan, LaneSurface};
use super::line::{LocalRay, Span};
use crate::math::lanes::{Lanes, Scalar};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

/// How points are sampled on a shape that emits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Emitter {
    /// Not at all: scattered rays alone find the light.
    Unsampled,
    Disk,
    Rectangle,
    Sphere,
    Cube,
    Cylinder,
}

/// A length that scene files may give a shape: scene units, greater than 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Length {
    pub key: &'static str,
    /// The canonical axes that it stretches.
    pub axes: &'static [usize],
    /// Whether it is an array with a number for each of these axes.
    pub each: bool,
    /// Half the extent over the length: 1 for a radius, ½ for an edge.
    pub share: f64,
    /// The value where the key is left out; `None` for a key that replaces an earlier one.
    pub default: Option<f64>,
}

impl Length {
    /// A radius about the other axes, usually 1.
    pub const fn radius(axes: &'static [usize]) -> Self {
        Self {
            key: "radius",
            axes,
            each: false,
            share: 1.0,
            default: Some(1.0),
        }
    }

    /// An edge, usually 2.
    pub const fn edge(key: &'static str, axes: &'static [usize]) -> Self {
        Self {
            key,
            axes,
            each: false,
            share: 0.5,
            default: Some(2.0),
        }
    }
}

/// Rays in lanes that are tested against a shape.
#[derive(Clone, Copy)]
pub struct LaneQuestion<'a, L: Lanes> {
    pub shape: &'a LaneShape<L::Scalar>,
    pub ray: &'a LaneRay<L>,
    /// Lanes whose answer counts.
    pub asked: L::Mask,
    /// A shape of which all lies beyond this may be called missed.
    pub limit: L::Real,
}

/// A closed set in canonical coordinates. Touching counts.
pub trait Canonical {
    const NAME: &'static str;
    const LENGTHS: &'static [Length] = &[];
    /// Whether scene files may say where its centre is, by the key `center`.
    const CENTERED: bool = false;
    /// Whether it is a piece of the plane z = 0, with +z as its front; else it is the surface of a body.
    const FLAT: bool = false;
    /// Whether a ray that leaves it outward never meets it again, so that it need not be tested.
    const CONVEX: bool = true;
    const EMITTER: Emitter = Emitter::Unsampled;
    /// Its parallel faces, as (canonical axis, places on it).
    const FACES: &'static [(usize, &'static [f64])] = &[];
    /// The number of coordinates in Σx² = 1, for a round wall.
    const ROUND: Option<usize> = None;

    /// Opposite corners of its box; `None` where it has no end.
    fn corners() -> Option<[DVec3; 2]> {
        Some([-DVec3::ONE, DVec3::ONE])
    }

    /// Half the range of a · p over the shape, for a = `along`; the middle of the range is 0.
    fn half_range(along: DVec3) -> f64;

    /// Where the line enters and leaves it: `None` where this kind of number cannot tell.
    fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>>;

    /// [`Self::span`] in lanes, with error bounds; lanes that these cannot decide are taken to the
    /// ladder. Meaningless in lanes that are not asked.
    fn lane_span<L: Lanes>(l: L, question: &LaneQuestion<'_, L>) -> LaneSpan<L>;

    /// The parts, in the order in which [`LaneSpan`] numbers them.
    fn parts<T: Scalar>(_shape: &LaneShape<T>) -> Vec<Part<T>> {
        vec![Part::other()]
    }

    /// Number of the part that a point in canonical coordinates is on.
    fn part(_local: DVec3) -> u32 {
        0
    }

    /// The surface at a hit near the world point p, for parts of the kind
    /// [`PartKind::Other`](super::lanes::part::PartKind::Other).
    #[inline(always)]
    fn surface<L: Lanes>(_l: L, _shape: &LaneShape<L::Scalar>, p: Vec3<L::Real>) -> LaneSurface<L> {
        LaneSurface {
            point: p,
            normal: p,
        }
    }

    /// Canonical coordinates of a point on the surface, those that are constant on a face made
    /// exact, so that textures do not flicker between cells there.
    #[inline(always)]
    fn snapped<L: Lanes>(_l: L, local: Vec3<L::Real>) -> Vec3<L::Real> {
        local
    }
}

kinds! {
    ShapeKind of Canonical {
        Sphere in sphere,
        Cube in cube,
        Cylinder in cylinder,
        Disk in disk,
        Rectangle in rectangle,
        Plane in plane,
    }
    fn name(self) -> &'static str = NAME;
    fn lengths(self) -> &'static [Length] = LENGTHS;
    fn is_centered(self) -> bool = CENTERED;
    fn is_flat(self) -> bool = FLAT;
    fn is_convex(self) -> bool = CONVEX;
    fn emitter(self) -> Emitter = EMITTER;
    fn faces(self) -> &'static [(usize, &'static [f64])] = FACES;
    fn round(self) -> Option<usize> = ROUND;
}

impl ShapeKind {
    pub fn corners(self) -> Option<[DVec3; 2]> {
        of!(self, corners())
    }

    pub fn half_range(self, along: DVec3) -> f64 {
        of!(self, half_range(along))
    }

    pub fn span<N: Number>(self, ray: &LocalRay<N>) -> Option<Option<Span>> {
        of!(self, span(ray))
    }

    pub fn part(self, local: DVec3) -> u32 {
        of!(self, part(local))
    }
}

/// The methods of a placed shape that its kind answers. Implicit surfaces are intersected elsewhere:
/// their lines miss, and their one part is [`Part::other`].
impl<T: Scalar> LaneShape<T> {
    #[inline(always)]
    pub fn span<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        ray: &LaneRay<L>,
        asked: L::Mask,
        limit: L::Real,
    ) -> LaneSpan<L> {
        let Some(kind) = self.kind else {
            return LaneSpan::missed(l);
        };
        let question = LaneQuestion {
            shape: self,
            ray,
            asked,
            limit,
        };
        of!(kind, lane_span(l, &question))
    }

    /// [`Self::span`] by a call: one copy of its code for all callers that test single objects.
    #[inline(never)]
    pub fn span_by_call<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        ray: &LaneRay<L>,
        asked: L::Mask,
        limit: L::Real,
    ) -> LaneSpan<L> {
        l.vectorize(inlined!(|| self.span(l, ray, asked, limit)))
    }

    pub fn parts(&self) -> Vec<Part<T>> {
        match self.kind {
            Some(kind) => of!(kind, parts(self)),
            None => vec![Part::other()],
        }
    }

    #[inline(always)]
    pub fn surface<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        kind: ShapeKind,
        p: Vec3<L::Real>,
    ) -> LaneSurface<L> {
        of!(kind, surface(l, self, p))
    }

    /// [`Canonical::snapped`] of a world point.
    #[inline(always)]
    pub fn local<L: Lanes<Scalar = T>>(&self, l: L, point: Vec3<L::Real>) -> Vec3<L::Real> {
        let local = self.inverse.point(l, point);
        match self.kind {
            Some(kind) => of!(kind, snapped(l, local)),
            None => local,
        }
    }
}
