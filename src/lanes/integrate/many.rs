//! Rays against many objects.
//!
//! First a packet asks the few broad objects together. Then its rays go through the hierarchy one by
//! one, and the lanes are boxes, or balls: the answers for a ray depend neither on its neighbours
//! nor on their number.

use super::intersect::{Asked, Blocks, Candidate, FieldHits, Leaving, Rays, Search, candidate};
use super::model::{Many, Model};
use super::pool::{WIDEST, array, each, int_array};
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar, inlined};
use crate::math::vec3::Vec3;
use crate::shape::ShapeKind;
use crate::shape::Tally;
use crate::shape::hierarchy::{BoxRay, Child, Descent, WIDTH};
use crate::shape::lanes::balls::Balls;
use crate::shape::lanes::implicit::{FieldQuestion, LaneImplicit};
use crate::shape::lanes::{Enclosure, LaneRay};

/// A packet's rays as arrays, to be taken one by one.
struct Stored<T> {
    origin: [[T; WIDEST]; 3],
    direction: [[T; WIDEST]; 3],
    inverse: [[T; WIDEST]; 3],
    extent: [T; WIDEST],
    inverse_square: [T; WIDEST],
    leaving: [u32; WIDEST],
    inward: u32,
}

impl<T: Scalar> Stored<T> {
    #[inline(always)]
    fn new<L: Lanes<Scalar = T>>(
        l: L,
        Rays { ray, leaving }: Rays<'_, L>,
        inverse: Vec3<L::Real>,
    ) -> Self {
        let (o, d) = (ray.origin, ray.direction);
        Self {
            origin: [array(l, o.x), array(l, o.y), array(l, o.z)],
            direction: [array(l, d.x), array(l, d.y), array(l, d.z)],
            inverse: [
                array(l, inverse.x),
                array(l, inverse.y),
                array(l, inverse.z),
            ],
            extent: array(l, ray.extent),
            inverse_square: array(l, ray.inverse_square),
            leaving: int_array(l, leaving.object),
            inward: leaving.inward.bits(),
        }
    }

    /// Ray `i` in all lanes.
    #[inline(always)]
    fn lone<N: Lanes<Scalar = T>>(&self, n: N, i: usize) -> Lone<N> {
        let origin = one_of(&self.origin, i);
        let inverse = one_of(&self.inverse, i);
        let vector = inlined(
            #[inline(always)]
            |[x, y, z]: [T; 3]| Vec3::new(n.splat(x), n.splat(y), n.splat(z)),
        );
        Lone {
            ray: LaneRay {
                origin: vector(origin),
                direction: vector(one_of(&self.direction, i)),
                extent: n.splat(self.extent[i]),
                inverse_square: n.splat(self.inverse_square[i]),
            },
            leaving: Leaving {
                object: n.int(self.leaving[i]),
                inward: n.mask(self.inward >> i & 1 == 1),
            },
            boxes: BoxRay::new(n, origin, inverse),
        }
    }
}

#[inline(always)]
fn one_of<T: Copy>(vectors: &[[T; WIDEST]; 3], i: usize) -> [T; 3] {
    [vectors[0][i], vectors[1][i], vectors[2][i]]
}

/// One ray, the same in all lanes.
struct Lone<N: Lanes> {
    ray: LaneRay<N>,
    leaving: Leaving<N>,
    boxes: BoxRay<N>,
}

impl<N: Lanes> Lone<N> {
    /// What the balls of a group from place `from` on answer, those that are asked, and their
    /// numbers; nothing where the ray surely misses all.
    #[inline(always)]
    fn ask_balls(
        &self,
        n: N,
        balls: &Balls<N::Scalar>,
        from: usize,
        limit: N::Scalar,
    ) -> Option<(Candidate<N>, N::Mask, N::Int)> {
        let objects = n.load_int(&balls.objects[from..]);
        let asked = Asked::new(
            n,
            objects,
            ShapeKind::Sphere,
            &self.leaving,
            balls.present(n, from),
        );
        let span = balls.span(n, from, &self.ray, asked.all, n.splat(limit));
        if !asked.met(&span).any() {
            return None;
        }
        Some((candidate(n, &span, &asked), asked.all, objects))
    }

    /// What one object answers, in all lanes.
    #[inline(never)]
    fn ask_object(
        &self,
        n: N,
        model: &Model<N::Scalar>,
        k: u32,
        limit: N::Scalar,
    ) -> Option<Candidate<N>> {
        n.vectorize(
            #[inline(always)]
            || {
                let shape = &model.shapes[k as usize];
                let kind = shape.kind?;
                let asked = Asked::new(n, n.int(k), kind, &self.leaving, n.mask(true));
                let span = shape.span_by_call(n, &self.ray, asked.all, n.splat(limit));
                if !asked.met(&span).any() {
                    return None;
                }
                Some(candidate(n, &span, &asked))
            },
        )
    }
}

impl<N: Lanes> Lone<N> {
    /// Where an implicit surface is hit before the limit.
    #[inline(never)]
    fn ask_field(
        &self,
        n: N,
        (object, implicit): (u32, &LaneImplicit<N::Scalar>),
        limit: N::Scalar,
        tally: &mut Tally,
    ) -> Option<N::Scalar> {
        n.vectorize(
            #[inline(always)]
            || {
                let question = FieldQuestion {
                    ray: &self.ray,
                    start: self.leaving.start_sign(n, object),
                    limit: n.splat(limit),
                    active: n.mask_from_bits(1),
                };
                let (t, found) = implicit.first_hit(n, &question, tally);
                found.any().then(|| n.lane(t, 0))
            },
        )
    }
}

/// One ray's closest certain hit so far and what could be before it, as in [`Search`].
struct Closest<T> {
    low: T,
    high: T,
    part: u32,
    rival: T,
    /// The closest hit on an implicit surface and its part.
    field: (T, u32),
    /// What decided about those.
    tally: Tally,
}

impl<T: Scalar> Closest<T> {
    /// Where whatever comes later cannot count any more.
    #[inline(always)]
    fn limit(&self) -> T {
        if self.field.0 < self.high {
            self.field.0
        } else {
            self.high
        }
    }

    /// Counts the lanes of `bits`, whose objects have parts by `part_of`.
    #[inline(always)]
    fn take<N: Lanes<Scalar = T>>(
        &mut self,
        n: N,
        candidate: &Candidate<N>,
        bits: u32,
        part_of: impl Fn(usize) -> u32,
    ) {
        if bits == 0 {
            return;
        }
        let mut ends = [[T::default(); WIDTH]; 2];
        n.store(candidate.at.low, &mut ends[0]);
        n.store(candidate.at.high, &mut ends[1]);
        let certain = candidate.certain.bits();
        for i in each(bits) {
            let (low, high) = (ends[0][i % WIDTH], ends[1][i % WIDTH]);
            let mut loser = low;
            if certain >> i & 1 == 1 && high < self.high {
                loser = self.low;
                (self.low, self.high) = (low, high);
                self.part = part_of(i);
            }
            if loser < self.rival {
                self.rival = loser;
            }
        }
    }
}

/// The closest hits of the active rays.
#[inline(never)]
pub(super) fn search<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    many: &Many<L::Scalar>,
    rays: Rays<'_, L>,
    active: L::Mask,
) -> Search<L> {
    l.vectorize(
        #[inline(always)]
        || {
            let mut search = Search::new(l);
            for &k in &many.broad {
                search.ask_alone(l, model, k, rays, active);
            }
            let ray = rays.ray;
            let inverse = ray.direction.reciprocal(l);
            let met = many.boxes.all.meets(l, ray.origin, inverse, search.limit());
            let met = (active & met).bits();
            if met == 0 {
                return search;
            }
            let mut low = array(l, search.best.low);
            let mut high = array(l, search.best.high);
            let mut part = int_array(l, search.part);
            let mut rival = array(l, search.rival);
            let mut field_t = array(l, search.fields.t);
            let mut field_part = int_array(l, search.fields.part);
            let mut tally = search.fields.tally;
            let n = l.narrow();
            let stored = Stored::new(l, rays, inverse);
            let mut descent = Descent::default();
            for i in each(met) {
                let mut closest = Closest {
                    low: low[i],
                    high: high[i],
                    part: part[i],
                    rival: rival[i],
                    field: (field_t[i], field_part[i]),
                    tally,
                };
                descent.restart();
                closest_along(
                    n,
                    model,
                    many,
                    &stored.lone(n, i),
                    &mut descent,
                    &mut closest,
                );
                low[i] = closest.low;
                high[i] = closest.high;
                part[i] = closest.part;
                rival[i] = closest.rival;
                (field_t[i], field_part[i]) = closest.field;
                tally = closest.tally;
            }
            Search {
                best: Enclosure {
                    low: l.load(&low),
                    high: l.load(&high),
                },
                part: l.load_int(&part),
                rival: l.load(&rival),
                fields: FieldHits {
                    t: l.load(&field_t),
                    part: l.load_int(&field_part),
                    tally,
                },
            }
        },
    )
}

/// Asks what one ray meets the boxes of, nearest boxes first.
#[inline(always)]
fn closest_along<N: Lanes>(
    n: N,
    model: &Model<N::Scalar>,
    many: &Many<N::Scalar>,
    lone: &Lone<N>,
    descent: &mut Descent<N::Scalar>,
    closest: &mut Closest<N::Scalar>,
) {
    let first = |object: u32| model.parts.first[object as usize];
    while let Some(child) = many
        .boxes
        .next::<N, true>(n, descent, &lone.boxes, closest.limit())
    {
        match child {
            Child::Balls(balls) => {
                for from in (0..balls.count).step_by(N::COUNT) {
                    let asked = lone.ask_balls(n, balls, from, closest.limit());
                    let Some((candidate, asked, _)) = asked else {
                        continue;
                    };
                    let bits = (candidate.possible & asked).bits();
                    closest.take(n, &candidate, bits, |i| {
                        first(balls.objects[(from + i) % WIDTH])
                    });
                }
            }
            Child::Object(k) => {
                if let Some(implicit) = model.implicit(k) {
                    let limit = closest.limit();
                    let tally = &mut closest.tally;
                    if let Some(t) = lone.ask_field(n, (k, implicit), limit, tally) {
                        closest.field = (t, first(k));
                    }
                } else if let Some(candidate) = lone.ask_object(n, model, k, closest.limit()) {
                    let bits = candidate.possible.bits() & 1;
                    closest.take(n, &candidate, bits, |_| {
                        first(k) + n.int_lane(candidate.part, 0)
                    });
                }
            }
        }
    }
}

/// Adds which of the active shadow rays are blocked.
#[inline(never)]
pub(super) fn blocks<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    many: &Many<L::Scalar>,
    blocks: &mut Blocks<'_, L>,
    active: L::Mask,
) {
    l.vectorize(
        #[inline(always)]
        || {
            let shadow = blocks.shadow;
            for &k in many.broad.iter().filter(|k| many.hides[**k as usize]) {
                blocks.ask_alone(l, model, k, active);
            }
            let inverse = shadow.ray.direction.reciprocal(l);
            let (origin, limit) = (shadow.ray.origin, shadow.limit);
            let met = many.boxes.all.meets(l, origin, inverse, limit);
            let met = (active & met & !blocks.blocked).bits();
            if met == 0 {
                return;
            }
            let n = l.narrow();
            let stored = Stored::new(l, blocks.rays, inverse);
            let limits = array(l, shadow.limit);
            let excepted = int_array(l, shadow.except);
            let mut descent = Descent::default();
            let (mut blocked, mut doubtful) = (0, 0);
            for i in each(met) {
                descent.restart();
                let lone = stored.lone(n, i);
                let end = End {
                    limit: limits[i],
                    except: n.int(excepted[i]),
                };
                let found = block_along(n, model, &lone, &end, (&mut descent, &mut blocks.tally));
                blocked |= u32::from(found == Block::Sure) << i;
                doubtful |= u32::from(found == Block::Doubtful) << i;
            }
            blocks.blocked = blocks.blocked | l.mask_from_bits(blocked);
            blocks.doubtful = blocks.doubtful | l.mask_from_bits(doubtful);
        },
    )
}

/// Where a shadow ray ends.
struct End<N: Lanes> {
    limit: N::Scalar,
    except: N::Int,
}

/// What is before a shadow ray's end.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Block {
    Nothing,
    Doubtful,
    Sure,
}

impl<N: Lanes> End<N> {
    /// What a candidate of the given objects is, for the lanes in `asked`.
    #[inline(always)]
    fn judge(&self, n: N, c: &Candidate<N>, asked: N::Mask, objects: N::Int) -> Block {
        let limit = n.splat(self.limit);
        let counted = c.possible & asked & !self.except.same(objects);
        if (c.certain & c.at.high.lt(limit) & counted).any() {
            Block::Sure
        } else if (c.at.low.lt(limit) & counted).any() {
            Block::Doubtful
        } else {
            Block::Nothing
        }
    }
}

/// Asks what one shadow ray meets the boxes of, until it is surely blocked.
#[inline(always)]
fn block_along<N: Lanes>(
    n: N,
    model: &Model<N::Scalar>,
    lone: &Lone<N>,
    end: &End<N>,
    (descent, tally): (&mut Descent<N::Scalar>, &mut Tally),
) -> Block {
    let mut all = Block::Nothing;
    let Some(many) = &model.hierarchy else {
        return all;
    };
    while let Some(child) = many
        .boxes
        .next::<N, false>(n, descent, &lone.boxes, end.limit)
    {
        let found = match child {
            Child::Balls(balls) => {
                let mut found = Block::Nothing;
                for from in (0..balls.count).step_by(N::COUNT) {
                    if let Some((c, asked, objects)) = lone.ask_balls(n, balls, from, end.limit) {
                        found = found.max(end.judge(n, &c, asked, objects));
                    }
                }
                found
            }
            Child::Object(k) if !many.hides[k as usize] => Block::Nothing,
            Child::Object(k) => {
                if let Some(implicit) = model.implicit(k) {
                    let counts = !end.except.same(n.int(k)).any();
                    let hit = counts
                        .then(|| lone.ask_field(n, (k, implicit), end.limit, tally))
                        .flatten();
                    hit.map_or(Block::Nothing, |_| Block::Sure)
                } else {
                    match lone.ask_object(n, model, k, end.limit) {
                        Some(c) => end.judge(n, &c, n.mask(true), n.int(k)),
                        None => Block::Nothing,
                    }
                }
            }
        };
        if found == Block::Sure {
            return Block::Sure;
        }
        all = all.max(found);
    }
    all
}

/// The objects that one lane's ray could meet before `limit` for all that lanes know; `None` for
/// all.
#[cold]
pub(super) fn candidates<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    rays: Rays<'_, L>,
    i: usize,
    limit: L::Scalar,
) -> Option<Vec<u32>> {
    let many = model.hierarchy.as_ref()?;
    let n = l.narrow();
    let inverse = rays.ray.direction.reciprocal(l);
    let lone = Stored::new(l, rays, inverse).lone(n, i);
    let before = |c: &Candidate<L::Narrow>| c.possible & c.at.low.le(n.splat(limit));
    let mut descent = Descent::default();
    descent.restart();
    let mut objects = many.broad.clone();
    while let Some(child) = many
        .boxes
        .next::<_, false>(n, &mut descent, &lone.boxes, limit)
    {
        match child {
            Child::Balls(balls) => {
                for from in (0..balls.count).step_by(L::Narrow::COUNT) {
                    if let Some((c, asked, _)) = lone.ask_balls(n, balls, from, limit) {
                        let met = each((before(&c) & asked).bits());
                        objects.extend(met.map(|i| balls.objects[from + i]));
                    }
                }
            }
            Child::Object(k) => {
                let answer = lone.ask_object(n, model, k, limit);
                if answer.is_some_and(|c| before(&c).any()) {
                    objects.push(k);
                }
            }
        }
    }
    Some(objects)
}
