//! The questions asked on the ladder.

use super::ladder::{Question, ScaledRay};
use super::line::{Crossing, Fraction, LocalRay};
use super::{ShapeKind, Start};
use crate::math::number::Number;

#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Crossings must come after this …
    pub t_min: f64,
    /// … or at it.
    pub inclusive: bool,
    /// Crossings must come before this.
    pub t_max: Option<f64>,
}

impl Limits {
    /// t > `t_min`, or t ≥ 0 where it is 0, and t < `t_max` where that is finite. `None` for NaN.
    pub fn new(t_min: f64, t_max: f64) -> Option<Self> {
        (!t_min.is_nan() && !t_max.is_nan() && t_max != f64::NEG_INFINITY).then(|| Self {
            t_min: t_min.clamp(f64::MIN, f64::MAX),
            inclusive: t_min == 0.0,
            t_max: t_max.is_finite().then_some(t_max),
        })
    }
}

/// Which crossing within the limits comes first?
pub struct FirstCrossing<'a> {
    pub kind: ShapeKind,
    /// The ray in the world, for the units of t.
    pub ray: &'a ScaledRay,
    pub limits: &'a Limits,
    pub start: Start,
}

impl Question for FirstCrossing<'_> {
    type Answer = Option<Crossing>;

    fn ask<N: Number>(&self, ray: &LocalRay<N>) -> Option<Option<Crossing>> {
        let Some(span) = self.kind.span(ray)? else {
            return Some(None);
        };
        let skipped = usize::from(self.start == Start::OnSurfaceInward || span.near == span.far);
        let limit = |t| Fraction::whole(self.ray.scaled_t(t));
        let t_min = limit(self.limits.t_min);
        for crossing in &[span.near, span.far][skipped..] {
            let order = crossing.compare(ray, &t_min)?;
            if order.is_lt() || (order.is_eq() && !self.limits.inclusive) {
                continue;
            }
            let is_before = match self.limits.t_max {
                Some(t_max) => crossing.compare(ray, &limit(t_max))?.is_lt(),
                None => true,
            };
            return Some(is_before.then_some(*crossing));
        }
        Some(None)
    }
}
