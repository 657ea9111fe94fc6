//! Several objects: the closest hit, and whether anything is in the way.

use super::ladder::ScaledRay;
use super::line::Crossing;
use super::question::Limits;
use super::{Hit, Placed, Ray, Start, Tally, Tier};
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
    pub(super) fn scaled(&self) -> Option<(ScaledRay, Limits)> {
        let limits = Limits::new(self.t_min, self.t_max)?;
        let valid = self.ray.is_valid();
        valid.then(|| (ScaledRay::new(&self.ray), limits))
    }
}

/// The first crossing with an object.
struct ObjectCrossing<'a> {
    index: usize,
    object: &'a Placed,
    crossing: Crossing,
    tier: Tier,
    t: Bounded,
}

/// The closest hit over some objects with their indices, with its object's index. Equal t is
/// recognised exactly; then the lower `priority` of the index wins, then the lower index. `start`
/// says of each object what is known of the origin.
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

/// Whether any of some objects with their indices has a crossing strictly between `t_min` and `t_max`.
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
