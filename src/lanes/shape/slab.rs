//! The slab |coordinate| ≤ 1 that cubes and cylinders are cut from, exactly and in lanes.

use std::cmp::Ordering;

use super::lanes::{Enclosure, LaneRay, LaneShape};
use super::line::{Crossing, Fraction, LocalRay, Span};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

/// Where the line enters and leaves the slab |coordinate| ≤ 1.
pub enum Slab {
    Crossed(Span),
    /// Parallel to the faces and between them (or in one).
    Inside,
    /// Parallel to the faces and outside.
    Outside,
}

pub fn slab<N: Number>(ray: &LocalRay<N>, axis: usize) -> Option<Slab> {
    let upward = match ray.direction[axis].sign()? {
        Ordering::Greater => true,
        Ordering::Less => false,
        Ordering::Equal => {
            let start = Fraction::whole(N::of(0.0));
            return Some(match ray.within(axis, &start)? {
                true => Slab::Inside,
                false => Slab::Outside,
            });
        }
    };
    Some(Slab::Crossed(Span {
        near: Crossing::face(axis, !upward, false),
        far: Crossing::face(axis, upward, true),
    }))
}

/// The part of a span that lies between the faces of a slab, if any.
pub fn cut<N: Number>(ray: &LocalRay<N>, mut span: Span, faces: &Span) -> Option<Option<Span>> {
    let enters = faces.near.fraction(ray).ok()?;
    let leaves = faces.far.fraction(ray).ok()?;
    if span.near.compare(ray, &leaves)? == Ordering::Greater
        || span.far.compare(ray, &enters)? == Ordering::Less
    {
        return Some(None);
    }
    if span.near.compare(ray, &enters)? == Ordering::Less {
        span.near = faces.near;
    }
    if span.far.compare(ray, &leaves)? == Ordering::Greater {
        span.far = faces.far;
    }
    Some(Some(span))
}

/// Crossings of one slab |x| ≤ 1 of the local ray, with bounds.
#[derive(Clone, Copy)]
pub struct LaneSlab<L: Lanes> {
    /// The lines' coordinate is `origin` + t `direction`.
    pub origin: L::Real,
    pub direction: L::Real,
    /// Bounds of the errors of both numbers.
    origin_error: L::Real,
    direction_error: L::Real,
    pub near: Enclosure<L>,
    pub far: Enclosure<L>,
    /// Lanes that may run along the slab, for which near and far mean nothing.
    pub parallel: L::Mask,
}

impl<L: Lanes> LaneSlab<L> {
    /// Intersects the slab of coordinate `i`, whose local origins and directions are given.
    #[inline(always)]
    pub fn new(
        l: L,
        shape: &LaneShape<L::Scalar>,
        ray: &LaneRay<L>,
        i: usize,
        (o, d): (L::Real, L::Real),
    ) -> Self {
        let e = shape.origin_error(l, ray, i);
        let dd = l.splat(shape.direction_error[i]);
        let one = l.real(1.0);
        let inverse = one / d;
        let t1 = (-one - o) * inverse;
        let t2 = (one - o) * inverse;
        let largest = t1.abs().max(t2.abs());
        // First order (e + |t| dd)/|d|, doubled for the rest while dd ≤ |d|/4; 5u for the arithmetic
        // up to the rounded ends: ±1 − o, 1/d, their product and t ∓ error are each off by u, the fifth
        // pays for the evaluation of the error.
        let error = (largest.mul_add(dd, e) * inverse.abs()).mul_add(
            l.real(2.0),
            largest * l.real(5.0 * <L::Scalar as Scalar>::ROUNDOFF),
        );
        Self {
            origin: o,
            direction: d,
            origin_error: e,
            direction_error: dd,
            near: Enclosure::about(t1.min(t2), error),
            far: Enclosure::about(t1.max(t2), error),
            parallel: !d.abs().gt(dd * l.real(4.0)),
        }
    }

    /// Decides the parallel lanes by position, for all |t| ≤ `reach`, within which the line could hit
    /// anything else of the shape; inside, the slab is no limit to them. Returns the lanes for which
    /// position says nothing either, and those outside.
    #[inline(always)]
    pub fn settle(&mut self, l: L, reach: L::Real) -> (L::Mask, L::Mask) {
        let one = l.real(1.0);
        // The share beyond 1 pays for the rounding of drift and of o ± drift, many times over.
        let drift = (self.direction.abs() + self.direction_error).mul_add(reach, self.origin_error)
            * l.real(1.0 + 1e-6);
        let o = self.origin.abs();
        let inside = self.parallel & (o + drift).lt(one);
        let outside = self.parallel & (o - drift).gt(one);
        let far = l.real(f64::INFINITY);
        self.near = self.near.replaced(l, self.parallel, -far);
        self.far = self.far.replaced(l, self.parallel, far);
        (self.parallel & !inside & !outside, outside)
    }
}

/// Farthest |t| at which the line can be inside the canonical box: (|o|₁ + E + 1)/max(|dᵢ| − Dᵢ),
/// infinite where the direction could be zero for all that is known; 3 for 1 pays for rounding.
#[inline(always)]
pub fn reach<L: Lanes>(
    l: L,
    shape: &LaneShape<L::Scalar>,
    ray: &LaneRay<L>,
    o: Vec3<L::Real>,
    d: Vec3<L::Real>,
) -> L::Real {
    let (e, _) = shape.largest_errors(l, ray, 3);
    let sum = o.x.abs() + o.y.abs() + o.z.abs();
    let [dx, dy, dz] = shape.direction_error.map(inlined!(|error| l.splat(error)));
    let slowest = (d.x.abs() - dx).max(d.y.abs() - dy).max(d.z.abs() - dz);
    (sum + (e + l.real(3.0))) / slowest.max(l.real(0.0))
}
