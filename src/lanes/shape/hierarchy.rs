//! A hierarchy of bounding boxes for scenes of many objects.
//!
//! Nodes have [`WIDTH`] children, whose boxes are tested together: lanes are boxes, since the rays of
//! a packet share no way after the first bounce. A child is a node, up to [`WIDTH`] balls that are
//! tested together too, or one object of another shape. Every bound is outward, so that an object is
//! skipped only if the ray surely misses its box.

mod split;

use glam::DVec3;

use super::lanes::LaneShape;
use super::lanes::balls::{Balls, MOST};
use crate::math::affine::Affine;
use crate::math::lanes::{Lanes, Mask, Real, Scalar};
use crate::math::vec3::Vec3;
use split::split;

/// Children of a node.
pub const WIDTH: usize = MOST;
/// Levels whose nodes are split where it saves most; deeper nodes, of which only strange scenes have
/// any, are halved.
const FREE_LEVELS: usize = 12;
/// Levels below those of a tree over 2³² objects: each of 16 children has at most an eighth of its
/// node's objects.
const HALVED_LEVELS: usize = 11;
/// Most entries that wait while a ray descends.
const STACK: usize = (FREE_LEVELS + HALVED_LEVELS) * (WIDTH - 1) + 1;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    pub low: DVec3,
    pub high: DVec3,
}

impl Bounds {
    const NOTHING: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    pub fn around<'a>(items: impl IntoIterator<Item = &'a Item>) -> Self {
        let boxes = items.into_iter().map(|(_, bounds)| *bounds);
        boxes.fold(Self::NOTHING, Self::union)
    }

    /// Around the image of the box from `low` to `high`.
    pub fn of_image(to_world: &Affine, low: DVec3, high: DVec3) -> Self {
        let centre = to_world.point((low + high) / 2.0);
        let half = (high - low) / 2.0;
        let reach = to_world.abs().vector(half);
        Self {
            low: centre - reach,
            high: centre + reach,
        }
    }

    /// Around the same image, whatever rounding has done to it: centre and reach are each off by at
    /// most 5 roundings of the largest magnitude on the way, their sum by two more; 16 pay for this
    /// number's own.
    pub fn around_image(to_world: &Affine, low: DVec3, high: DVec3) -> Self {
        let image = Self::of_image(to_world, low, high);
        let farthest = low.abs().max(high.abs());
        let error = 16.0 * f64::ROUNDOFF * to_world.abs().point(farthest);
        Self {
            low: image.low - error,
            high: image.high + error,
        }
    }

    /// Half its surface, to which the number of random lines that meet it is proportional; 0 for
    /// nothing.
    pub fn half_area(&self) -> f64 {
        let side = (self.high - self.low).max(DVec3::ZERO);
        side.x * side.y + side.y * side.z + side.z * side.x
    }
}

/// A box in the numbers of the loop, rounded outward.
#[derive(Debug, Clone, Copy, Default)]
pub struct OuterBox<T> {
    /// Lower and upper ends by axis.
    ends: [[T; 2]; 3],
}

impl<T: Scalar> OuterBox<T> {
    pub fn new(bounds: &Bounds) -> Self {
        Self {
            ends: [0, 1, 2].map(|axis| outward(bounds.low[axis], bounds.high[axis])),
        }
    }

    /// Which rays, one a lane, may meet the box before their limits: no ray that does is left out.
    /// `inverse` are the reciprocals of the direction's components.
    #[inline(always)]
    pub fn meets<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        origin: Vec3<L::Real>,
        inverse: Vec3<L::Real>,
        limit: L::Real,
    ) -> L::Mask {
        let zero = l.real(0.0);
        let (mut near, mut far) = (zero, limit);
        let axes = [
            (origin.x, inverse.x),
            (origin.y, inverse.y),
            (origin.z, inverse.z),
        ];
        for (ends, (o, inverse)) in self.ends.iter().zip(axes) {
            let (low, high) = (l.splat(ends[0]), l.splat(ends[1]));
            let backwards = inverse.lt(zero);
            let ends = [
                l.select(backwards, high, low),
                l.select(backwards, low, high),
            ];
            narrow::<L>(&mut near, &mut far, ends, o, inverse);
        }
        met(l, near, far).1
    }
}

/// An object's index and its box.
pub type Item = (u32, Bounds);

#[derive(Debug, Clone, Copy)]
pub enum Child<'a, T> {
    Balls(&'a Balls<T>),
    /// An object of another shape.
    Object(u32),
}

/// A child in a word: the kind in the highest two bits, below them an index.
mod word {
    pub const NODE: u32 = 0;
    pub const BALLS: u32 = 1 << 30;
    pub const OBJECT: u32 = 2 << 30;
    pub const KIND: u32 = 3 << 30;
    pub const EMPTY: u32 = u32::MAX;
}

#[derive(Debug, Clone)]
struct Node<T> {
    low: [[T; WIDTH]; 3],
    high: [[T; WIDTH]; 3],
    child: [u32; WIDTH],
}

#[derive(Debug, Clone, Default)]
pub struct Hierarchy<T> {
    nodes: Vec<Node<T>>,
    balls: Vec<Balls<T>>,
    pub all: OuterBox<T>,
}

/// One ray for box tests, the same in all lanes.
#[derive(Clone, Copy)]
pub struct BoxRay<L: Lanes> {
    origin: [L::Real; 3],
    inverse: [L::Real; 3],
    backwards: [bool; 3],
}

impl<L: Lanes> BoxRay<L> {
    /// From the origin and the reciprocals of the direction's components.
    #[inline(always)]
    pub fn new(l: L, origin: [L::Scalar; 3], inverse: [L::Scalar; 3]) -> Self {
        let zero = L::Scalar::default();
        let splat = inlined!(|x: L::Scalar| l.splat(x));
        Self {
            origin: origin.map(&splat),
            inverse: inverse.map(&splat),
            backwards: inverse.map(inlined!(|x| x < zero)),
        }
    }
}

/// Where rays are on their way through a hierarchy, one after the other.
pub struct Descent<T> {
    /// Children to visit and where the ray enters their boxes.
    stack: [(T, u32); STACK],
    length: usize,
}

impl<T: Scalar> Descent<T> {
    /// Puts the next ray at the root.
    #[inline(always)]
    pub fn restart(&mut self) {
        self.stack[0] = (T::default(), word::NODE);
        self.length = 1;
    }

    /// Puts a child on the stack; in order among those of its node, which lie from `bottom` on,
    /// nearest on top.
    #[inline(always)]
    fn push<const ORDERED: bool>(&mut self, bottom: usize, near: T, child: u32) {
        let mut at = self.length;
        self.length += 1;
        while ORDERED && at > bottom && self.stack[at - 1].0 < near {
            self.stack[at] = self.stack[at - 1];
            at -= 1;
        }
        self.stack[at] = (near, child);
    }
}

impl<T: Scalar> Default for Descent<T> {
    #[inline(always)]
    fn default() -> Self {
        Self {
            stack: [(T::default(), 0); STACK],
            length: 0,
        }
    }
}

impl<T: Scalar> Hierarchy<T> {
    /// Builds the boxes over objects of the given shapes.
    pub fn new(objects: &[Item], shapes: &[LaneShape<T>]) -> Self {
        let mut hierarchy = Self {
            nodes: Vec::new(),
            balls: Vec::new(),
            all: OuterBox::new(&Bounds::around(objects)),
        };
        let mut order = objects.to_vec();
        hierarchy.node(&mut order, shapes, 0);
        hierarchy
    }

    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node<T>>() + self.balls.len() * size_of::<Balls<T>>()
    }

    /// Adds a node over objects, and all below it.
    fn node(&mut self, objects: &mut [Item], shapes: &[LaneShape<T>], level: usize) -> u32 {
        let index = self.nodes.len();
        // An inverted box is missed by every ray.
        self.nodes.push(Node {
            low: [[T::from_f64(f64::INFINITY); WIDTH]; 3],
            high: [[T::from_f64(f64::NEG_INFINITY); WIDTH]; 3],
            child: [word::EMPTY; WIDTH],
        });
        let is_ball = |object: u32| {
            shapes
                .get(object as usize)
                .is_some_and(|s| s.ball().is_some())
        };
        let parts = split(objects, WIDTH, level < FREE_LEVELS, is_ball);
        for (i, part) in parts.into_iter().enumerate() {
            let bounds = Bounds::around(&*part);
            let child = self.child(part, shapes, level);
            let node = &mut self.nodes[index];
            node.child[i] = child;
            for axis in 0..3 {
                [node.low[axis][i], node.high[axis][i]] =
                    outward(bounds.low[axis], bounds.high[axis]);
            }
        }
        index as u32
    }

    /// The word of a child that stands for objects.
    fn child(&mut self, objects: &mut [Item], shapes: &[LaneShape<T>], level: usize) -> u32 {
        let numbers: Vec<u32> = objects.iter().take(MOST + 1).map(|(k, _)| *k).collect();
        if let Some(balls) = Balls::new(&numbers, shapes) {
            self.balls.push(balls);
            return word::BALLS | (self.balls.len() - 1) as u32;
        }
        match *numbers {
            [object] => word::OBJECT | object,
            _ => word::NODE | self.node(objects, shapes, level + 1),
        }
    }

    /// What the ray meets the box of before `limit` next: nearest boxes first, where `ORDERED`, so that
    /// a hit may save the others.
    #[inline(always)]
    pub fn next<L: Lanes<Scalar = T>, const ORDERED: bool>(
        &self,
        l: L,
        descent: &mut Descent<T>,
        ray: &BoxRay<L>,
        limit: T,
    ) -> Option<Child<'_, T>> {
        while descent.length > 0 {
            descent.length -= 1;
            let (near, child) = descent.stack[descent.length];
            if near > limit {
                continue;
            }
            let index = child & !word::KIND;
            match child & word::KIND {
                word::NODE => self.open::<L, ORDERED>(l, descent, ray, limit, index),
                word::BALLS => return Some(Child::Balls(&self.balls[index as usize])),
                _ => return Some(Child::Object(index)),
            }
        }
        None
    }

    /// Puts the children of a node that the ray meets before `limit` on the stack.
    #[inline(always)]
    fn open<L: Lanes<Scalar = T>, const ORDERED: bool>(
        &self,
        l: L,
        descent: &mut Descent<T>,
        ray: &BoxRay<L>,
        limit: T,
        node: u32,
    ) {
        let node = &self.nodes[node as usize];
        let bottom = descent.length;
        for from in (0..WIDTH).step_by(L::COUNT) {
            let mut near = l.real(0.0);
            let mut far = l.splat(limit);
            for axis in 0..3 {
                let (mut first, mut last) = (&node.low[axis], &node.high[axis]);
                if ray.backwards[axis] {
                    (first, last) = (last, first);
                }
                let ends = [l.load(&first[from..]), l.load(&last[from..])];
                narrow::<L>(
                    &mut near,
                    &mut far,
                    ends,
                    ray.origin[axis],
                    ray.inverse[axis],
                );
            }
            let (near, met) = met(l, near, far);
            let mut met = met.bits();
            let mut entries = [T::default(); WIDTH];
            l.store(near, &mut entries);
            while met != 0 {
                let i = met.trailing_zeros() as usize % WIDTH;
                met &= met - 1;
                descent.push::<ORDERED>(bottom, entries[i], node.child[(from + i) % WIDTH]);
            }
        }
    }
}

/// Narrows the part of a ray that is in a box by a slab, given by where the ray enters and leaves it.
#[inline(always)]
fn narrow<L: Lanes>(
    near: &mut L::Real,
    far: &mut L::Real,
    [first, last]: [L::Real; 2],
    origin: L::Real,
    inverse: L::Real,
) {
    // 0 · ∞, a ray in the plane of a face, bounds nothing.
    *near = ((first - origin) * inverse).max(*near);
    *far = ((last - origin) * inverse).min(*far);
}

/// Where a box is entered at the earliest, and whether it may be met at all.
#[inline(always)]
fn met<L: Lanes>(l: L, near: L::Real, far: L::Real) -> (L::Real, L::Mask) {
    // (b − o)/d is off by at most 3u of itself, and these products by one more; doubled.
    let slack = 8.0 * L::Scalar::ROUNDOFF;
    let near = near * l.real(1.0 - slack);
    (near, near.le(far * l.real(1.0 + slack)))
}

/// The numbers of the type that enclose an interval, with room to spare.
fn outward<T: Scalar>(low: f64, high: f64) -> [T; 2] {
    let slack = |x: f64| x.abs() * (2.0 * T::ROUNDOFF + 1e-14) + f64::MIN_POSITIVE;
    [low - slack(low), high + slack(high)].map(T::from_f64)
}
