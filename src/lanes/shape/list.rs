//! What rays ask of shapes: the first crossing with one, the closest hit on several, and whether
//! anything is in the way.

use super::ladder::{Question, ScaledRay};
use super::line::{Crossing, Fraction, LocalRay};
use super::{Hit, Placed, Ray, ShapeKind, Start, Tally, Tier};
use crate::math::number::{Bounded, Number};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Query {
    pub ray: Ray,
    /// Crossings count after this, and at it where it is 0.
    pub t_min: f64,
    /// Crossings count before this; infinity is no limit.
    pub t_max: f64,
}

impl Query {
    /// The ray as the ladder takes it, with its limits; `None` where nothing can be met.
    pub fn scaled(&self) -> Option<(ScaledRay, Limits)> {
        let Self { ray, t_min, t_max } = *self;
        if t_min.is_nan() || t_max.is_nan() || t_max == f64::NEG_INFINITY || !ray.is_valid() {
            return None;
        }
        let limits = Limits {
            t_min: t_min.clamp(f64::MIN, f64::MAX),
            inclusive: t_min == 0.0,
            t_max: t_max.is_finite().then_some(t_max),
        };
        Some((ScaledRay::new(&ray), limits))
    }
}

#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Crossings must come after this.
    pub t_min: f64,
    /// Crossings at `t_min` count too.
    pub inclusive: bool,
    /// Crossings must come before this.
    pub t_max: Option<f64>,
}

/// Which crossing within the limits comes first; its answer is `None` where there is none.
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

struct ObjectCrossing<'a> {
    index: usize,
    object: &'a Placed,
    crossing: Crossing,
    tier: Tier,
    t: Bounded,
}

/// The closest hit on objects that come with their indices, and its object's index. Equal t is
/// recognised exactly; then the lower `priority` wins, then the lower index. `start` says what is known
/// of the origin by object.
pub fn nearest<'a>(
    objects: impl Iterator<Item = (usize, &'a Placed)>,
    query: &Query,
    start: impl Fn(usize) -> Start,
    priority: impl Fn(usize) -> u8,
    tally: &mut Tally,
) -> Option<(usize, Hit)> {
    let (ray, limits) = query.scaled()?;
    let rank = |index| (priority(index), index);
    let mut best: Option<ObjectCrossing<'_>> = None;
    for (index, object) in objects {
        let found = object.first_crossing(&ray, &limits, start(index), tally);
        let Some((crossing, tier)) = found else {
            continue;
        };
        let t = object.enclosure(&crossing, &ray);
        let is_first = best.as_ref().is_none_or(|best| {
            let order = t.minus(&best.t).sign().unwrap_or_else(|| {
                let crossings = [(object, &crossing), (best.object, &best.crossing)];
                let (order, tier) = Placed::order(crossings, &ray);
                tally.count(Some(tier));
                order
            });
            order
                .then_with(|| rank(index).cmp(&rank(best.index)))
                .is_lt()
        });
        if is_first {
            best = Some(ObjectCrossing {
                index,
                object,
                crossing,
                tier,
                t,
            });
        }
    }
    let best = best?;
    let hit = best.object.hit(&best.crossing, &ray, best.tier)?;
    Some((best.index, hit))
}

/// Whether any of the objects has a crossing strictly between `t_min` and `t_max`.
pub fn occluded<'a>(
    mut objects: impl Iterator<Item = (usize, &'a Placed)>,
    query: &Query,
    start: impl Fn(usize) -> Start,
    tally: &mut Tally,
) -> bool {
    let Some((ray, mut limits)) = query.scaled() else {
        return false;
    };
    limits.inclusive = false;
    objects.any(|(index, object)| {
        let crossing = object.first_crossing(&ray, &limits, start(index), tally);
        crossing.is_some()
    })
}
