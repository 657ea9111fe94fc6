//! A box that holds all of a surface within its clip box.
//!
//! Cells of the clip box are halved along all axes, and those in which interval arithmetic (Moore
//! 1966, every operation rounded outward) shows that no factor vanishes are dropped. What is left is
//! bounded. A smaller box makes every bound of [`super::program::bounds`] smaller, and rays
//! beside it cost next to nothing.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;
use num_rational::BigRational;

use super::tape::{Algebra, Binary, Tape, Unary};

/// Halvings of the clip box: faces are found to a 64th of it.
const LEVELS: u32 = 6;
/// Most cells looked at for a face; beyond, the outermost that is left is taken.
const MOST_CELLS: usize = 1 << 12;

/// Ends of an interval.
type Interval = [f64; 2];

/// A cell as three intervals.
struct Cell([Interval; 3]);

const EVERYTHING: Interval = [f64::NEG_INFINITY, f64::INFINITY];

fn outward([low, high]: Interval) -> Interval {
    if low.is_nan() || high.is_nan() {
        return EVERYTHING;
    }
    [low.next_down(), high.next_up()]
}

fn hull(values: [f64; 4]) -> Interval {
    if values.iter().any(|v| v.is_nan()) {
        return EVERYTHING;
    }
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    outward([low, high])
}

fn product(a: &Interval, b: &Interval) -> Interval {
    hull([a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]])
}

/// aⁿ: by repeated products of the magnitude, with the sign of odd powers.
fn power(a: &Interval, n: u32) -> Interval {
    let magnitude = |x: f64| (1..n).fold([x, x], |p, _| product(&p, &[x, x]));
    if n == 0 {
        return [1.0; 2];
    }
    let (low, high) = (magnitude(a[0].abs()), magnitude(a[1].abs()));
    if n.is_multiple_of(2) {
        if a[0] <= 0.0 && a[1] >= 0.0 {
            return [0.0, low[1].max(high[1])];
        }
        return [low[0].min(high[0]), low[1].max(high[1])];
    }
    let signed = |x: f64, m: Interval| if x < 0.0 { [-m[1], -m[0]] } else { m };
    [signed(a[0], low)[0], signed(a[1], high)[1]]
}

impl Algebra for Cell {
    type Value = Interval;
    fn coordinate(&self, axis: usize) -> Interval {
        self.0[axis]
    }
    fn constant(&self, _: usize, exact: &BigRational) -> Interval {
        let x = super::program::nearest(exact);
        [x.next_down(), x.next_up()]
    }
    fn unary(&self, function: Unary, a: &Interval) -> Interval {
        match function {
            Unary::Negative => [-a[1], -a[0]],
            _ => EVERYTHING,
        }
    }
    fn binary(&self, function: Binary, a: &Interval, b: &Interval) -> Interval {
        match function {
            Binary::Sum => outward([a[0] + b[0], a[1] + b[1]]),
            Binary::Difference => outward([a[0] - b[1], a[1] - b[0]]),
            Binary::Product => product(a, b),
            Binary::Quotient if b[0] > 0.0 || b[1] < 0.0 => {
                hull([a[0] / b[0], a[0] / b[1], a[1] / b[0], a[1] / b[1]])
            }
            _ => EVERYTHING,
        }
    }
    fn whole_power(&self, a: &Interval, n: i32) -> Interval {
        u32::try_from(n).map_or(EVERYTHING, |n| power(a, n))
    }
}

/// The box; `None` where the surface has been proved to be nowhere in the clip box.
pub fn outer_box(fields: &[Tape], clip: [DVec3; 2]) -> Option<[DVec3; 2]> {
    let mut whole = clip;
    for axis in 0..3 {
        // The faces found so far make the next searches shorter.
        whole[0][axis] = face(fields, whole, axis, false)?;
        whole[1][axis] = face(fields, whole, axis, true)?;
    }
    Some(whole)
}

/// A cell in the order in which a face is searched: the farthest out first, and of those the
/// smallest.
struct Candidate {
    outermost: f64,
    level: u32,
    cell: [DVec3; 2],
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let farther = self.outermost.total_cmp(&other.outermost);
        farther.then(self.level.cmp(&other.level))
    }
}

/// The outermost face of a cell that may hold a zero; `None` where no cell does.
fn face(fields: &[Tape], whole: [DVec3; 2], axis: usize, upper: bool) -> Option<f64> {
    let candidate = |cell: [DVec3; 2], level| Candidate {
        outermost: if upper { cell[1][axis] } else { -cell[0][axis] },
        level,
        cell,
    };
    let mut waiting = BinaryHeap::from([candidate(whole, 0)]);
    let mut scratch = Vec::new();
    for _ in 0..MOST_CELLS {
        let Candidate {
            outermost,
            level,
            cell,
        } = waiting.pop()?;
        if !may_vanish(fields, cell, &mut scratch) {
            continue;
        }
        if level == LEVELS {
            return Some(if upper { outermost } else { -outermost });
        }
        let middle = cell[0] + (cell[1] - cell[0]) / 2.0;
        waiting.extend((0..8).map(|octant| candidate(octant_of(cell, middle, octant), level + 1)));
    }
    let outermost = waiting.pop()?.outermost;
    Some(if upper { outermost } else { -outermost })
}

fn may_vanish(fields: &[Tape], cell: [DVec3; 2], scratch: &mut Vec<Interval>) -> bool {
    let [low, high] = [cell[0].to_array(), cell[1].to_array()];
    let intervals = Cell([0, 1, 2].map(|i| [low[i], high[i]]));
    fields.iter().any(|tape| {
        let value = tape.evaluate(&intervals, scratch);
        value.is_none_or(|[low, high]| !(low > 0.0 || high < 0.0))
    })
}

/// One eighth of a cell.
fn octant_of(cell: [DVec3; 2], middle: DVec3, octant: usize) -> [DVec3; 2] {
    let mut part = cell;
    for axis in 0..3 {
        part[usize::from(octant >> axis & 1 == 0)][axis] = middle[axis];
    }
    part
}
