//! Rays against many objects.
//!
//! First a packet asks the few broad objects together. Then its rays go through the hierarchy one by
//! one, and the lanes are boxes, or balls: the answers for a ray depend neither on its neighbours
//! nor on their number.

use super::intersect::{Asked, Blocks, Candidate, Query, Rays, Search, Searches};
use super::model::Many;
use super::pool::{WIDEST, array, each, int_array};
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar};
use crate::math::vec3::Vec3;
use crate::shape::ShapeKind;
use crate::shape::Tally;
use crate::shape::hierarchy::{BoxRay, Child, Descent, WIDTH};
use crate::shape::lanes::LaneRay;
use crate::shape::lanes::balls::Balls;

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
    fn new<L: Lanes<Scalar = T>>(l: L, rays: &Rays<L>, inverse: Vec3<L::Real>) -> Self {
        let arrays = inlined!(|v: Vec3<L::Real>| [array(l, v.x), array(l, v.y), array(l, v.z)]);
        Self {
            origin: arrays(rays.ray.origin),
            direction: arrays(rays.ray.direction),
            inverse: arrays(inverse),
            extent: array(l, rays.ray.extent),
            inverse_square: array(l, rays.ray.inverse_square),
            leaving: int_array(l, rays.leaving),
            inward: rays.inward.bits(),
        }
    }

    /// Ray `i` in all lanes, and as boxes are asked about it.
    #[inline(always)]
    fn alone<N: Lanes<Scalar = T>>(&self, n: N, i: usize) -> (Rays<N>, BoxRay<N>) {
        let one = |vectors: &[[T; WIDEST]; 3]| [vectors[0][i], vectors[1][i], vectors[2][i]];
        let vector = inlined!(|[x, y, z]: [T; 3]| Vec3::new(n.splat(x), n.splat(y), n.splat(z)));
        let origin = one(&self.origin);
        let rays = Rays {
            ray: LaneRay {
                origin: vector(origin),
                direction: vector(one(&self.direction)),
                extent: n.splat(self.extent[i]),
                inverse_square: n.splat(self.inverse_square[i]),
            },
            leaving: n.int(self.leaving[i]),
            inward: n.mask(self.inward >> i & 1 == 1),
        };
        (rays, BoxRay::new(n, origin, one(&self.inverse)))
    }
}

impl<L: Lanes> Query<'_, L> {
    /// About one ray, in the first of lanes that all hold it.
    #[inline(always)]
    fn of_one<'a, N: Lanes<Scalar = L::Scalar>>(&'a self, n: N, rays: &'a Rays<N>) -> Query<'a, N> {
        Query {
            l: n,
            model: self.model,
            rays,
            active: n.mask_from_bits(1),
        }
    }
}

impl<N: Lanes> Query<'_, N> {
    /// Where one ray, the same in all lanes, crosses the balls of a group from place `from` on, but not
    /// the object that is left out; `None` where it surely misses all.
    #[inline(always)]
    fn cross_balls(
        &self,
        (balls, from): (&Balls<N::Scalar>, usize),
        left_out: Option<N::Int>,
        limit: N::Real,
    ) -> Option<Candidate<N>> {
        let (n, rays) = (self.l, self.rays);
        let objects = n.load_int(&balls.objects[from..]);
        let mut asked = balls.present(n, from);
        if let Some(left_out) = left_out {
            asked = asked & !left_out.same(objects);
        }
        let asked = Asked::new(n, objects, ShapeKind::Sphere, rays, asked);
        let span = balls.span(n, from, &rays.ray, asked.all, limit);
        if !asked.met(&span).any() {
            return None;
        }
        Some(asked.candidate(n, &span))
    }
}

impl<R, I> Search<R, I> {
    /// Each number by one of two functions.
    #[inline(always)]
    fn map<S, J>(&self, real: impl Fn(&R) -> S, int: impl Fn(&I) -> J) -> Search<S, J> {
        Search {
            low: real(&self.low),
            high: real(&self.high),
            part: int(&self.part),
            rival: real(&self.rival),
            field_t: real(&self.field_t),
            field_part: int(&self.field_part),
        }
    }
}

impl<T: Scalar> Search<[T; WIDEST], [u32; WIDEST]> {
    /// Writes down what ray `i` has found.
    #[inline(always)]
    fn set(&mut self, i: usize, one: Search<T, u32>) {
        self.low[i] = one.low;
        self.high[i] = one.high;
        self.part[i] = one.part;
        self.rival[i] = one.rival;
        self.field_t[i] = one.field_t;
        self.field_part[i] = one.field_part;
    }
}

impl<T: Scalar> Search<T, u32> {
    /// Where whatever comes later cannot count any more.
    #[inline(always)]
    fn end(&self) -> T {
        if self.field_t < self.high {
            self.field_t
        } else {
            self.high
        }
    }

    /// Takes the crossings of one ray in the lanes of `bits` into account, whose parts are `part_of`.
    #[inline(always)]
    fn take_each<N: Lanes<Scalar = T>>(
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
    query: &Query<'_, L>,
    many: &Many<L::Scalar>,
    tally: &mut Tally,
) -> Searches<L> {
    let l = query.l;
    l.vectorize(inlined!(|| {
        let mut search = query.nothing_yet();
        for &k in &many.broad {
            query.ask_any(&mut search, k, tally);
        }
        let ray = &query.rays.ray;
        let inverse = ray.direction.reciprocal(l);
        let limit = search.field_t.min(search.high);
        let met = query.active & many.boxes.all.meets(l, ray.origin, inverse, limit);
        if !met.any() {
            return search;
        }
        let mut found = search.map(
            inlined!(|x: &L::Real| array(l, *x)),
            inlined!(|x: &L::Int| int_array(l, *x)),
        );
        let n = l.narrow();
        let stored = Stored::new(l, query.rays, inverse);
        let mut descent = Descent::default();
        for i in each(met.bits()) {
            let (rays, boxes) = stored.alone(n, i);
            let query = query.of_one(n, &rays);
            let mut closest = found.map(|x| x[i], |x| x[i]);
            descent.restart();
            search_along(&query, many, (&boxes, &mut descent), &mut closest, tally);
            found.set(i, closest);
        }
        found.map(
            inlined!(|x: &[L::Scalar; WIDEST]| l.load(x)),
            inlined!(|x: &[u32; WIDEST]| l.load_int(x)),
        )
    }))
}

/// Asks what one ray meets the boxes of, nearest boxes first.
#[inline(always)]
fn search_along<N: Lanes>(
    query: &Query<'_, N>,
    many: &Many<N::Scalar>,
    (boxes, descent): (&BoxRay<N>, &mut Descent<N::Scalar>),
    closest: &mut Search<N::Scalar, u32>,
    tally: &mut Tally,
) {
    let (n, model) = (query.l, query.model);
    let first = |object: u32| model.parts.first[object as usize];
    while let Some(child) = many.boxes.next::<N, true>(n, descent, boxes, closest.end()) {
        match child {
            Child::Balls(balls) => {
                for from in (0..balls.count).step_by(N::COUNT) {
                    let limit = n.splat(closest.end());
                    if let Some(c) = query.cross_balls((balls, from), None, limit) {
                        closest.take_each(n, &c, c.possible.bits(), |i| {
                            first(balls.objects[(from + i) % WIDTH])
                        });
                    }
                }
            }
            Child::Object(k) => {
                let limit = n.splat(closest.end());
                if let Some(implicit) = model.implicit(k) {
                    let (t, found) = query.hit_field((k, implicit), query.active, limit, tally);
                    if found.any() {
                        (closest.field_t, closest.field_part) = (n.lane(t, 0), first(k));
                    }
                } else if let Some(c) = query.cross_alone(k, query.active, limit) {
                    let bits = c.possible.bits();
                    closest.take_each(n, &c, bits, |_| n.int_lane(c.part, 0));
                }
            }
        }
    }
}

/// Adds which of the active shadow rays are blocked.
#[inline(never)]
pub(super) fn blocks<L: Lanes>(
    query: &Query<'_, L>,
    many: &Many<L::Scalar>,
    blocks: &mut Blocks<L>,
    tally: &mut Tally,
) {
    let l = query.l;
    l.vectorize(inlined!(|| {
        for &k in many.broad.iter().filter(|k| many.hides[**k as usize]) {
            blocks.ask_any(query, k, tally);
        }
        let ray = &query.rays.ray;
        let inverse = ray.direction.reciprocal(l);
        let met = many.boxes.all.meets(l, ray.origin, inverse, blocks.limit);
        let met = query.active & met & !blocks.blocked;
        if !met.any() {
            return;
        }
        let n = l.narrow();
        let stored = Stored::new(l, query.rays, inverse);
        let (limits, excepted) = (array(l, blocks.limit), int_array(l, blocks.except));
        let mut descent = Descent::default();
        let (mut blocked, mut doubtful) = (0, 0);
        for i in each(met.bits()) {
            let (rays, boxes) = stored.alone(n, i);
            let query = query.of_one(n, &rays);
            let mut own = Blocks::new(n, n.splat(limits[i]), n.int(excepted[i]));
            descent.restart();
            let boxes = (&boxes, &mut descent, limits[i]);
            block_along(&query, many, boxes, &mut own, tally);
            blocked |= u32::from(own.blocked.any()) << i;
            doubtful |= u32::from(own.doubtful.any()) << i;
        }
        blocks.blocked = blocks.blocked | l.mask_from_bits(blocked);
        blocks.doubtful = blocks.doubtful | l.mask_from_bits(doubtful);
    }));
}

/// Asks what one shadow ray meets the boxes of, until it is surely blocked.
#[inline(always)]
fn block_along<N: Lanes>(
    query: &Query<'_, N>,
    many: &Many<N::Scalar>,
    (boxes, descent, limit): (&BoxRay<N>, &mut Descent<N::Scalar>, N::Scalar),
    blocks: &mut Blocks<N>,
    tally: &mut Tally,
) {
    let n = query.l;
    while let Some(child) = many.boxes.next::<N, false>(n, descent, boxes, limit) {
        match child {
            Child::Balls(balls) => {
                for from in (0..balls.count).step_by(N::COUNT) {
                    let except = Some(blocks.except);
                    if let Some(c) = query.cross_balls((balls, from), except, blocks.limit) {
                        blocks.take(&c);
                    }
                }
            }
            Child::Object(k) if many.hides[k as usize] => blocks.ask_any(query, k, tally),
            Child::Object(_) => {}
        }
        if blocks.blocked.any() {
            return;
        }
    }
}

/// The objects that one lane's ray could meet before `limit` for all that lanes know; `None` for
/// all.
#[cold]
pub(super) fn candidates<L: Lanes>(
    query: &Query<'_, L>,
    i: usize,
    limit: L::Scalar,
) -> Option<Vec<u32>> {
    let many = query.model.hierarchy.as_ref()?;
    let n = query.l.narrow();
    let inverse = query.rays.ray.direction.reciprocal(query.l);
    let (rays, boxes) = Stored::new(query.l, query.rays, inverse).alone(n, i);
    let query = query.of_one(n, &rays);
    let end = n.splat(limit);
    let before = |c: &Candidate<L::Narrow>| (c.possible & c.at.low.le(end)).bits();
    let mut descent = Descent::default();
    descent.restart();
    let mut objects = many.broad.clone();
    while let Some(child) = many.boxes.next::<_, false>(n, &mut descent, &boxes, limit) {
        match child {
            Child::Balls(balls) => {
                for from in (0..balls.count).step_by(L::Narrow::COUNT) {
                    if let Some(c) = query.cross_balls((balls, from), None, end) {
                        objects.extend(each(before(&c)).map(|i| balls.objects[from + i]));
                    }
                }
            }
            Child::Object(k) => {
                let answer = query.cross_alone(k, query.active, end);
                if answer.is_some_and(|c| before(&c) != 0) {
                    objects.push(k);
                }
            }
        }
    }
    Some(objects)
}
