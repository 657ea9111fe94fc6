//! A few objects, asked by whole packets one after the other; of balls each ray asks those that it
//! comes near.

use super::intersect::{Asked, Blocks, Leaving, NOTHING, Rays, Search, candidate};
use super::model::Model;
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
    /// All, in order.
    pub objects: Vec<u32>,
    /// Those that are asked alone.
    alone: Vec<u32>,
    /// Balls that are asked together.
    groups: Vec<Group<T>>,
}

/// Balls that are asked together.
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

/// The closest hits of the active rays among the objects of a list.
#[inline(always)]
pub(super) fn search<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    list: &List<L::Scalar>,
    rays: Rays<'_, L>,
    active: L::Mask,
) -> Search<L> {
    let Rays { ray, leaving } = rays;
    let mut search = Search::new(l);
    for &k in &list.alone {
        search.ask(l, model, k, rays, active);
    }
    for Group { balls, parts } in &list.groups {
        let mut places = balls.near(l, ray, [outward(l, leaving)], search.best.high);
        loop {
            let asked = active & !places.same(l.int(0));
            if !asked.any() {
                break;
            }
            let place = Balls::<L::Scalar>::take_place(l, &mut places);
            let objects = l.lookup_int(&balls.objects, place);
            let asked = Asked::new(l, objects, ShapeKind::Sphere, leaving, asked);
            let found = candidate(l, &balls.span_of(l, place, ray), &asked);
            search.take(l, &found, l.lookup_int(parts, place));
        }
    }
    search
}

/// Adds which of the active shadow rays objects of a list block.
#[inline(always)]
pub(super) fn blocks<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    list: &List<L::Scalar>,
    blocks: &mut Blocks<'_, L>,
    active: L::Mask,
) {
    let (shadow, leaving) = (blocks.shadow, blocks.rays.leaving);
    for &k in &list.alone {
        blocks.ask(l, model, k, active);
    }
    for Group { balls, .. } in &list.groups {
        let left_out = [outward(l, leaving), shadow.except];
        let mut places = balls.near(l, &shadow.ray, left_out, shadow.limit);
        loop {
            let asked = active & !blocks.blocked & !places.same(l.int(0));
            if !asked.any() {
                break;
            }
            let place = Balls::<L::Scalar>::take_place(l, &mut places);
            let objects = l.lookup_int(&balls.objects, place);
            let asked = Asked::new(l, objects, ShapeKind::Sphere, leaving, asked);
            let found = candidate(l, &balls.span_of(l, place, &shadow.ray), &asked);
            blocks.take(&found);
        }
    }
}

/// The convex object that a ray leaves outward, and so does not meet again; [`NOTHING`] for others.
#[inline(always)]
fn outward<L: Lanes>(l: L, leaving: &Leaving<L>) -> L::Int {
    l.select_int(leaving.inward, l.int(NOTHING), leaving.object)
}
