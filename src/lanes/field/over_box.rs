//! What can be proved of a field over a box: that it is undefined, that it has no zero, how steep
//! it is at most.

use glam::DVec3;

use super::interval_program::IntervalProgram;
use super::tape::Tape;
use crate::math::instructions::{DoubleLanes, Instructions, Job};
use crate::math::interval::Interval;
use crate::math::jet::Jet;
use crate::math::lanes::Mask;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OverBox {
    /// It is defined nowhere in the box.
    pub undefined: bool,
    /// It may be undefined, or jump, somewhere in the box.
    pub maybe_undefined: bool,
    /// It has no zero in the box.
    pub empty: bool,
    /// An upper bound of the gradient's length: a Lipschitz constant where the field is
    /// continuous; infinite where there is none, or none was found.
    pub steepness: f64,
}

/// Boxes along each edge; the bounds are those of the parts together.
const PARTS: usize = 16;

/// Encloses a field and its gradient over 16³ parts of a box.
pub fn over_box(tape: &Tape, inside: &[DVec3; 2]) -> OverBox {
    survey(Instructions::best(), &IntervalProgram::new(tape), inside)
}

/// The same of a program, on an instruction set.
pub fn survey(
    instructions: Instructions,
    program: &IntervalProgram,
    inside: &[DVec3; 2],
) -> OverBox {
    instructions.run(Survey { program, inside })
}

struct Survey<'a> {
    program: &'a IntervalProgram,
    inside: &'a [DVec3; 2],
}

impl Survey<'_> {
    /// The edges of the parts along an axis; the outermost are those of the box.
    fn edge(&self, axis: usize, i: usize) -> f64 {
        let [low, high] = self.inside.map(|corner| corner[axis]);
        match i {
            0 => low,
            PARTS => high,
            _ => low + (high - low) * (i as f64 / PARTS as f64),
        }
    }
}

impl Job<f64> for Survey<'_> {
    type Output = OverBox;

    #[inline(always)]
    fn run<L: DoubleLanes>(self, l: L) -> OverBox {
        let mut registers = Vec::with_capacity(self.program.registers());
        let mut known = OverBox {
            undefined: true,
            maybe_undefined: false,
            empty: true,
            steepness: 0.0,
        };
        let every = l.mask(true).bits();
        let edges: [[f64; PARTS + 1]; 3] =
            [0, 1, 2].map(|axis| std::array::from_fn(|i| self.edge(axis, i)));
        for part in 0..PARTS * PARTS {
            let (y, z) = (part / PARTS, part % PARTS);
            for x in (0..PARTS).step_by(L::COUNT) {
                let place = [
                    Interval::new(l, l.load(&edges[0][x..]), l.load(&edges[0][x + 1..])),
                    Interval::splat(l, [edges[1][y], edges[1][y + 1]]),
                    Interval::splat(l, [edges[2][z], edges[2][z + 1]]),
                ];
                let mut squares = Interval::splat(l, [0.0, 0.0]);
                for axis in 0..3 {
                    let along = coordinates(&place, axis);
                    let (jet, domain) = self.program.jet(l, &along, &mut registers);
                    squares = squares + jet.slope.squared();
                    known.undefined &= domain.void.bits() == every;
                    known.maybe_undefined |= domain.broken.bits() != 0;
                    known.empty &= (jet.value.may_be_zero() & !domain.void).bits() == 0;
                }
                let length = squares.square_root().high;
                for lane in 0..L::COUNT {
                    known.steepness = known.steepness.max(l.lane(length, lane));
                }
            }
        }
        known
    }
}

/// A box as coordinates that change along one axis.
#[inline(always)]
fn coordinates<L: DoubleLanes>(place: &[Interval<L>; 3], axis: usize) -> [Jet<L>; 3] {
    let l = place[0].lanes;
    let jet = inlined!(|i: usize| {
        let slope = if i == axis { 1.0 } else { 0.0 };
        Jet::new(place[i], Interval::splat(l, [slope, slope]))
    });
    [jet(0), jet(1), jet(2)]
}
