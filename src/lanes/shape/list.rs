//! Several objects: the closest hit, and whether anything is in the way.

use std::cmp::Ordering;

use super::ladder::ScaledRay;
use super::line::Crossing;
use super::question::Limits;
use super::{Hit, Placed, Ray, Rung, Start, Tally};
use crate::math::number::{Bounded, Number};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Query {
    pub ray: Ray,
    /// Crossings count after this, and at it where it is 0.
    pub t_min: f64,
    /// Crossings count before this; infinity is no limit.
    pub t_max: f64,
}

struct Candidate<'a> {
    index: usize,
    object: &'a Placed,
    crossing: Crossing,
    rung: Rung,
    t: Bounded,
}

impl Candidate<'_> {
    /// Whether this one comes first: by t, exactly if need be, then by priority, then by index.
    fn beats(
        &self,
        other: &Self,
        ray: &ScaledRay,
        priority: &impl Fn(usize) -> u8,
        tally: &mut Tally,
    ) -> bool {
        let order = self.t.minus(&other.t).sign().unwrap_or_else(|| {
            let (order, rung) = Placed::order(
                (self.object, &self.crossing),
                (other.object, &other.crossing),
                ray,
            );
            tally.count(rung);
            order
        });
        order
            .then_with(|| priority(self.index).cmp(&priority(other.index)))
            .then_with(|| self.index.cmp(&other.index))
            == Ordering::Less
    }
}

/// The closest hit over all objects, with its object's index. Equal t is recognised exactly; then
/// the lower `priority` of the index wins, then the lower index. `start` says of each object what
/// is known of the origin.
pub fn nearest(
    objects: &[Placed],
    query: &Query,
    start: impl Fn(usize) -> Start,
    priority: impl Fn(usize) -> u8,
    tally: &mut Tally,
) -> Option<(usize, Hit)> {
    nearest_of(objects.iter().enumerate(), query, start, priority, tally)
}

/// [`nearest`] over some objects with their indices.
pub fn nearest_of<'a>(
    objects: impl Iterator<Item = (usize, &'a Placed)>,
    query: &Query,
    start: impl Fn(usize) -> Start,
    priority: impl Fn(usize) -> u8,
    tally: &mut Tally,
) -> Option<(usize, Hit)> {
    let limits = Limits::new(query.t_min, query.t_max)?;
    if !query.ray.is_valid() {
        return None;
    }
    let ray = ScaledRay::new(&query.ray);
    let mut best: Option<Candidate<'_>> = None;
    for (index, object) in objects {
        let found = object.first_crossing(&ray, &limits, start(index), tally);
        let Some((crossing, rung)) = found else {
            continue;
        };
        let candidate = Candidate {
            index,
            object,
            crossing,
            rung,
            t: object.enclosure(&crossing, &ray),
        };
        let closer = best
            .as_ref()
            .is_none_or(|best| candidate.beats(best, &ray, &priority, tally));
        if closer {
            best = Some(candidate);
        }
    }
    let best = best?;
    let hit = best.object.hit(&best.crossing, &ray, best.rung)?;
    Some((best.index, hit))
}

/// Whether any object has a crossing strictly between `t_min` and `t_max`.
pub fn occluded(
    objects: &[Placed],
    query: &Query,
    start: impl Fn(usize) -> Start,
    tally: &mut Tally,
) -> bool {
    occluded_by(objects.iter().enumerate(), query, start, tally)
}

/// [`occluded`] by some objects with their indices.
pub fn occluded_by<'a>(
    mut objects: impl Iterator<Item = (usize, &'a Placed)>,
    query: &Query,
    start: impl Fn(usize) -> Start,
    tally: &mut Tally,
) -> bool {
    let Some(limits) = Limits::new(query.t_min, query.t_max) else {
        return false;
    };
    if !query.ray.is_valid() {
        return false;
    }
    let limits = Limits {
        inclusive: false,
        ..limits
    };
    let ray = ScaledRay::new(&query.ray);
    objects.any(|(index, object)| {
        object
            .first_crossing(&ray, &limits, start(index), tally)
            .is_some()
    })
}
