//! Rays against the scene: the list of shapes in lanes, and the ladder for what is left.

use glam::DVec3;

use super::model::Model;
use super::pool::any;
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar, inlined};
use crate::shape::Tally;
use crate::shape::lanes::implicit::StartSign;
use crate::shape::lanes::{LaneRay, Span};
use crate::shape::resolve::Departure;

/// Marks rays that hit or leave nothing.
pub const NOTHING: u32 = u32::MAX;

/// How many rays each kind of arithmetic has decided.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Rungs {
    /// Rays asked about.
    pub rays: u64,
    /// Rays that lanes left undecided.
    pub undecided: u64,
    /// Single questions that the ladder answered for those.
    pub ladder: Tally,
}

impl Rungs {
    /// Both together.
    pub fn joined(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            undecided: self.undecided + other.undecided,
            ladder: self.ladder.joined(other.ladder),
        }
    }
}

/// Where rays start.
#[derive(Clone, Copy)]
pub struct Leaving<L: Lanes> {
    /// The object they leave.
    pub object: L::Int,
    /// Whether they go into it.
    pub inward: L::Mask,
}

/// The closest hits of a packet.
#[derive(Clone, Copy)]
pub struct Nearest<L: Lanes> {
    /// Distance.
    pub t: L::Real,
    /// Object; [`NOTHING`] where nothing is hit.
    pub object: L::Int,
}

/// One object's answer for rays that start anywhere.
struct Candidate<L: Lanes> {
    t: L::Real,
    error: L::Real,
    hit: L::Mask,
    undecided: L::Mask,
    /// Lower bound of where an undecided hit could be.
    earliest: L::Real,
}

/// Picks the crossing that counts: the first one ahead, or the exit for rays that go inward from
/// this object's own surface; none for rays that leave it outward.
#[inline(always)]
fn candidate<L: Lanes>(
    l: L,
    span: &Span<L>,
    flat: bool,
    own: L::Mask,
    inward: L::Mask,
) -> Candidate<L> {
    let zero = l.real(0.0);
    let ahead = inlined(
        #[inline(always)]
        |t: L::Real| t.gt(span.error),
    );
    let behind = inlined(
        #[inline(always)]
        |t: L::Real| t.lt(-span.error),
    );
    if flat {
        let miss = span.miss | behind(span.near) | own;
        let hit = span.hit & ahead(span.near) & !own;
        return Candidate {
            t: span.near,
            error: span.error,
            hit,
            undecided: !hit & !miss,
            earliest: (span.near - span.error).max(zero),
        };
    }
    let own_inward = own & inward;
    let miss = span.miss | behind(span.far) | (own & !inward);
    let enters = ahead(span.near) & !own_inward;
    let leaves = (behind(span.near) | own_inward) & ahead(span.far);
    let hit = span.hit & (enters | leaves) & !miss;
    let t = l.select(enters, span.near, span.far);
    Candidate {
        t,
        error: span.error,
        hit,
        undecided: !hit & !miss,
        earliest: l.select(own_inward, zero, (span.near - span.error).max(zero)),
    }
}

/// One lane of a vector as f64.
#[inline(always)]
pub fn lane_vector<L: Lanes>(l: L, v: crate::math::vec3::Vec3<L::Real>, i: usize) -> DVec3 {
    DVec3::new(
        l.lane(v.x, i).to_f64(),
        l.lane(v.y, i).to_f64(),
        l.lane(v.z, i).to_f64(),
    )
}

#[inline(always)]
fn departure<L: Lanes>(l: L, leaving: &Leaving<L>, i: usize) -> Departure {
    Departure {
        object: l.int_lane(leaving.object, i),
        inward: leaving.inward.bits() >> i & 1 == 1,
    }
}

/// The closest hits of the active rays.
#[inline(never)]
pub fn nearest<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    ray: &LaneRay<L>,
    leaving: &Leaving<L>,
    active: L::Mask,
    rungs: &mut Rungs,
) -> Nearest<L> {
    l.vectorize(
        #[inline(always)]
        || {
            let infinite = l.real(f64::INFINITY);
            let mut best = Nearest::<L> {
                t: infinite,
                object: l.int(NOTHING),
            };
            let mut best_error = l.real(0.0);
            // Where the earliest crossing could be that no bound could settle.
            let mut doubt = infinite;
            for (k, shape) in model.shapes.iter().enumerate() {
                let Some(kind) = shape.kind else { continue };
                let index = l.int(k as u32);
                let span = shape.span(l, ray);
                let own = leaving.object.same(index);
                let c = candidate(l, &span, kind.is_flat(), own, leaving.inward);
                let closer = (c.t + c.error).lt(best.t - best_error);
                let farther = (c.t - c.error).gt(best.t + best_error);
                let take = c.hit & closer;
                let tie = c.hit & !closer & !farther;
                best.t = l.select(take, c.t, best.t);
                best_error = l.select(take, c.error, best_error);
                best.object = l.select_int(take, index, best.object);
                doubt = l.select(c.undecided | tie, doubt.min(c.earliest), doubt);
            }
            rungs.rays += u64::from(active.bits().count_ones());
            let unsure = active & doubt.le(best.t + best_error) & !doubt.same(infinite);
            if any(unsure) {
                let mut bits = unsure.bits();
                rungs.undecided += u64::from(bits.count_ones());
                while bits != 0 {
                    let i = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let (t, object) = model
                        .resolver
                        .nearest(
                            lane_vector(l, ray.origin, i),
                            lane_vector(l, ray.direction, i),
                            departure(l, leaving, i),
                            &mut rungs.ladder,
                        )
                        .unwrap_or((f64::INFINITY, NOTHING));
                    best.t = l.with_lane(best.t, i, L::Scalar::from_f64(t));
                    best.object = l.with_int_lane(best.object, i, object);
                }
            }
            for (object, implicit) in &model.implicits {
                let index = l.int(*object);
                let on = leaving.object.same(index);
                let start = StartSign {
                    on,
                    inward: leaving.inward,
                };
                let (t, found) = implicit.first_change(l, ray, start, best.t, active);
                best.t = l.select(found, t, best.t);
                best.object = l.select_int(found, index, best.object);
            }
            best
        },
    )
}

/// Rays towards lights.
#[derive(Clone, Copy)]
pub struct Shadow<L: Lanes> {
    /// From the surface.
    pub ray: LaneRay<L>,
    /// Distance of the light.
    pub limit: L::Real,
    /// The light itself, which does not hide its own point.
    pub except: L::Int,
}

/// Which of the active rays meet anything before their limit.
///
/// The far end is a point on another surface, rounded; what is not *certainly* before it is taken
/// to be that surface's own neighbourhood, not an occluder.
#[inline(never)]
pub fn occluded<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    shadow: &Shadow<L>,
    leaving: &Leaving<L>,
    active: L::Mask,
    rungs: &mut Rungs,
) -> L::Mask {
    l.vectorize(
        #[inline(always)]
        || {
            let Shadow { ray, limit, except } = *shadow;
            let ray = &ray;
            let mut blocked = l.mask(false);
            let mut doubtful = l.mask(false);
            for (k, shape) in model.shapes.iter().enumerate() {
                let Some(kind) = shape.kind else { continue };
                let index = l.int(k as u32);
                let span = shape.span(l, ray);
                let own = leaving.object.same(index);
                let c = candidate(l, &span, kind.is_flat(), own, leaving.inward);
                let counted = !except.same(index);
                blocked = blocked | (c.hit & (c.t + c.error).lt(limit) & counted);
                doubtful = doubtful | (c.undecided & c.earliest.lt(limit) & counted);
            }
            rungs.rays += u64::from(active.bits().count_ones());
            let unsure = active & doubtful & !blocked;
            if any(unsure) {
                let mut bits = unsure.bits();
                rungs.undecided += u64::from(bits.count_ones());
                let mut answers = 0;
                while bits != 0 {
                    let i = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    // The limit is a rounded distance: a few units in its last place are its own noise.
                    let end = l.lane(limit, i).to_f64() * (1.0 - 8.0 * L::Scalar::ROUNDOFF);
                    let hidden = model.resolver.occluded(
                        lane_vector(l, ray.origin, i),
                        lane_vector(l, ray.direction, i),
                        end,
                        departure(l, leaving, i),
                        l.int_lane(except, i),
                        &mut rungs.ladder,
                    );
                    answers |= u32::from(hidden) << i;
                }
                blocked = blocked | l.mask_from_bits(answers);
            }
            for (object, implicit) in &model.implicits {
                let index = l.int(*object);
                let start = StartSign {
                    on: leaving.object.same(index),
                    inward: leaving.inward,
                };
                let wanted = active & !blocked & !except.same(index);
                let (_, found) = implicit.first_change(l, ray, start, limit, wanted);
                blocked = blocked | (found & wanted);
            }
            blocked
        },
    )
}
