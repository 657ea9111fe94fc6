//! The plane z = 0, and how a line crosses it: the flat shapes cut their outline from this.

use std::cmp::Ordering;

use super::line::{Crossing, Feature, LocalRay, Span};
use crate::math::number::Number;

/// The one crossing with z = 0. A line in the plane sees it from its edge, where it has no extent:
/// that touch is a miss.
pub fn crossing<N: Number>(ray: &LocalRay<N>) -> Option<Option<Crossing>> {
    let slope = ray.direction[2].sign()?;
    Some((slope != Ordering::Equal).then_some(Crossing {
        feature: Feature::Flat,
        leaving: slope == Ordering::Greater,
    }))
}

/// The span of a flat shape with this outline test: its one crossing twice.
pub fn flat_span<N: Number>(
    ray: &LocalRay<N>,
    inside: impl FnOnce(&Crossing) -> Option<bool>,
) -> Option<Option<Span>> {
    let Some(crossing) = crossing(ray)? else {
        return Some(None);
    };
    Some(inside(&crossing)?.then_some(Span {
        near: crossing,
        far: crossing,
    }))
}

/// Every line that is not parallel to the plane meets it.
pub fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    flat_span(ray, |_| Some(true))
}
