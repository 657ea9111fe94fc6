//! The smallest gap between two objects.

use glam::DVec3;

use super::{Site, faces, reach};
use crate::math::affine::ROUNDED;
use crate::shape::ShapeKind;
use crate::shape::hierarchy::Bounds;

/// Smallest positive gap between two objects: exact for balls beside or inside each other, between
/// bounding boxes for the rest, and where these overlap between parallel faces and round walls (0,
/// which is contact or overlap, does not count); infinite planes are wherever other things are.
///
/// Boxes are halved down to single objects, and pairs of boxes farther apart than the smallest gap
/// so far are left out: about n log n questions, besides those for boxes that overlap.
pub fn smallest(sites: &[Site]) -> Option<f64> {
    let (bounded, unbounded): (Vec<_>, Vec<_>) =
        sites.iter().partition(|site| site.bounds.is_some());
    let items: Vec<Item<'_>> = bounded.into_iter().filter_map(Item::new).collect();
    let mut gap = f64::INFINITY;
    for (i, plane) in unbounded.iter().enumerate() {
        let others = items.iter().map(|item| item.site);
        for other in others.chain(unbounded[i + 1..].iter().copied()) {
            gap = gap.min(between_faces(plane, other));
        }
    }
    let largest = items
        .iter()
        .map(|item| reach(&item.bounds))
        .fold(0.0, f64::max);
    let mut search = Search {
        gap,
        rounding: ROUNDED * largest,
    };
    if let Some(tree) = Tree::new(items) {
        search.within(&tree);
    }
    search.gap.is_finite().then_some(search.gap)
}

/// The same, pair by pair: what [`smallest`] is tested against.
pub fn smallest_pairwise(sites: &[Site]) -> Option<f64> {
    let pairs = (0..sites.len()).flat_map(|i| (0..i).map(move |j| (&sites[i], &sites[j])));
    let gaps = pairs.map(|(a, b)| match (Item::new(a), Item::new(b)) {
        (Some(a), Some(b)) => a.gap(&b),
        _ => between_faces(a, b),
    });
    let gap = gaps.fold(f64::INFINITY, f64::min);
    gap.is_finite().then_some(gap)
}

/// Between parallel faces and round walls, wherever these end; seen from the object that is listed
/// first, so that it does not depend on the order of asking.
fn between_faces(a: &Site, b: &Site) -> f64 {
    let (a, b) = if a.index < b.index { (a, b) } else { (b, a) };
    match (a.kind, b.kind) {
        (Some(kind), Some(other)) => faces::gap((kind, &a.to_world), (other, &b.to_world)),
        _ => f64::INFINITY,
    }
}

/// An object with an end.
struct Item<'a> {
    site: &'a Site,
    bounds: Bounds,
    /// Centre and radius of a ball.
    ball: Option<(DVec3, f64)>,
}

impl<'a> Item<'a> {
    fn new(site: &'a Site) -> Option<Self> {
        let is_ball = site.kind == Some(ShapeKind::Sphere) && site.to_world.is_similarity();
        let radius = || site.to_world.columns()[0].length();
        Some(Self {
            site,
            bounds: site.bounds?,
            ball: is_ball.then(|| (site.to_world.translation(), radius())),
        })
    }

    fn gap(&self, other: &Self) -> f64 {
        let apart = apart(&self.bounds, &other.bounds);
        let between = match (self.ball, other.ball) {
            (Some((c1, r1)), Some((c2, r2))) => {
                let centres = c1.distance(c2);
                (centres - r1 - r2).max((r1 - r2).abs() - centres)
            }
            _ => apart,
        };
        let contact = ROUNDED * reach(&self.bounds).max(reach(&other.bounds));
        let beside = if between > contact {
            between
        } else {
            f64::INFINITY
        };
        if apart > 0.0 {
            return beside;
        }
        beside.min(between_faces(self.site, other.site))
    }
}

/// Distance between two boxes; 0 where they touch or overlap.
fn apart(a: &Bounds, b: &Bounds) -> f64 {
    let apart = (b.low - a.high).max(a.low - b.high);
    apart.max(DVec3::ZERO).length()
}

/// Objects, halved again and again.
struct Tree<'a> {
    bounds: Bounds,
    node: Node<'a>,
}

enum Node<'a> {
    Object(Item<'a>),
    Halves(Box<[Tree<'a>; 2]>),
}

impl<'a> Tree<'a> {
    /// `None` over nothing.
    fn new(mut items: Vec<Item<'a>>) -> Option<Self> {
        let boxes = items.iter().map(|item| item.bounds);
        let bounds = boxes.reduce(Bounds::union)?;
        let half = items.len() / 2;
        if half == 0 {
            let node = Node::Object(items.pop()?);
            return Some(Self { bounds, node });
        }
        let axis = (bounds.high - bounds.low).max_position();
        let middle = |item: &Item<'_>| item.bounds.low[axis] + item.bounds.high[axis];
        items.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
        let upper = items.split_off(half);
        let node = Node::Halves(Box::new([Self::new(items)?, Self::new(upper)?]));
        Some(Self { bounds, node })
    }

    /// Length of the box's diagonal.
    fn size(&self) -> f64 {
        (self.bounds.high - self.bounds.low).length()
    }
}

struct Search {
    /// The smallest gap so far.
    gap: f64,
    /// What distances between boxes and between balls in them may be rounded by.
    rounding: f64,
}

impl Search {
    /// Takes all pairs of a tree.
    fn within(&mut self, tree: &Tree<'_>) {
        if let Node::Halves(halves) = &tree.node {
            let [a, b] = &**halves;
            self.within(a);
            self.within(b);
            self.between(a, b);
        }
    }

    /// Takes all pairs from two trees that may be closer.
    fn between(&mut self, a: &Tree<'_>, b: &Tree<'_>) {
        if apart(&a.bounds, &b.bounds) > self.gap + self.rounding {
            return;
        }
        let (whole, halves) = match (&a.node, &b.node) {
            (Node::Object(a), Node::Object(b)) => {
                self.gap = self.gap.min(a.gap(b));
                return;
            }
            (Node::Object(_), Node::Halves(halves)) => (a, halves),
            (Node::Halves(halves), Node::Object(_)) => (b, halves),
            (Node::Halves(_), Node::Halves(halves)) if b.size() > a.size() => (a, halves),
            (Node::Halves(halves), Node::Halves(_)) => (b, halves),
        };
        let [near, far] = &**halves;
        self.between(whole, near);
        self.between(whole, far);
    }
}
