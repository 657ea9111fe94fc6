//! The disk z = 0, x² + y² ≤ 1.

use std::cmp::Ordering;

use super::line::{LocalRay, Span};
use super::plane::flat_span;
use crate::math::number::Number;

/// The point on z = 0 must have x² + y² ≤ 1.
pub fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    flat_span(ray, |crossing| {
        let t = crossing.fraction(ray)?;
        Some(ray.radial(2, &t).0.sign()? != Ordering::Greater)
    })
}
