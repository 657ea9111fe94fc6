//! The sphere x² + y² + z² = 1.

use std::cmp::Ordering;

use super::line::{Crossing, LocalRay, Span};
use crate::math::number::{Number, dot};

/// The line meets the sphere if the discriminant of its radial form is not negative.
pub fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    let a = dot(&ray.direction, &ray.direction);
    let meets = ray.discriminant(3, &a).sign()? != Ordering::Less;
    Some(meets.then(|| Span {
        near: Crossing::round(3, false),
        far: Crossing::round(3, true),
    }))
}
