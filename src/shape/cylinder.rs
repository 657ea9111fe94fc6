//! The capped cylinder x² + y² ≤ 1, |z| ≤ 1: a round side between two caps.

use std::cmp::Ordering;

use super::cube::{Slab, slab};
use super::line::{Crossing, Fraction, LocalRay, Span};
use crate::math::number::{Number, dot};

/// The line's stretch inside x² + y² ≤ 1, cut by its stretch inside |z| ≤ 1.
pub fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    let direction = &ray.direction[..2];
    let a = dot(direction, direction);
    if a.sign()? == Ordering::Equal {
        return along_axis(ray);
    }
    if ray.discriminant(2, &a).sign()? == Ordering::Less {
        return Some(None);
    }
    let mut span = Span {
        near: Crossing::round(2, false),
        far: Crossing::round(2, true),
    };
    let caps = match slab(ray, 2)? {
        Slab::Crossed(caps) => caps,
        Slab::Inside => return Some(Some(span)),
        Slab::Outside => return Some(None),
    };
    let enters = caps.near.fraction(ray)?;
    let leaves = caps.far.fraction(ray)?;
    if span.near.compare(ray, &leaves)? == Ordering::Greater
        || span.far.compare(ray, &enters)? == Ordering::Less
    {
        return Some(None);
    }
    if span.near.compare(ray, &enters)? == Ordering::Less {
        span.near = caps.near;
    }
    if span.far.compare(ray, &leaves)? == Ordering::Greater {
        span.far = caps.far;
    }
    Some(Some(span))
}

/// A line parallel to the axis meets the caps or nothing.
fn along_axis<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    let start = Fraction::whole(N::of(0.0));
    if ray.radial(2, &start).0.sign()? == Ordering::Greater {
        return Some(None);
    }
    Some(match slab(ray, 2)? {
        Slab::Crossed(caps) => Some(caps),
        Slab::Inside | Slab::Outside => None,
    })
}
