//! Rays against the scene: the list of shapes in lanes, and the ladder for what is left.

use glam::DVec3;

use super::model::{Many, Model};
use super::pool::{WIDEST, array, each};
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar, inlined};
use crate::math::vec3::Vec3;
use crate::shape::Tally;
use crate::shape::hierarchy::{BoxRay, Descent};
use crate::shape::implicit::placed::ImplicitTally;
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
    /// Rays asked about implicit surfaces, each surface counted.
    pub implicit: ImplicitTally,
}

impl Rungs {
    /// Both together.
    pub fn joined(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            undecided: self.undecided + other.undecided,
            ladder: self.ladder.joined(other.ladder),
            implicit: self.implicit.joined(other.implicit),
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
pub fn lane_vector<L: Lanes>(l: L, v: Vec3<L::Real>, i: usize) -> DVec3 {
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

/// The closest hits found so far, and where the earliest crossing could be that no bound could
/// settle.
struct Search<L: Lanes> {
    best: Nearest<L>,
    error: L::Real,
    doubt: L::Real,
}

impl<L: Lanes> Search<L> {
    /// Asks one object, for the lanes in `asked`.
    #[inline(always)]
    fn ask(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        k: u32,
        ray: &LaneRay<L>,
        leaving: &Leaving<L>,
        asked: L::Mask,
    ) {
        let shape = &model.shapes[k as usize];
        let Some(kind) = shape.kind else { return };
        let index = l.int(k);
        let span = shape.span(l, ray);
        let own = leaving.object.same(index);
        let c = candidate(l, &span, kind.is_flat(), own, leaving.inward);
        let closer = (c.t + c.error).lt(self.best.t - self.error);
        let farther = (c.t - c.error).gt(self.best.t + self.error);
        let take = c.hit & closer & asked;
        let unsettled = (c.undecided | (c.hit & !closer & !farther)) & asked;
        self.best.t = l.select(take, c.t, self.best.t);
        self.error = l.select(take, c.error, self.error);
        self.best.object = l.select_int(take, index, self.best.object);
        self.doubt = l.select(unsettled, self.doubt.min(c.earliest), self.doubt);
    }

    /// The same as one copy of code, for the hierarchy.
    #[inline(never)]
    fn ask_alone(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        k: u32,
        ray: &LaneRay<L>,
        leaving: &Leaving<L>,
        asked: L::Mask,
    ) {
        l.vectorize(
            #[inline(always)]
            || self.ask(l, model, k, ray, leaving, asked),
        );
    }

    /// Asks the objects whose boxes the rays meet, nearest boxes first, a round of one object a
    /// ray at a time.
    #[inline(always)]
    fn ask_many(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        many: &Many<L::Scalar>,
        ray: &LaneRay<L>,
        leaving: &Leaving<L>,
        active: L::Mask,
    ) {
        for &k in &many.unbounded {
            self.ask_alone(l, model, k, ray, leaving, active);
        }
        let mut rays = Rounds::new(l, ray, active);
        loop {
            let limits = array(l, self.best.t + self.error);
            let (mut pending, objects) = rays.next(many, active.bits(), &limits);
            if pending == 0 {
                return;
            }
            let objects = l.load_int(&objects);
            while pending != 0 {
                let k = l.int_lane(objects, pending.trailing_zeros() as usize);
                let here = l.mask_from_bits(pending) & objects.same(l.int(k));
                pending &= !here.bits();
                self.ask_alone(l, model, k, ray, leaving, here);
            }
        }
    }
}

/// The ways of a packet's rays through the hierarchy.
struct Rounds<T> {
    rays: [BoxRay<T>; WIDEST],
    descents: [Descent<T>; WIDEST],
}

impl<T: Scalar> Rounds<T> {
    #[inline(always)]
    fn new<L: Lanes<Scalar = T>>(l: L, ray: &LaneRay<L>, active: L::Mask) -> Self {
        let (o, d) = (ray.origin, ray.direction);
        let origins = [array(l, o.x), array(l, o.y), array(l, o.z)];
        let directions = [array(l, d.x), array(l, d.y), array(l, d.z)];
        let bits = active.bits();
        Self {
            rays: std::array::from_fn(|i| {
                BoxRay::new(
                    [origins[0][i], origins[1][i], origins[2][i]],
                    [directions[0][i], directions[1][i], directions[2][i]],
                )
            }),
            descents: std::array::from_fn(|i| Descent::new(bits >> i & 1 == 1)),
        }
    }

    /// The next object of each of the rays in `bits` before its limit, and which rays have one.
    #[inline(always)]
    fn next(&mut self, many: &Many<T>, bits: u32, limits: &[T; WIDEST]) -> (u32, [u32; WIDEST]) {
        let mut found = 0;
        let mut objects = [NOTHING; WIDEST];
        for i in each(bits) {
            let next = many
                .boxes
                .next(&mut self.descents[i], &self.rays[i], limits[i]);
            if let Some(object) = next {
                found |= 1 << i;
                objects[i] = object;
            }
        }
        (found, objects)
    }
}

/// The objects that one lane's ray could meet before `limit`; `None` for all.
#[cold]
fn candidates<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    ray: &LaneRay<L>,
    i: usize,
    limit: L::Scalar,
) -> Option<Vec<u32>> {
    let many = model.hierarchy.as_ref()?;
    let vector = |v: Vec3<L::Real>| [l.lane(v.x, i), l.lane(v.y, i), l.lane(v.z, i)];
    let ray = BoxRay::new(vector(ray.origin), vector(ray.direction));
    let mut descent = Descent::new(true);
    let mut objects = many.unbounded.clone();
    while let Some(object) = many.boxes.next(&mut descent, &ray, limit) {
        objects.push(object);
    }
    Some(objects)
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
            let mut search = Search::<L> {
                best: Nearest {
                    t: infinite,
                    object: l.int(NOTHING),
                },
                error: l.real(0.0),
                doubt: infinite,
            };
            match &model.hierarchy {
                None => {
                    for k in 0..model.shapes.len() as u32 {
                        search.ask(l, model, k, ray, leaving, active);
                    }
                }
                Some(many) => search.ask_many(l, model, many, ray, leaving, active),
            }
            let Search {
                mut best,
                error,
                doubt,
            } = search;
            rungs.rays += u64::from(active.bits().count_ones());
            let unsure = active & doubt.le(best.t + error) & !doubt.same(infinite);
            rungs.undecided += u64::from(unsure.bits().count_ones());
            for i in each(unsure.bits()) {
                let candidates = candidates(l, model, ray, i, l.lane(best.t + error, i));
                let (t, object) = model
                    .resolver
                    .nearest(
                        candidates.as_deref(),
                        lane_vector(l, ray.origin, i),
                        lane_vector(l, ray.direction, i),
                        departure(l, leaving, i),
                        &mut rungs.ladder,
                    )
                    .unwrap_or((f64::INFINITY, NOTHING));
                best.t = l.with_lane(best.t, i, L::Scalar::from_f64(t));
                best.object = l.with_int_lane(best.object, i, object);
            }
            for (object, implicit) in &model.implicits {
                let index = l.int(*object);
                let start = StartSign {
                    on: leaving.object.same(index),
                    inward: leaving.inward,
                };
                let tally = &mut rungs.implicit;
                let (t, found) = implicit.first_hit(l, ray, start, best.t, active, tally);
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

/// Which shadow rays are surely blocked, and which may be.
struct Blocks<L: Lanes> {
    blocked: L::Mask,
    doubtful: L::Mask,
}

impl<L: Lanes> Blocks<L> {
    /// Asks one object, for the lanes in `asked`.
    #[inline(always)]
    fn ask(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        k: u32,
        shadow: &Shadow<L>,
        leaving: &Leaving<L>,
        asked: L::Mask,
    ) {
        let shape = &model.shapes[k as usize];
        let Some(kind) = shape.kind else { return };
        let index = l.int(k);
        let span = shape.span(l, &shadow.ray);
        let own = leaving.object.same(index);
        let c = candidate(l, &span, kind.is_flat(), own, leaving.inward);
        let counted = asked & !shadow.except.same(index);
        self.blocked = self.blocked | (c.hit & (c.t + c.error).lt(shadow.limit) & counted);
        self.doubtful = self.doubtful | (c.undecided & c.earliest.lt(shadow.limit) & counted);
    }

    /// The same as one copy of code, for the hierarchy.
    #[inline(never)]
    fn ask_alone(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        k: u32,
        shadow: &Shadow<L>,
        leaving: &Leaving<L>,
        asked: L::Mask,
    ) {
        l.vectorize(
            #[inline(always)]
            || self.ask(l, model, k, shadow, leaving, asked),
        );
    }

    /// Asks the objects whose boxes the rays meet, until each ray is blocked or through.
    #[inline(always)]
    fn ask_many(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        many: &Many<L::Scalar>,
        shadow: &Shadow<L>,
        leaving: &Leaving<L>,
        active: L::Mask,
    ) {
        for &k in &many.unbounded {
            self.ask_alone(l, model, k, shadow, leaving, active);
        }
        let mut rays = Rounds::new(l, &shadow.ray, active);
        let limits = array(l, shadow.limit);
        loop {
            let open = active & !self.blocked;
            let (mut pending, objects) = rays.next(many, open.bits(), &limits);
            if pending == 0 {
                return;
            }
            let objects = l.load_int(&objects);
            while pending != 0 {
                let k = l.int_lane(objects, pending.trailing_zeros() as usize);
                let here = l.mask_from_bits(pending) & objects.same(l.int(k));
                pending &= !here.bits();
                self.ask_alone(l, model, k, shadow, leaving, here);
            }
        }
    }
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
            let nobody = l.mask(false);
            let mut blocks = Blocks::<L> {
                blocked: nobody,
                doubtful: nobody,
            };
            match &model.hierarchy {
                None => {
                    for k in 0..model.shapes.len() as u32 {
                        blocks.ask(l, model, k, shadow, leaving, active);
                    }
                }
                Some(many) => blocks.ask_many(l, model, many, shadow, leaving, active),
            }
            let Blocks {
                mut blocked,
                doubtful,
            } = blocks;
            rungs.rays += u64::from(active.bits().count_ones());
            let unsure = active & doubtful & !blocked;
            rungs.undecided += u64::from(unsure.bits().count_ones());
            let mut answers = 0;
            for i in each(unsure.bits()) {
                // The limit is a rounded distance: a few units in its last place are its own noise.
                let end = l.lane(shadow.limit, i).to_f64() * (1.0 - 8.0 * L::Scalar::ROUNDOFF);
                let limit = l.lane(shadow.limit, i);
                let candidates = candidates(l, model, &shadow.ray, i, limit);
                let hidden = model.resolver.occluded(
                    candidates.as_deref(),
                    lane_vector(l, shadow.ray.origin, i),
                    lane_vector(l, shadow.ray.direction, i),
                    end,
                    departure(l, leaving, i),
                    l.int_lane(shadow.except, i),
                    &mut rungs.ladder,
                );
                answers |= u32::from(hidden) << i;
            }
            blocked = blocked | l.mask_from_bits(answers);
            for (object, implicit) in &model.implicits {
                let index = l.int(*object);
                let start = StartSign {
                    on: leaving.object.same(index),
                    inward: leaving.inward,
                };
                let wanted = active & !blocked & !shadow.except.same(index);
                let (ray, limit) = (&shadow.ray, shadow.limit);
                let tally = &mut rungs.implicit;
                let (_, found) = implicit.first_hit(l, ray, start, limit, wanted, tally);
                blocked = blocked | (found & wanted);
            }
            blocked
        },
    )
}
