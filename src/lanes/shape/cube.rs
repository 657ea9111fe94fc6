//! The cube [-1, 1]³: three slabs.

use std::cmp::Ordering;

use super::line::{Crossing, Fraction, LocalRay, Span};
use crate::math::number::Number;

/// Where the line enters and leaves the slab |coordinate| ≤ 1.
pub enum Slab {
    /// Crosses both faces.
    Crossed(Span),
    /// Parallel to the faces and between them (or in one).
    Inside,
    /// Parallel to the faces and outside.
    Outside,
}

/// The slab of this axis.
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
    let enters = faces.near.fraction(ray)?;
    let leaves = faces.far.fraction(ray)?;
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

/// The last entry must not come after the first exit.
pub fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    let mut span: Option<Span> = None;
    for axis in 0..3 {
        let next = match slab(ray, axis)? {
            Slab::Crossed(next) => next,
            Slab::Inside => continue,
            Slab::Outside => return Some(None),
        };
        span = match span {
            None => Some(next),
            Some(current) => match cut(ray, current, &next)? {
                None => return Some(None),
                shorter => shorter,
            },
        };
    }
    Some(span)
}
