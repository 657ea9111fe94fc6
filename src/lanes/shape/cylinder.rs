//! The capped cylinder x² + y² ≤ 1, |z| ≤ 1: a round side between two caps.

use std::cmp::Ordering;

use super::cube::{Slab, cut, slab};
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
    let side = Span {
        near: Crossing::round(2, false),
        far: Crossing::round(2, true),
    };
    match slab(ray, 2)? {
        Slab::Crossed(caps) => cut(ray, side, &caps),
        Slab::Inside => Some(Some(side)),
        Slab::Outside => Some(None),
    }
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
