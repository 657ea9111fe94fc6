//! A field along a line, enclosed.

use crate::field::interval_program::{IntervalProgram, Side};
use crate::math::instructions::DoubleLanes;
use crate::math::interval::{Interval, ScalarInterval, down, up};
use crate::math::jet::Jet;
use crate::math::lanes::{Lanes, Mask};
use crate::math::scalar_lane::One;
use crate::root::interval::{Enclosed, PIECES, Pieces};

/// A line base + s · direction in object coordinates, each known within bounds; s ≥ 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnclosedLine {
    /// Where s is 0.
    pub base: [[f64; 2]; 3],
    /// Its change with s.
    pub direction: [[f64; 2]; 3],
}

impl EnclosedLine {
    /// All parallel lines whose base is at most `shift` away in each coordinate.
    pub fn blurred(&self, shift: f64) -> Self {
        let moved = ScalarInterval::splat(One, [-shift, shift]);
        let base = self.base.map(|base| {
            let base = ScalarInterval::splat(One, base) + moved;
            [base.low, base.high]
        });
        Self { base, ..*self }
    }
}

pub struct Along<'a, L: DoubleLanes> {
    lanes: L,
    program: &'a IntervalProgram,
    line: &'a EnclosedLine,
    values: Vec<Interval<L>>,
    jets: Vec<Jet<L>>,
    sides: Vec<Side<L>>,
}

impl<'a, L: DoubleLanes> Along<'a, L> {
    pub fn new(lanes: L, program: &'a IntervalProgram, line: &'a EnclosedLine) -> Self {
        Self {
            lanes,
            program,
            line,
            values: Vec::with_capacity(program.registers()),
            jets: Vec::with_capacity(program.registers()),
            // Few fields jump.
            sides: Vec::new(),
        }
    }

    /// A coordinate for s in an interval without negative numbers.
    #[inline(always)]
    fn coordinate(&self, axis: usize, s: &Interval<L>) -> Interval<L> {
        let l = self.lanes;
        let base = Interval::splat(l, self.line.base[axis]);
        let [d_low, d_high] = self.line.direction[axis];
        if d_low == 0.0 && d_high == 0.0 {
            return base;
        }
        // The smallest product with s ≥ 0 has the smaller s where the direction is positive.
        let smallest = if d_low < 0.0 { s.high } else { s.low };
        let largest = if d_high < 0.0 { s.low } else { s.high };
        let moved = Interval::new(
            l,
            down(l, smallest * l.real(d_low)),
            up(l, largest * l.real(d_high)),
        );
        base + moved
    }

    #[inline(always)]
    fn coordinates(&self, s: &Interval<L>) -> [Interval<L>; 3] {
        [
            self.coordinate(0, s),
            self.coordinate(1, s),
            self.coordinate(2, s),
        ]
    }

    #[inline(always)]
    fn jet(&self, axis: usize, s: &Interval<L>) -> Jet<L> {
        Jet {
            value: self.coordinate(axis, s),
            slope: Interval::splat(self.lanes, self.line.direction[axis]),
        }
    }

    #[inline(always)]
    fn over_lanes(&mut self, from: &[f64], to: &[f64], place: usize, pieces: &mut Pieces) {
        let l = self.lanes;
        let s = Interval::new(l, l.load(from), l.load(to));
        let coordinates = [self.jet(0, &s), self.jet(1, &s), self.jet(2, &s)];
        let (jet, domain) = self.program.jet(l, &coordinates, &mut self.jets);
        l.store(jet.value.low, &mut pieces.value[0][place..]);
        l.store(jet.value.high, &mut pieces.value[1][place..]);
        l.store(jet.slope.low, &mut pieces.slope[0][place..]);
        l.store(jet.slope.high, &mut pieces.slope[1][place..]);
        pieces.broken |= domain.broken.bits() << place;
        pieces.void |= domain.void.bits() << place;
    }

    #[inline(always)]
    fn at_lanes(&mut self, t: &[f64], place: usize, values: &mut [[f64; PIECES]; 2]) {
        let l = self.lanes;
        let s = Interval::point(l, l.load(t));
        let coordinates = self.coordinates(&s);
        let (value, domain) = self.program.value(l, &coordinates, &mut self.values);
        let value = value.whole_where(domain.broken | domain.void);
        l.store(value.low, &mut values[0][place..]);
        l.store(value.high, &mut values[1][place..]);
    }
}

impl<L: DoubleLanes> Enclosed for Along<'_, L> {
    #[inline(always)]
    fn over(&mut self, from: &[f64; PIECES], to: &[f64; PIECES]) -> Pieces {
        let mut pieces = Pieces {
            value: [[0.0; PIECES]; 2],
            slope: [[0.0; PIECES]; 2],
            broken: 0,
            void: 0,
        };
        let lanes = self.lanes;
        stage(
            lanes,
            inlined!(|| {
                for place in (0..PIECES).step_by(L::COUNT) {
                    self.over_lanes(&from[place..], &to[place..], place, &mut pieces);
                }
            }),
        );
        pieces
    }

    fn jumps_over_zero(&mut self, from: f64, to: f64) -> bool {
        let lanes = self.lanes;
        let mut clear = true;
        stage(
            lanes,
            inlined!(|| {
                let s = Interval::splat(lanes, [from, to]);
                let coordinates = self.coordinates(&s);
                for place in (0..PIECES).step_by(L::COUNT) {
                    let (value, void) =
                        self.program
                            .sides(lanes, &coordinates, place, &mut self.sides);
                    clear &= (value.may_be_zero() & !void).bits() == 0;
                }
            }),
        );
        clear
    }

    #[inline(always)]
    fn at(&mut self, t: &[f64; PIECES]) -> [[f64; PIECES]; 2] {
        let mut values = [[0.0; PIECES]; 2];
        let lanes = self.lanes;
        stage(
            lanes,
            inlined!(|| {
                for place in (0..PIECES).step_by(L::COUNT) {
                    self.at_lanes(&t[place..], place, &mut values);
                }
            }),
        );
        values
    }
}

/// The boundary at which code for the instruction set begins.
#[inline(never)]
fn stage<L: Lanes>(l: L, work: impl FnOnce()) {
    l.vectorize(work);
}
