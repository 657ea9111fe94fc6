//! A hierarchy of bounding boxes for scenes of many objects.
//!
//! Nodes have [`WIDTH`] children, whose boxes are tested together: one ray, many boxes, since the
//! rays of a packet share no way after the first bounce. Every bound is outward, so that an object
//! is skipped only if the ray surely misses its box.

use glam::DVec3;

use crate::math::lanes::Scalar;

/// Children of a node.
pub const WIDTH: usize = 8;
/// Marks a child that is an object.
const OBJECT: u32 = 1 << 31;
/// Marks a place without a child.
const EMPTY: u32 = u32::MAX;
/// Levels of a tree over 2³¹ objects, each but the last of which splits at least in two.
const DEEPEST: usize = 31;
/// Most entries that wait while a ray descends.
const STACK: usize = DEEPEST * (WIDTH - 1) + 1;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub low: DVec3,
    /// Upper corner.
    pub high: DVec3,
}

/// An object's index and its box.
type Item = (u32, Bounds);

#[derive(Debug, Clone)]
struct Node<T> {
    low: [[T; WIDTH]; 3],
    high: [[T; WIDTH]; 3],
    child: [u32; WIDTH],
}

/// Boxes over objects.
#[derive(Debug, Clone, Default)]
pub struct Hierarchy<T> {
    nodes: Vec<Node<T>>,
}

/// A ray for box tests.
#[derive(Clone, Copy)]
pub struct BoxRay<T> {
    origin: [T; 3],
    inverse: [T; 3],
}

impl<T: Scalar> BoxRay<T> {
    /// From origin and direction.
    #[inline(always)]
    pub fn new(origin: [T; 3], direction: [T; 3]) -> Self {
        let one = T::from_f64(1.0);
        Self {
            origin,
            inverse: direction.map(
                #[inline(always)]
                |d| one / d,
            ),
        }
    }
}

/// Where one ray is on its way through a hierarchy.
pub struct Descent<T> {
    stack: [(T, u32); STACK],
    length: usize,
}

impl<T: Scalar> Descent<T> {
    /// At the root, or nowhere for a ray that is not asked about.
    #[inline(always)]
    pub fn new(active: bool) -> Self {
        Self {
            stack: [(T::default(), 0); STACK],
            length: usize::from(active),
        }
    }
}

impl<T: Scalar> Hierarchy<T> {
    /// Builds the boxes over objects: ranges are halved at the median along their longest side,
    /// three times a node.
    pub fn new(objects: &[(u32, Bounds)]) -> Self {
        let mut hierarchy = Self { nodes: Vec::new() };
        let mut order = objects.to_vec();
        hierarchy.node(&mut order);
        hierarchy
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node<T>>()
    }

    fn node(&mut self, objects: &mut [Item]) -> u32 {
        let index = self.nodes.len();
        // An inverted box is missed by every ray.
        self.nodes.push(Node {
            low: [[T::from_f64(f64::INFINITY); WIDTH]; 3],
            high: [[T::from_f64(f64::NEG_INFINITY); WIDTH]; 3],
            child: [EMPTY; WIDTH],
        });
        let mut parts = vec![objects];
        while parts.len() < WIDTH {
            let Some(largest) = (0..parts.len()).max_by_key(|&i| parts[i].len()) else {
                break;
            };
            if parts[largest].len() < 2 {
                break;
            }
            let part = parts.swap_remove(largest);
            let (a, b) = halves(part);
            parts.extend([a, b]);
        }
        for (i, part) in parts.into_iter().enumerate() {
            let bounds = union(part);
            let child = match part {
                [] => continue,
                [(object, _)] => *object | OBJECT,
                _ => self.node(part),
            };
            let node = &mut self.nodes[index];
            node.child[i] = child;
            for axis in 0..3 {
                let (low, high) = outward::<T>(bounds.low[axis], bounds.high[axis]);
                node.low[axis][i] = low;
                node.high[axis][i] = high;
            }
        }
        index as u32
    }

    /// The next object whose box the ray meets before `limit`, nearest boxes first.
    #[inline(always)]
    pub fn next(&self, descent: &mut Descent<T>, ray: &BoxRay<T>, limit: T) -> Option<u32> {
        while descent.length > 0 {
            descent.length -= 1;
            let (near, child) = descent.stack[descent.length];
            if near > limit {
                continue;
            }
            if child & OBJECT != 0 {
                return Some(child & !OBJECT);
            }
            self.open(descent, ray, limit, child);
        }
        None
    }

    /// Puts the children of a node that the ray meets on the stack, nearest on top.
    #[inline(always)]
    fn open(&self, descent: &mut Descent<T>, ray: &BoxRay<T>, limit: T, node: u32) {
        let node = &self.nodes[node as usize];
        let mut near = [T::default(); WIDTH];
        let mut far = [limit; WIDTH];
        // (b − o)/d is off by at most 3u of itself.
        let slack = T::from_f64(4.0 * T::ROUNDOFF);
        for axis in 0..3 {
            let (o, inverse) = (ray.origin[axis], ray.inverse[axis]);
            for i in 0..WIDTH {
                let a = (node.low[axis][i] - o) * inverse;
                let b = (node.high[axis][i] - o) * inverse;
                let (first, last) = if a < b { (a, b) } else { (b, a) };
                let first = first - slack * magnitude(first);
                let last = last + slack * magnitude(last);
                // 0 · ∞, a ray in the plane of a face, compares false and bounds nothing.
                near[i] = if first > near[i] { first } else { near[i] };
                far[i] = if last < far[i] { last } else { far[i] };
            }
        }
        let bottom = descent.length;
        for i in 0..WIDTH {
            if node.child[i] == EMPTY || near[i] > far[i] {
                continue;
            }
            let mut at = descent.length;
            descent.length += 1;
            while at > bottom && descent.stack[at - 1].0 < near[i] {
                descent.stack[at] = descent.stack[at - 1];
                at -= 1;
            }
            descent.stack[at] = (near[i], node.child[i]);
        }
    }
}

#[inline(always)]
fn magnitude<T: Scalar>(x: T) -> T {
    let zero = T::default();
    if x < zero { zero - x } else { x }
}

/// The numbers of the type that enclose an interval, with room for the rounding of the bounds
/// themselves (a matrix product: a few 2⁻⁵³).
fn outward<T: Scalar>(low: f64, high: f64) -> (T, T) {
    let slack = |x: f64| x.abs() * (2.0 * T::ROUNDOFF + 1e-14) + f64::MIN_POSITIVE;
    (
        T::from_f64(low - slack(low)),
        T::from_f64(high + slack(high)),
    )
}

fn union(objects: &[Item]) -> Bounds {
    let mut all = Bounds {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };
    for (_, bounds) in objects {
        all.low = all.low.min(bounds.low);
        all.high = all.high.max(bounds.high);
    }
    all
}

/// Two halves by the order of the centres along the longest side, ties by index.
fn halves(objects: &mut [Item]) -> (&mut [Item], &mut [Item]) {
    let bounds = union(objects);
    let sides = bounds.high - bounds.low;
    let axis = sides.max_position();
    let middle = objects.len() / 2;
    objects.select_nth_unstable_by(middle, |a, b| {
        let centre = |b: &Bounds| b.low[axis] + b.high[axis];
        centre(&a.1)
            .total_cmp(&centre(&b.1))
            .then_with(|| a.0.cmp(&b.0))
    });
    objects.split_at_mut(middle)
}
