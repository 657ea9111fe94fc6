//! The rectangle z = 0, |x| ≤ 1, |y| ≤ 1.

use super::line::{LocalRay, Span};
use super::plane::flat_span;
use crate::math::number::Number;

/// The point on z = 0 must have |x| ≤ 1 and |y| ≤ 1.
pub fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    flat_span(ray, |crossing| {
        let t = crossing.fraction(ray)?;
        match (ray.within(0, &t), ray.within(1, &t)) {
            (Some(false), _) | (_, Some(false)) => Some(false),
            (x, y) => x.and(y),
        }
    })
}
