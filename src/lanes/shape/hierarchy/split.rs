//! How objects are shared out among the children of a node.

use super::{Bounds, Item, WIDTH};
use crate::shape::lanes::balls::MOST;

/// Slices of the centres' range in which splits are sought. Finer ones change the expected cost
/// little (Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007, section 3).
const BINS: usize = 16;

/// Objects that make one child.
struct Group<'a> {
    objects: &'a mut [Item],
    /// Whether one test answers for all.
    one_test: bool,
    /// Estimated cost: the area, to which the number of rays is proportional, times the objects.
    cost: f64,
}

impl<'a> Group<'a> {
    fn new(objects: &'a mut [Item], is_ball: impl Fn(u32) -> bool) -> Self {
        let one_test = match objects {
            [] | [_] => true,
            _ => objects.len() <= MOST && objects.iter().all(|(k, _)| is_ball(*k)),
        };
        Self {
            one_test,
            cost: Bounds::around(&*objects).half_area() * objects.len() as f64,
            objects,
        }
    }
}

/// Largest cost, over that of the cheapest split, at which one is taken that fills the nodes below.
/// Otherwise the lowest nodes are half full on average, and so up to twice as many.
const FULL: f64 = 1.25;

/// Up to [`WIDTH`] parts, none of them empty: of the parts so far that are more than a full child, the
/// one that costs most is split where the surface-area heuristic finds it cheapest, or, where not
/// `free`, the largest is halved.
pub fn split(
    objects: &mut [Item],
    free: bool,
    is_ball: impl Fn(u32) -> bool + Copy,
) -> Vec<&mut [Item]> {
    // A full child has the largest power of WIDTH below the number of objects.
    let mut full = 1;
    while full * WIDTH < objects.len() {
        full *= WIDTH;
    }
    let mut parts = vec![Group::new(objects, is_ball)];
    while parts.len() < WIDTH {
        let is_done = |part: &Group<'_>| part.one_test || (free && part.objects.len() <= full);
        let weight = |part: &Group<'_>| match (is_done(part), free) {
            (true, _) => -1.0,
            (_, true) => part.cost,
            (_, false) => part.objects.len() as f64,
        };
        let Some(largest) =
            (0..parts.len()).max_by(|&a, &b| weight(&parts[a]).total_cmp(&weight(&parts[b])))
        else {
            break;
        };
        if is_done(&parts[largest]) {
            break;
        }
        let Group { objects, .. } = parts.swap_remove(largest);
        let middle = if free { cheapest(objects, full) } else { None };
        let middle = middle.unwrap_or_else(|| halved(objects));
        let (a, b) = objects.split_at_mut(middle);
        parts.extend([Group::new(a, is_ball), Group::new(b, is_ball)]);
    }
    let parts = parts.into_iter().map(|part| part.objects);
    parts.filter(|part| !part.is_empty()).collect()
}

/// Twice the centre along an axis.
fn centre(item: &Item, axis: usize) -> f64 {
    item.1.low[axis] + item.1.high[axis]
}

/// Orders the objects so that the first ones, whose number is returned, are one side of the split
/// at the edge of a bin with the lowest cost, Σ area · count (Goldsmith and Salmon,
/// "Automatic Creation of Object Hierarchies for Ray Tracing", 1987; MacDonald and Booth 1990);
/// or at a multiple of `full` along the same axis that costs hardly more; `None` where all centres
/// coincide.
fn cheapest(objects: &mut [Item], full: usize) -> Option<usize> {
    let mut best: Option<(f64, usize, f64, f64, usize)> = None;
    for axis in 0..3 {
        let (low, high) = objects
            .iter()
            .map(|item| centre(item, axis))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| {
                (low.min(c), high.max(c))
            });
        let scale = BINS as f64 / (high - low);
        if !(high > low && scale.is_finite()) {
            continue;
        }
        let mut bins = [(Bounds::NOTHING, 0usize); BINS];
        for item in &*objects {
            let (bounds, count) = &mut bins[bin(item, axis, low, scale)];
            *bounds = bounds.union(item.1);
            *count += 1;
        }
        let mut above = [0.0; BINS];
        let mut side = (Bounds::NOTHING, 0);
        for i in (1..BINS).rev() {
            side = (side.0.union(bins[i].0), side.1 + bins[i].1);
            above[i] = side.0.half_area() * side.1 as f64;
        }
        let mut side = (Bounds::NOTHING, 0);
        for i in 1..BINS {
            side = (side.0.union(bins[i - 1].0), side.1 + bins[i - 1].1);
            let cost = side.0.half_area().mul_add(side.1 as f64, above[i]);
            let both = side.1 > 0 && side.1 < objects.len();
            if both && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, low, scale, i));
            }
        }
    }
    let (cost, axis, low, scale, edge) = best?;
    sort(objects, axis);
    if let Some((dear, middle)) = filling(objects, full)
        && dear <= FULL * cost
    {
        return Some(middle);
    }
    // The bins are in the order of the centres.
    Some(objects.partition_point(|item| bin(item, axis, low, scale) < edge))
}

/// The cost of the cheapest split of ordered objects at a multiple of `full`, and the split.
fn filling(objects: &[Item], full: usize) -> Option<(f64, usize)> {
    let blocks: Vec<Bounds> = objects.chunks(full).map(Bounds::around).collect();
    let mut above = vec![Bounds::NOTHING; blocks.len() + 1];
    for (i, block) in blocks.iter().enumerate().rev() {
        above[i] = above[i + 1].union(*block);
    }
    let mut below = Bounds::NOTHING;
    let mut best: Option<(f64, usize)> = None;
    for i in 1..blocks.len() {
        below = below.union(blocks[i - 1]);
        let middle = i * full;
        let rest = (objects.len() - middle) as f64;
        let cost = below
            .half_area()
            .mul_add(middle as f64, above[i].half_area() * rest);
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, middle));
        }
    }
    best
}

/// Orders by centres along an axis, ties by index.
fn sort(objects: &mut [Item], axis: usize) {
    objects.sort_unstable_by(|a, b| {
        let (first, second) = (centre(a, axis), centre(b, axis));
        first.total_cmp(&second).then_with(|| a.0.cmp(&b.0))
    });
}

fn bin(item: &Item, axis: usize, low: f64, scale: f64) -> usize {
    (((centre(item, axis) - low) * scale) as usize).min(BINS - 1)
}

/// Orders the objects by their centres along the longest side, ties by index, about the middle.
fn halved(objects: &mut [Item]) -> usize {
    let bounds = Bounds::around(&*objects);
    let axis = (bounds.high - bounds.low).max_position();
    let middle = objects.len() / 2;
    sort(objects, axis);
    middle
}
