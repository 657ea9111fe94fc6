//! How objects are shared out among the children of a node.

use super::{Bounds, Item};
use crate::shape::lanes::balls::MOST;

/// Slices of the centres' range in which splits are sought. Finer ones change the expected cost
/// little (Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007, section 3).
const BINS: usize = 16;

/// Some of the objects, which make one child.
struct Part<'a> {
    objects: &'a mut [Item],
    /// Whether one test answers for all.
    one_test: bool,
    /// A guess at the cost of visiting it: the share of rays times the tests.
    cost: f64,
}

impl<'a> Part<'a> {
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

/// Up to `width` parts, none of them empty: of the parts so far, the one that costs most is split
/// where the surface-area heuristic finds it cheapest, or, where not `free`, the largest is halved.
pub fn split(
    objects: &mut [Item],
    width: usize,
    free: bool,
    is_ball: impl Fn(u32) -> bool + Copy,
) -> Vec<&mut [Item]> {
    let mut parts = vec![Part::new(objects, is_ball)];
    while parts.len() < width {
        let weight = |part: &Part<'_>| match (part.one_test, free) {
            (true, _) => -1.0,
            (_, true) => part.cost,
            (_, false) => part.objects.len() as f64,
        };
        let Some(largest) =
            (0..parts.len()).max_by(|&a, &b| weight(&parts[a]).total_cmp(&weight(&parts[b])))
        else {
            break;
        };
        if parts[largest].one_test {
            break;
        }
        let Part { objects, .. } = parts.swap_remove(largest);
        let middle = if free { cheapest(objects) } else { None };
        let middle = middle.unwrap_or_else(|| halved(objects));
        let (a, b) = objects.split_at_mut(middle);
        parts.extend([Part::new(a, is_ball), Part::new(b, is_ball)]);
    }
    let parts = parts.into_iter().map(|part| part.objects);
    parts.filter(|part| !part.is_empty()).collect()
}

/// Twice the centre along an axis.
fn centre(item: &Item, axis: usize) -> f64 {
    item.1.low[axis] + item.1.high[axis]
}

/// Orders the objects so that the first ones, whose number is returned, are one side of the split
/// at the edge of a bin with the least expected tests, Σ area · count (Goldsmith and Salmon,
/// "Automatic Creation of Object Hierarchies for Ray Tracing", 1987; MacDonald and Booth 1990);
/// `None` where all centres coincide.
fn cheapest(objects: &mut [Item]) -> Option<usize> {
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
    let (_, axis, low, scale, edge) = best?;
    // Stable, so that the order depends on the objects alone.
    objects.sort_by_key(|item| bin(item, axis, low, scale) >= edge);
    Some(objects.partition_point(|item| bin(item, axis, low, scale) < edge))
}

fn bin(item: &Item, axis: usize, low: f64, scale: f64) -> usize {
    (((centre(item, axis) - low) * scale) as usize).min(BINS - 1)
}

/// Orders the objects by their centres along the longest side, ties by index, about the middle.
fn halved(objects: &mut [Item]) -> usize {
    let bounds = Bounds::around(&*objects);
    let axis = (bounds.high - bounds.low).max_position();
    let middle = objects.len() / 2;
    objects.select_nth_unstable_by(middle, |a, b| {
        let (first, second) = (centre(a, axis), centre(b, axis));
        first.total_cmp(&second).then_with(|| a.0.cmp(&b.0))
    });
    middle
}
