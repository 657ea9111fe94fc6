//! A few objects, asked by whole packets one after the other; of balls each ray asks those that it
//! comes near.

use super::intersect::{Asked, Blocks, Candidate, NOTHING, Query, Searches};
use crate::math::lanes::{Int, Lanes, Mask, Scalar};
use crate::math::lookup::SMALL;
use crate::shape::ShapeKind;
use crate::shape::lanes::LaneShape;
use crate::shape::lanes::balls::Balls;

/// From how many balls on it pays to sort out first which rays come near which of them.
const SEVERAL: usize = 3;

/// The objects of a list, by how they are asked.
#[derive(Debug, Clone)]
pub struct List<T> {
    /// All their numbers, in order.
    pub objects: Vec<u32>,
    /// The objects that packets ask one after the other.
    alone: Vec<u32>,
    groups: Vec<Group<T>>,
}

/// Balls of which each ray asks those that it comes near.
#[derive(Debug, Clone)]
struct Group<T> {
    balls: Balls<T>,
    /// The numbers of their parts.
    parts: [u32; SMALL],
}

impl<T: Scalar> List<T> {
    /// A list of some of the shapes, whose first parts have the numbers `first`.
    pub fn new(objects: Vec<u32>, shapes: &[LaneShape<T>], first: &[u32]) -> Self {
        let is_ball = |k: &u32| shapes[*k as usize].ball().is_some();
        let (balls, others): (Vec<u32>, Vec<u32>) = objects.iter().partition(|k| is_ball(k));
        if balls.len() < SEVERAL {
            return Self {
                alone: objects.clone(),
                groups: Vec::new(),
                objects,
            };
        }
        let group = |objects: &[u32]| {
            let balls = Balls::new(objects, shapes)?;
            let parts = balls.objects.map(|object| first[object as usize]);
            Some(Group { balls, parts })
        };
        Self {
            objects,
            alone: others,
            groups: balls.chunks(SMALL).filter_map(group).collect(),
        }
    }
}

/// The closest hits of the active rays among the objects of the scene's list.
#[inline(always)]
pub(super) fn search<L: Lanes>(query: &Query<'_, L>) -> Searches<L> {
    let (l, ray, list) = (query.l, &query.rays.ray, &query.model.list);
    let mut search = query.nothing_yet();
    for &k in &list.alone {
        query.ask(&mut search, k);
    }
    for group in &list.groups {
        let mut places = group.balls.near(l, ray, [outward(query)], search.high);
        while let Some(found) = group.next(query, query.active, &mut places) {
            query.take(&mut search, &found);
        }
    }
    search
}

/// Adds which of the active shadow rays the scene's occluders block.
#[inline(always)]
pub(super) fn blocks<L: Lanes>(query: &Query<'_, L>, except: L::Int, blocks: &mut Blocks<L>) {
    let (l, ray, list) = (query.l, &query.rays.ray, &query.model.occluders);
    for &k in &list.alone {
        blocks.ask(query, k);
    }
    for group in &list.groups {
        let mut places = group
            .balls
            .near(l, ray, [outward(query), except], blocks.limit);
        while let Some(found) = group.next(query, query.active & !blocks.blocked, &mut places) {
            blocks.take(&found);
        }
    }
}

impl<T: Scalar> Group<T> {
    /// What the next ball of each of the given rays answers; `None` where none has any left.
    #[inline(always)]
    fn next<L: Lanes<Scalar = T>>(
        &self,
        query: &Query<'_, L>,
        active: L::Mask,
        places: &mut L::Int,
    ) -> Option<Candidate<L>> {
        let (l, rays) = (query.l, query.rays);
        let asked = active & !places.same(l.int(0));
        if !asked.any() {
            return None;
        }
        let place = Balls::<T>::take_place(l, places);
        let objects = l.lookup_int(&self.balls.objects, place);
        let asked = Asked::new(l, objects, ShapeKind::Sphere, rays, asked);
        let span = self.balls.span_of(l, place, &rays.ray);
        Some(Candidate {
            part: l.lookup_int(&self.parts, place),
            ..asked.candidate(l, &span)
        })
    }
}

/// The convex object that a ray leaves outward, and so does not meet again; [`NOTHING`] for others.
#[inline(always)]
fn outward<L: Lanes>(query: &Query<'_, L>) -> L::Int {
    let (l, rays) = (query.l, query.rays);
    l.select_int(rays.inward, l.int(NOTHING), rays.leaving)
}
