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
use crate::math::interval::{Interval, ScalarInterval, enclosing_rational};
use crate::math::scalar_lane::One;

/// Halvings of the clip box: faces are found to a 64th of it.
const LEVELS: u32 = 6;
/// Most cells looked at for a face; beyond, the outermost that is left is taken.
const MOST_CELLS: usize = 1 << 12;

struct Cell<'a> {
    axes: [ScalarInterval; 3],
    /// Of the tape, enclosed once.
    constants: &'a [ScalarInterval],
}

/// A tape and its constants, enclosed.
type Field<'a> = (&'a Tape, Vec<ScalarInterval>);

fn everything() -> ScalarInterval {
    Interval::whole(One)
}

impl Algebra for Cell<'_> {
    type Value = ScalarInterval;
    fn coordinate(&self, axis: usize) -> ScalarInterval {
        self.axes[axis]
    }
    fn constant(&self, index: usize, _: &BigRational) -> ScalarInterval {
        self.constants[index]
    }
    fn unary(&self, function: Unary, a: &ScalarInterval) -> ScalarInterval {
        match function {
            Unary::Negative => -*a,
            _ => everything(),
        }
    }
    fn binary(&self, function: Binary, a: &ScalarInterval, b: &ScalarInterval) -> ScalarInterval {
        match function {
            Binary::Sum => *a + *b,
            Binary::Difference => *a - *b,
            Binary::Product => *a * *b,
            Binary::Quotient => *a / *b,
            _ => everything(),
        }
    }
    fn whole_power(&self, a: &ScalarInterval, n: i32) -> ScalarInterval {
        if n < 0 {
            everything()
        } else {
            a.whole_power(n)
        }
    }
}

/// The box; `None` where the surface has been proved to be nowhere in the clip box.
pub fn outer_box(fields: &[Tape], clip: [DVec3; 2]) -> Option<[DVec3; 2]> {
    let enclosed = |c: &BigRational| Interval::splat(One, enclosing_rational(c));
    let constants = |tape: &Tape| tape.constants().iter().map(enclosed).collect();
    let fields: Vec<Field> = fields.iter().map(|tape| (tape, constants(tape))).collect();
    let mut whole = clip;
    for axis in 0..3 {
        // The faces found so far make the next searches shorter.
        whole[0][axis] = face(&fields, whole, axis, false)?;
        whole[1][axis] = face(&fields, whole, axis, true)?;
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
fn face(fields: &[Field], whole: [DVec3; 2], axis: usize, upper: bool) -> Option<f64> {
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

fn may_vanish(fields: &[Field], cell: [DVec3; 2], scratch: &mut Vec<ScalarInterval>) -> bool {
    let [low, high] = [cell[0].to_array(), cell[1].to_array()];
    let axes = [0, 1, 2].map(|i| Interval::splat(One, [low[i], high[i]]));
    fields.iter().any(|(tape, constants)| {
        let value = tape.evaluate(&Cell { axes, constants }, scratch);
        value.is_none_or(|value| value.may_be_zero())
    })
}

fn octant_of(cell: [DVec3; 2], middle: DVec3, octant: usize) -> [DVec3; 2] {
    let mut part = cell;
    for axis in 0..3 {
        part[usize::from(octant >> axis & 1 == 0)][axis] = middle[axis];
    }
    part
}
