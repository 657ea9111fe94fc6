//! Rays against the scene: the list of shapes in lanes, and the ladder for what is left.

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
pub struct Rungs {
    /// Rays asked about.
    pub rays: u64,
    /// Rays that lanes left undecided.
    pub undecided: u64,
    /// Single questions that the ladder answered for those.
    pub ladder: Tally,
    /// Rays asked about implicit surfaces, each surface counted.
    pub implicit: Tally,
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

impl<L: Lanes> Leaving<L> {
    /// What the rays know of an implicit surface at their start.
    #[inline(always)]
    pub(super) fn start_sign(&self, l: L, object: u32) -> StartSign<L> {
        StartSign {
            on: self.object.same(l.int(object)),
            inward: self.inward,
        }
    }
}

/// Rays and where they start.
#[derive(Clone, Copy)]
pub(super) struct Rays<'a, L: Lanes> {
    pub ray: &'a LaneRay<L>,
    /// What they leave.
    pub leaving: &'a Leaving<L>,
}

impl<L: Lanes> Rays<'_, L> {
    /// Lane `i`, as the ladder is asked about it.
    #[inline(always)]
    fn doubt<'c>(&self, l: L, i: usize, candidates: Option<&'c [u32]>) -> UndecidedRay<'c> {
        UndecidedRay {
            candidates,
            ray: Ray {
                origin: lane_vector(l, self.ray.origin, i),
                direction: lane_vector(l, self.ray.direction, i),
            },
            departure: Departure {
                object: l.int_lane(self.leaving.object, i),
                inward: self.leaving.inward.bits() >> i & 1 == 1,
            },
        }
    }
}

/// The closest hits of a packet.
#[derive(Clone, Copy)]
pub struct Nearest<L: Lanes> {
    pub t: L::Real,
    /// Number of the part (see [`super::parts`]); [`NOTHING`] where nothing is hit.
    pub part: L::Int,
}

/// One object's answer for rays that start anywhere.
pub(super) struct Candidate<L: Lanes> {
    /// Where the crossing is; the lower end also of one that is not certain.
    pub at: Enclosure<L>,
    /// There is a crossing that counts.
    pub certain: L::Mask,
    /// There may be one.
    pub possible: L::Mask,
    /// Which of the shape's parts it is on.
    pub part: L::Int,
}

/// The lanes that are asked, each about one object.
#[derive(Clone, Copy)]
pub(super) struct Asked<L: Lanes> {
    /// All of them: rays that leave a convex surface outward do not meet it again.
    pub all: L::Mask,
    /// Those that go inward from this object's own surface.
    pub inside: L::Mask,
}

impl<L: Lanes> Asked<L> {
    #[inline(always)]
    pub fn new(
        l: L,
        objects: L::Int,
        kind: ShapeKind,
        leaving: &Leaving<L>,
        asked: L::Mask,
    ) -> Self {
        let own = asked & leaving.object.same(objects);
        let inside = if kind.is_flat() {
            l.mask(false)
        } else {
            own & leaving.inward
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
}

/// Picks the crossing that counts: the first one ahead, or the exit for rays that go inward from
/// this object's own surface.
#[inline(always)]
pub(super) fn candidate<L: Lanes>(l: L, span: &LaneSpan<L>, asked: &Asked<L>) -> Candidate<L> {
    let zero = l.real(0.0);
    let LaneSpan {
        mut near, far, hit, ..
    } = *span;
    if asked.inside.any() {
        // The entering crossing is the start.
        let behind = l.real(f64::NEG_INFINITY);
        near.low = l.select(asked.inside, behind, near.low);
        near.high = l.select(asked.inside, behind, near.high);
    }
    let leaves = near.high.lt(zero);
    let low = l.select(leaves, far.low, near.low);
    let high = l.select(leaves, far.high, near.high);
    let possible = (asked.all & !(span.miss | high.lt(zero))) | asked.inside;
    Candidate {
        at: Enclosure {
            // The larger of NaN and 0 is 0: what is not known could be anywhere.
            low: low.max(zero),
            high,
        },
        certain: hit & possible & low.gt(zero),
        possible,
        part: l.select_int(leaves, span.parts[1], span.parts[0]),
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

/// The closest hits on implicit surfaces, whose finders answer with a distance or not at all.
#[derive(Clone, Copy)]
pub(super) struct FieldHits<L: Lanes> {
    /// Distance; a limit where nothing is hit before it.
    pub t: L::Real,
    /// Part; [`NOTHING`] at first.
    pub part: L::Int,
    /// What decided.
    pub tally: Tally,
}

impl<L: Lanes> FieldHits<L> {
    /// Asks an implicit surface, for the lanes in `asked`.
    #[inline(always)]
    pub fn ask(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        (object, implicit): (u32, &LaneImplicit<L::Scalar>),
        rays: Rays<'_, L>,
        active: L::Mask,
    ) {
        let question = FieldQuestion {
            ray: rays.ray,
            start: rays.leaving.start_sign(l, object),
            limit: self.t,
            active,
        };
        let (t, found) = implicit.first_hit(l, &question, &mut self.tally);
        self.t = l.select(found, t, self.t);
        let part = l.int(model.parts.first[object as usize]);
        self.part = l.select_int(found, part, self.part);
    }
}

/// The closest certain hits so far, and the earliest crossing that could be before them.
pub(super) struct Search<L: Lanes> {
    /// Where the closest certain hit is; infinite at first.
    pub best: Enclosure<L>,
    /// Its part; [`NOTHING`] at first.
    pub part: L::Int,
    /// Where the earliest of all other possible crossings could be.
    pub rival: L::Real,
    /// Hits on implicit surfaces that were asked on the way.
    pub fields: FieldHits<L>,
}

impl<L: Lanes> Search<L> {
    #[inline(always)]
    pub fn new(l: L) -> Self {
        let infinite = l.real(f64::INFINITY);
        Self {
            best: Enclosure {
                low: infinite,
                high: infinite,
            },
            part: l.int(NOTHING),
            rival: infinite,
            fields: FieldHits {
                t: infinite,
                part: l.int(NOTHING),
                tally: Tally::default(),
            },
        }
    }

    /// Where whatever comes later cannot count any more.
    #[inline(always)]
    pub fn limit(&self) -> L::Real {
        self.fields.t.min(self.best.high)
    }

    /// Asks one object, for the lanes in `asked`; by a call where it is `SINGLE`.
    #[inline(always)]
    pub fn ask<const SINGLE: bool>(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        k: u32,
        rays: Rays<'_, L>,
        asked: L::Mask,
    ) {
        let shape = &model.shapes[k as usize];
        let Some(kind) = shape.kind else { return };
        let asked = Asked::new(l, l.int(k), kind, rays.leaving, asked);
        let (ray, limit) = (rays.ray, self.best.high);
        let span = if SINGLE {
            shape.span_by_call(l, ray, asked.all, limit)
        } else {
            shape.span(l, ray, asked.all, limit)
        };
        if !asked.met(&span).any() {
            return;
        }
        let c = candidate(l, &span, &asked);
        let part = c.part.plus(l.int(model.parts.first[k as usize]));
        self.take(l, &c, part);
    }

    /// Takes a crossing with the given part into account.
    #[inline(always)]
    pub fn take(&mut self, l: L, c: &Candidate<L>, part: L::Int) {
        let take = c.certain & c.at.high.lt(self.best.high);
        // Of this crossing and the best so far, the one that is not taken remains a rival.
        let loser = l.select(take, self.best.low, c.at.low);
        self.rival = l.select(c.possible, loser.min(self.rival), self.rival);
        self.best.low = l.select(take, c.at.low, self.best.low);
        self.best.high = l.select(take, c.at.high, self.best.high);
        self.part = l.select_int(take, part, self.part);
    }

    /// The same of any object, as one copy of code, for the hierarchy.
    #[inline(never)]
    pub fn ask_alone(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        k: u32,
        rays: Rays<'_, L>,
        asked: L::Mask,
    ) {
        l.vectorize(
            #[inline(always)]
            || match model.implicit(k) {
                Some(implicit) => self.fields.ask(l, model, (k, implicit), rays, asked),
                None => self.ask::<true>(l, model, k, rays, asked),
            },
        );
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
            let rays = Rays { ray, leaving };
            let search = match &model.hierarchy {
                None => list::search(l, model, &model.list, rays, active),
                Some(many) => many::search(l, model, many, rays, active),
            };
            let high = search.best.high;
            let mut best = Nearest {
                t: (search.best.low + high) * l.real(0.5),
                part: search.part,
            };
            rungs.rays += u64::from(active.bits().count_ones());
            let unsure = active & search.rival.le(high) & search.rival.lt(l.real(f64::INFINITY));
            rungs.undecided += u64::from(unsure.bits().count_ones());
            for i in each(unsure.bits()) {
                let candidates = candidates(l, model, rays, i, l.lane(high, i));
                let doubt = rays.doubt(l, i, candidates.as_deref());
                let found = model.resolver.nearest(&doubt, &mut rungs.ladder);
                let (t, part) = found.map_or((f64::INFINITY, NOTHING), |found| {
                    (
                        found.t,
                        model.parts.first[found.object as usize] + found.part,
                    )
                });
                best.t = l.with_lane(best.t, i, L::Scalar::from_f64(t));
                best.part = l.with_int_lane(best.part, i, part);
            }
            let mut fields = search.fields;
            if model.hierarchy.is_none() {
                (fields.t, fields.part) = (best.t, best.part);
                for (object, implicit) in &model.implicits {
                    fields.ask(l, model, (*object, implicit), rays, active);
                }
            }
            let closer = fields.t.lt(best.t);
            best.t = l.select(closer, fields.t, best.t);
            best.part = l.select_int(closer, fields.part, best.part);
            rungs.implicit = rungs.implicit.joined(fields.tally);
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

/// Which shadow rays are surely blocked, and which may be, before they end.
pub(super) struct Blocks<'a, L: Lanes> {
    pub shadow: &'a Shadow<L>,
    pub rays: Rays<'a, L>,
    pub blocked: L::Mask,
    pub doubtful: L::Mask,
    /// What decided about the implicit surfaces that were asked on the way.
    pub tally: Tally,
}

impl<'a, L: Lanes> Blocks<'a, L> {
    #[inline(always)]
    pub fn new(l: L, shadow: &'a Shadow<L>, leaving: &'a Leaving<L>) -> Self {
        let ray = &shadow.ray;
        Self {
            shadow,
            rays: Rays { ray, leaving },
            blocked: l.mask(false),
            doubtful: l.mask(false),
            tally: Tally::default(),
        }
    }

    /// Asks one object, for the lanes in `asked`; by a call where it is `SINGLE`.
    #[inline(always)]
    pub fn ask<const SINGLE: bool>(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        k: u32,
        asked: L::Mask,
    ) {
        let Shadow { ray, limit, except } = self.shadow;
        let shape = &model.shapes[k as usize];
        let Some(kind) = shape.kind else { return };
        let asked = asked & !except.same(l.int(k));
        let asked = Asked::new(l, l.int(k), kind, self.rays.leaving, asked);
        let span = if SINGLE {
            shape.span_by_call(l, ray, asked.all, *limit)
        } else {
            shape.span(l, ray, asked.all, *limit)
        };
        if !asked.met(&span).any() {
            return;
        }
        self.take(&candidate(l, &span, &asked));
    }

    /// Takes a crossing into account.
    #[inline(always)]
    pub fn take(&mut self, c: &Candidate<L>) {
        let limit = self.shadow.limit;
        self.blocked = self.blocked | (c.certain & c.at.high.lt(limit));
        self.doubtful = self.doubtful | (c.possible & c.at.low.lt(limit));
    }

    /// Asks an implicit surface, for the lanes in `asked` that are not blocked.
    #[inline(always)]
    fn ask_field(
        &mut self,
        l: L,
        (object, implicit): (u32, &LaneImplicit<L::Scalar>),
        asked: L::Mask,
    ) {
        let Shadow { ray, limit, except } = self.shadow;
        let active = asked & !self.blocked & !except.same(l.int(object));
        let question = FieldQuestion {
            ray,
            start: self.rays.leaving.start_sign(l, object),
            limit: *limit,
            active,
        };
        let (_, found) = implicit.first_hit(l, &question, &mut self.tally);
        self.blocked = self.blocked | (found & active);
    }

    /// Asks any object, as one copy of code, for the hierarchy.
    #[inline(never)]
    pub fn ask_alone(&mut self, l: L, model: &Model<L::Scalar>, k: u32, asked: L::Mask) {
        l.vectorize(
            #[inline(always)]
            || match model.implicit(k) {
                Some(implicit) => self.ask_field(l, (k, implicit), asked),
                None => self.ask::<true>(l, model, k, asked),
            },
        );
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
            let mut blocks = Blocks::new(l, shadow, leaving);
            match &model.hierarchy {
                None => list::blocks(l, model, &model.occluders, &mut blocks, active),
                Some(many) => many::blocks(l, model, many, &mut blocks, active),
            }
            let rays = blocks.rays;
            rungs.rays += u64::from(active.bits().count_ones());
            let unsure = active & blocks.doubtful & !blocks.blocked;
            rungs.undecided += u64::from(unsure.bits().count_ones());
            let mut answers = 0;
            for i in each(unsure.bits()) {
                // The limit is a rounded distance: a few units in its last place are its own noise.
                let end = l.lane(shadow.limit, i).to_f64() * (1.0 - 8.0 * L::Scalar::ROUNDOFF);
                let limit = l.lane(shadow.limit, i);
                let candidates = candidates(l, model, rays, i, limit);
                let doubt = rays.doubt(l, i, candidates.as_deref());
                let (except, tally) = (l.int_lane(shadow.except, i), &mut rungs.ladder);
                let hidden = model.resolver.occluded(&doubt, end, except, tally);
                answers |= u32::from(hidden) << i;
            }
            blocks.blocked = blocks.blocked | l.mask_from_bits(answers);
            if model.hierarchy.is_none() {
                for (object, implicit) in model.implicits.iter().filter(|(k, _)| model.hides(*k)) {
                    blocks.ask_field(l, (*object, implicit), active);
                }
            }
            rungs.implicit = rungs.implicit.joined(blocks.tally);
            blocks.blocked
        },
    )
}
