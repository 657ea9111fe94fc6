//! The cube [-1, 1]³: three slabs.

use std::cmp::Ordering;

use super::line::{Crossing, LocalRay, Span};
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
            let start = super::line::Fraction::whole(N::of(0.0));
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

/// The last entry must not come after the first exit.
pub fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    let mut span: Option<Span> = None;
    for axis in 0..3 {
        let next = match slab(ray, axis)? {
            Slab::Crossed(next) => next,
            Slab::Inside => continue,
            Slab::Outside => return Some(None),
        };
        let Some(current) = &mut span else {
            span = Some(next);
            continue;
        };
        let enters = next.near.fraction(ray)?;
        let leaves = next.far.fraction(ray)?;
        if current.near.compare(ray, &leaves)? == Ordering::Greater
            || current.far.compare(ray, &enters)? == Ordering::Less
        {
            return Some(None);
        }
        if current.near.compare(ray, &enters)? == Ordering::Less {
            current.near = next.near;
        }
        if current.far.compare(ray, &leaves)? == Ordering::Greater {
            current.far = next.far;
        }
    }
    Some(span)
}
