//! A tape made ready for intervals: constants enclosed once, and operations told apart that can
//! be cheaper or tighter than they look (squares, multiples, sine with cosine).
//!
//! Evaluated over any lanes of f64, as a value alone or with its slope along a line.

mod arithmetic;
mod compiler;

use super::tape::{Binary, Place, Tape, Unary};
use crate::math::instructions::DoubleLanes;
use crate::math::interval::{Domain, Interval};
use crate::math::jet::Jet;
use arithmetic::Arithmetic;
pub use arithmetic::Side;
use compiler::Compiler;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    Coordinate(usize),
    Constant([f64; 2]),
    Unary(Unary, Place),
    Binary(Binary, Place, Place),
    WholePower(Place, i32),
    Square(Place),
    TimesNumber(Place, f64),
    PlusConstant(Place, [f64; 2]),
    /// The sine, and the cosine in the register after it.
    SineCosine(Place),
    /// A register filled by the step before.
    Filled,
}

/// A field, as steps that each fill one register.
#[derive(Debug, Clone, PartialEq)]
pub struct IntervalProgram {
    steps: Vec<Step>,
}

impl IntervalProgram {
    pub fn new(tape: &Tape) -> Self {
        Compiler::new(tape).run()
    }

    /// Whether the field is defined and continuous everywhere, whatever its operands are.
    pub fn is_total(&self) -> bool {
        self.steps.iter().all(|step| match step {
            Step::Unary(function, _) => !matches!(
                function,
                Unary::SquareRoot
                    | Unary::Logarithm
                    | Unary::Tangent
                    | Unary::ArcSine
                    | Unary::ArcCosine
            ),
            Step::Binary(function, ..) => !matches!(
                function,
                Binary::Quotient | Binary::ArcTangent2 | Binary::Power
            ),
            Step::WholePower(_, n) => *n >= 0,
            _ => true,
        })
    }

    /// The number of registers that an evaluation fills.
    pub fn registers(&self) -> usize {
        self.steps.len()
    }

    /// An enclosure of the field over a box; the whole line for an empty program. A stage: one copy
    /// for each instruction set.
    #[inline(never)]
    pub fn value<L: DoubleLanes>(
        &self,
        l: L,
        coordinates: &[Interval<L>; 3],
        registers: &mut Vec<Interval<L>>,
    ) -> (Interval<L>, Domain<L>) {
        l.vectorize(inlined!(|| {
            let mut domain = Domain::unbroken(l);
            let value = self.run(l, coordinates, Interval::whole(l), registers, &mut domain);
            (value, domain)
        }))
    }

    /// Enclosures of the field and of its slope along the coordinates' own slopes. A stage, too.
    #[inline(never)]
    pub fn jet<L: DoubleLanes>(
        &self,
        l: L,
        coordinates: &[Jet<L>; 3],
        registers: &mut Vec<Jet<L>>,
    ) -> (Jet<L>, Domain<L>) {
        l.vectorize(inlined!(|| {
            let anything = Jet::new(Interval::whole(l), Interval::whole(l));
            let mut domain = Domain::unbroken(l);
            let jet = self.run(l, coordinates, anything, registers, &mut domain);
            (jet, domain)
        }))
    }

    /// An enclosure of the field on one combination of sides of its first three operations that
    /// may jump, and where that combination is empty: eight lanes take all of them. The box is to
    /// be the same in each lane; lanes count from `place`.
    #[inline(never)]
    pub fn sides<L: DoubleLanes>(
        &self,
        l: L,
        coordinates: &[Interval<L>; 3],
        place: usize,
        registers: &mut Vec<Side<L>>,
    ) -> (Interval<L>, L::Mask) {
        l.vectorize(inlined!(|| {
            let mut domain = Domain::with_sides(l, place);
            let [x, y, z] = *coordinates;
            let coordinates = [Side(x), Side(y), Side(z)];
            let anything = Side(Interval::whole(l));
            let value = self.run(l, &coordinates, anything, registers, &mut domain);
            (value.0, domain.void)
        }))
    }

    #[inline(always)]
    fn run<L: DoubleLanes, A: Arithmetic<L>>(
        &self,
        l: L,
        coordinates: &[A; 3],
        anything: A,
        registers: &mut Vec<A>,
        domain: &mut Domain<L>,
    ) -> A {
        registers.clear();
        for step in &self.steps {
            let r = &*registers;
            let value = match *step {
                Step::Coordinate(axis) => coordinates[axis],
                Step::Constant(bounds) => A::constant(Interval::splat(l, bounds)),
                Step::Unary(function, a) => r[a].unary(function, domain),
                Step::Binary(function, a, b) => r[a].binary(function, r[b], domain),
                Step::WholePower(a, n) => r[a].whole_power(n, domain),
                Step::Square(a) => r[a].squared(),
                Step::TimesNumber(a, c) => r[a].times_number(c),
                Step::PlusConstant(a, c) => r[a].plus_constant(Interval::splat(l, c)),
                Step::SineCosine(a) => {
                    let (s, c) = r[a].sine_cosine();
                    registers.push(s);
                    c
                }
                Step::Filled => continue,
            };
            registers.push(value);
        }
        registers.last().copied().unwrap_or(anything)
    }
}
