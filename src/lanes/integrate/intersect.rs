//! Rays against the scene: objects in lanes first, then the certified ladder for what lanes leave
//! undecided.

use glam::DVec3;

use super::list;
use super::many::{self, candidates};
use super::model::Model;
use super::pool::each;
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar};
use crate::math::ray::Ray;
use crate::math::vec3::Vec3;
use crate::shape::lanes::implicit::{FieldQuestion, LaneImplicit, StartSign};
use crate::shape::lanes::{Enclosure, LaneRay, LaneSpan};
use crate::shape::resolve::{Departure, UndecidedRay};
use crate::shape::{ShapeKind, Tally};

/// Marks rays that hit or leave nothing.
pub const NOTHING: u32 = u32::MAX;

/// How many rays each kind of arithmetic has decided.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tiers {
    pub rays: u64,
    /// Rays that lanes left undecided.
    pub undecided: u64,
    /// Single questions that the ladder answered for those.
    pub ladder: Tally,
    /// Rays asked about implicit surfaces, each surface counted.
    pub implicit: Tally,
}

impl Tiers {
    pub fn joined(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            undecided: self.undecided + other.undecided,
            ladder: self.ladder.joined(other.ladder),
            implicit: self.implicit.joined(other.implicit),
        }
    }
}

/// A packet of rays and where they start.
#[derive(Clone, Copy)]
pub struct Rays<L: Lanes> {
    pub ray: LaneRay<L>,
    /// The object that each leaves; [`NOTHING`] for those that start in the open.
    pub leaving: L::Int,
    /// Whether it goes into that object.
    pub inward: L::Mask,
}

/// The closest hits of a packet.
#[derive(Clone, Copy)]
pub struct Nearest<L: Lanes> {
    pub t: L::Real,
    /// Number of the part (see [`super::parts`]); [`NOTHING`] where nothing is hit.
    pub part: L::Int,
}

/// Rays towards lights.
#[derive(Clone, Copy)]
pub struct Shadow<L: Lanes> {
    /// From surfaces.
    pub rays: Rays<L>,
    /// Distances of the lights.
    pub limit: L::Real,
    /// The objects of the lights themselves, which do not hide their own points.
    pub except: L::Int,
}

/// One object's answer for rays that start anywhere.
pub(super) struct Candidate<L: Lanes> {
    /// Where the crossing is; the lower end also of one that is not certain.
    pub at: Enclosure<L>,
    /// There is a crossing that counts.
    pub certain: L::Mask,
    /// There may be one.
    pub possible: L::Mask,
    /// Which part it is on: among those of the scene, or of the shape as [`Asked::candidate`] says it.
    pub part: L::Int,
}

/// The lanes that are asked, each about one object.
#[derive(Clone, Copy)]
pub(super) struct Asked<L: Lanes> {
    /// All of them: rays that leave a convex surface outward do not meet it again.
    pub all: L::Mask,
    /// Those that go inward from this object's own surface.
    inside: L::Mask,
}

impl<L: Lanes> Asked<L> {
    #[inline(always)]
    pub fn new(l: L, objects: L::Int, kind: ShapeKind, rays: &Rays<L>, asked: L::Mask) -> Self {
        let own = asked & rays.leaving.same(objects);
        let inside = if kind.is_flat() {
            l.mask(false)
        } else {
            own & rays.inward
        };
        let all = if kind.is_convex() {
            (asked & !own) | inside
        } else {
            asked
        };
        Self { all, inside }
    }

    /// Those that the span does not rule out. A line along the wall of the shape that it goes into
    /// may pass outside of it, by the rounding of its start; the ray meets it all the same.
    #[inline(always)]
    pub fn met(&self, span: &LaneSpan<L>) -> L::Mask {
        (self.all & !span.miss) | self.inside
    }

    /// Picks the crossing that counts: the first one ahead, or the exit for rays that go inward from
    /// this object's own surface.
    #[inline(always)]
    pub fn candidate(&self, l: L, span: &LaneSpan<L>) -> Candidate<L> {
        let zero = l.real(0.0);
        let (mut near, far) = (span.near, span.far);
        if self.inside.any() {
            // The entering crossing is the start.
            near = near.replaced(l, self.inside, l.real(f64::NEG_INFINITY));
        }
        let leaves = near.high.lt(zero);
        let low = l.select(leaves, far.low, near.low);
        let high = l.select(leaves, far.high, near.high);
        let possible = (self.all & !(span.miss | high.lt(zero))) | self.inside;
        Candidate {
            at: Enclosure {
                // The larger of NaN and 0 is 0: what is not known could be anywhere.
                low: low.max(zero),
                high,
            },
            certain: span.hit & possible & low.gt(zero),
            possible,
            part: l.select_int(leaves, span.parts[1], span.parts[0]),
        }
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

/// Rays that are asked what they meet in a scene.
pub(super) struct Query<'a, L: Lanes> {
    pub l: L,
    pub model: &'a Model<L::Scalar>,
    pub rays: &'a Rays<L>,
    /// The lanes that hold rays.
    pub active: L::Mask,
}

impl<L: Lanes> Query<'_, L> {
    /// Where the lanes in `asked` cross object `k` before `limit`, which is no implicit surface; by a
    /// call where there is a `CALL`. `None` where none of them does.
    #[inline(always)]
    pub fn cross<const CALL: bool>(
        &self,
        k: u32,
        asked: L::Mask,
        limit: L::Real,
    ) -> Option<Candidate<L>> {
        let (l, ray) = (self.l, &self.rays.ray);
        let shape = &self.model.shapes[k as usize];
        let asked = Asked::new(l, l.int(k), shape.kind?, self.rays, asked);
        let span = if CALL {
            shape.span_by_call(l, ray, asked.all, limit)
        } else {
            shape.span(l, ray, asked.all, limit)
        };
        if !asked.met(&span).any() {
            return None;
        }
        let candidate = asked.candidate(l, &span);
        let first = l.int(self.model.parts.first[k as usize]);
        Some(Candidate {
            part: candidate.part.plus(first),
            ..candidate
        })
    }

    /// The same as one copy of code, for the hierarchy.
    #[inline(never)]
    pub fn cross_alone(&self, k: u32, asked: L::Mask, limit: L::Real) -> Option<Candidate<L>> {
        let l = self.l;
        l.vectorize(inlined!(|| self.cross::<true>(k, asked, limit)))
    }

    /// Where the lanes in `active` hit an implicit surface before `limit`, and which of them do.
    #[inline(always)]
    pub fn hit_field(
        &self,
        (object, implicit): (u32, &LaneImplicit<L::Scalar>),
        active: L::Mask,
        limit: L::Real,
        tally: &mut Tally,
    ) -> (L::Real, L::Mask) {
        let (l, rays) = (self.l, self.rays);
        let question = FieldQuestion {
            ray: &rays.ray,
            start: StartSign {
                on: rays.leaving.same(l.int(object)),
                inward: rays.inward,
            },
            limit,
            active,
        };
        implicit.first_hit(l, &question, tally)
    }

    /// Calls `decide` with each lane of `unsure` and what the ladder has to decide about it: the objects
    /// that its ray may meet before `limit`.
    #[inline(always)]
    fn resolve(
        &self,
        unsure: L::Mask,
        limit: L::Real,
        tiers: &mut Tiers,
        mut decide: impl FnMut(usize, &UndecidedRay<'_>, &mut Tally),
    ) {
        let (l, rays) = (self.l, self.rays);
        tiers.rays += u64::from(self.active.bits().count_ones());
        tiers.undecided += u64::from(unsure.bits().count_ones());
        for i in each(unsure.bits()) {
            let candidates = candidates(self, i, l.lane(limit, i));
            let doubt = UndecidedRay {
                candidates: candidates.as_deref(),
                ray: Ray {
                    origin: lane_vector(l, rays.ray.origin, i),
                    direction: lane_vector(l, rays.ray.direction, i),
                },
                departure: Departure {
                    object: l.int_lane(rays.leaving, i),
                    inward: rays.inward.bits() >> i & 1 == 1,
                },
            };
            decide(i, &doubt, &mut tiers.ladder);
        }
    }
}

/// The closest certain hit so far, and the earliest crossing that could be before it: of each ray of
/// a packet, or of one ray, as reals R and integers I.
#[derive(Clone, Copy)]
pub(super) struct Search<R, I> {
    /// Where the closest certain hit is; infinite at first.
    pub low: R,
    pub high: R,
    /// Its part; [`NOTHING`] at first.
    pub part: I,
    /// Where the earliest of all other possible crossings could be.
    pub rival: R,
    /// Distance of the closest hit on an implicit surface, whose finders answer with a distance or not
    /// at all; infinite at first.
    pub field_t: R,
    /// Its part; [`NOTHING`] at first.
    pub field_part: I,
}

/// The search of each ray of a packet.
pub(super) type Searches<L> = Search<<L as Lanes>::Real, <L as Lanes>::Int>;

/// The search for the closest hits.
impl<L: Lanes> Query<'_, L> {
    #[inline(always)]
    pub fn nothing_yet(&self) -> Searches<L> {
        let l = self.l;
        let (infinite, nothing) = (l.real(f64::INFINITY), l.int(NOTHING));
        Search {
            low: infinite,
            high: infinite,
            part: nothing,
            rival: infinite,
            field_t: infinite,
            field_part: nothing,
        }
    }

    /// Asks one object, but no implicit surface.
    #[inline(always)]
    pub fn ask(&self, search: &mut Searches<L>, k: u32) {
        if let Some(candidate) = self.cross::<false>(k, self.active, search.high) {
            self.take(search, &candidate);
        }
    }

    /// Asks any object, by calls.
    #[inline(always)]
    pub fn ask_any(&self, search: &mut Searches<L>, k: u32, tally: &mut Tally) {
        if let Some(implicit) = self.model.implicit(k) {
            self.ask_field(search, (k, implicit), tally);
        } else if let Some(candidate) = self.cross_alone(k, self.active, search.high) {
            self.take(search, &candidate);
        }
    }

    /// Asks an implicit surface for hits before `field_t`.
    #[inline(always)]
    pub fn ask_field(
        &self,
        search: &mut Searches<L>,
        field: (u32, &LaneImplicit<L::Scalar>),
        tally: &mut Tally,
    ) {
        let l = self.l;
        let (t, found) = self.hit_field(field, self.active, search.field_t, tally);
        search.field_t = l.select(found, t, search.field_t);
        let part = l.int(self.model.parts.first[field.0 as usize]);
        search.field_part = l.select_int(found, part, search.field_part);
    }

    /// Takes a crossing into account.
    #[inline(always)]
    pub fn take(&self, search: &mut Searches<L>, c: &Candidate<L>) {
        let l = self.l;
        let take = c.certain & c.at.high.lt(search.high);
        // Of this crossing and the best so far, the one that is not taken remains a rival.
        let loser = l.select(take, search.low, c.at.low);
        search.rival = l.select(c.possible, loser.min(search.rival), search.rival);
        search.low = l.select(take, c.at.low, search.low);
        search.high = l.select(take, c.at.high, search.high);
        search.part = l.select_int(take, c.part, search.part);
    }
}

/// The closest hits of the active rays.
#[inline(never)]
pub fn nearest<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    rays: &Rays<L>,
    active: L::Mask,
    tiers: &mut Tiers,
) -> Nearest<L> {
    l.vectorize(inlined!(|| {
        let query = Query {
            l,
            model,
            rays,
            active,
        };
        let mut search = match &model.hierarchy {
            None => list::search(&query),
            Some(many) => many::search(&query, many, &mut tiers.implicit),
        };
        let high = search.high;
        let mut best: Nearest<L> = Nearest {
            t: (search.low + high) * l.real(0.5),
            part: search.part,
        };
        let unsure = active & search.rival.le(high) & search.rival.lt(l.real(f64::INFINITY));
        query.resolve(
            unsure,
            high,
            tiers,
            #[inline(always)]
            |i, doubt, tally| {
                let found = model.resolver.nearest(doubt, tally);
                let (t, part) = found.map_or((f64::INFINITY, NOTHING), |found| {
                    let first = model.parts.first[found.object as usize];
                    (found.t, first + found.part)
                });
                best.t = l.with_lane(best.t, i, L::Scalar::from_f64(t));
                best.part = l.with_int_lane(best.part, i, part);
            },
        );
        if model.hierarchy.is_none() {
            (search.field_t, search.field_part) = (best.t, best.part);
            for (object, implicit) in &model.implicits {
                query.ask_field(&mut search, (*object, implicit), &mut tiers.implicit);
            }
        }
        let closer = search.field_t.lt(best.t);
        Nearest {
            t: l.select(closer, search.field_t, best.t),
            part: l.select_int(closer, search.field_part, best.part),
        }
    }))
}

/// Which shadow rays are surely blocked before they end, and which may be.
pub(super) struct Blocks<L: Lanes> {
    pub limit: L::Real,
    pub except: L::Int,
    pub blocked: L::Mask,
    pub doubtful: L::Mask,
}

impl<L: Lanes> Blocks<L> {
    /// Of rays that end at `limit`, at the object `except`.
    #[inline(always)]
    pub fn new(l: L, limit: L::Real, except: L::Int) -> Self {
        Self {
            limit,
            except,
            blocked: l.mask(false),
            doubtful: l.mask(false),
        }
    }

    /// Those of the lanes in `asked` that do not end at their object.
    #[inline(always)]
    fn counted(&self, asked: L::Mask, objects: L::Int) -> L::Mask {
        asked & !self.except.same(objects)
    }

    /// Asks one object, but no implicit surface.
    #[inline(always)]
    pub fn ask(&mut self, query: &Query<'_, L>, k: u32) {
        let asked = self.counted(query.active, query.l.int(k));
        if let Some(candidate) = query.cross::<false>(k, asked, self.limit) {
            self.take(&candidate);
        }
    }

    /// Asks any object, by calls.
    #[inline(always)]
    pub fn ask_any(&mut self, query: &Query<'_, L>, k: u32, tally: &mut Tally) {
        let asked = self.counted(query.active, query.l.int(k));
        if let Some(implicit) = query.model.implicit(k) {
            self.ask_field(query, (k, implicit), tally);
        } else if let Some(candidate) = query.cross_alone(k, asked, self.limit) {
            self.take(&candidate);
        }
    }

    /// Asks an implicit surface.
    #[inline(always)]
    pub fn ask_field(
        &mut self,
        query: &Query<'_, L>,
        field: (u32, &LaneImplicit<L::Scalar>),
        tally: &mut Tally,
    ) {
        let asked = self.counted(query.active & !self.blocked, query.l.int(field.0));
        let (_, found) = query.hit_field(field, asked, self.limit, tally);
        self.blocked = self.blocked | (found & asked);
    }

    /// Takes a crossing into account.
    #[inline(always)]
    pub fn take(&mut self, c: &Candidate<L>) {
        self.blocked = self.blocked | (c.certain & c.at.high.lt(self.limit));
        self.doubtful = self.doubtful | (c.possible & c.at.low.lt(self.limit));
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
    active: L::Mask,
    tiers: &mut Tiers,
) -> L::Mask {
    l.vectorize(inlined!(|| {
        let Shadow {
            rays,
            limit,
            except,
        } = shadow;
        let query = Query {
            l,
            model,
            rays,
            active,
        };
        let mut blocks = Blocks::new(l, *limit, *except);
        match &model.hierarchy {
            None => list::blocks(&query, *except, &mut blocks),
            Some(many) => many::blocks(&query, many, &mut blocks, &mut tiers.implicit),
        }
        let unsure = active & blocks.doubtful & !blocks.blocked;
        let mut answers = 0;
        query.resolve(
            unsure,
            *limit,
            tiers,
            #[inline(always)]
            |i, doubt, tally| {
                // The limit is a rounded distance: a few units in its last place are its own noise.
                let end = l.lane(*limit, i).to_f64() * (1.0 - 8.0 * L::Scalar::ROUNDOFF);
                let except = l.int_lane(*except, i);
                let hidden = model.resolver.occluded(doubt, end, except, tally);
                answers |= u32::from(hidden) << i;
            },
        );
        blocks.blocked = blocks.blocked | l.mask_from_bits(answers);
        if model.hierarchy.is_none() {
            for (object, implicit) in model.implicits.iter().filter(|(k, _)| model.hides(*k)) {
                blocks.ask_field(&query, (*object, implicit), &mut tiers.implicit);
            }
        }
        blocks.blocked
    }))
}
