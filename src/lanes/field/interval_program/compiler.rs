//! From a tape to a program.

use super::super::tape::{Binary, Operation, Place, Tape, Unary};
use super::arithmetic::Arithmetic;
use super::{IntervalProgram, Step};
use crate::math::interval::{Domain, Interval, ScalarInterval, enclosing_rational};
use crate::math::scalar_lane::One;

pub(super) struct Compiler<'a> {
    tape: &'a Tape,
    steps: Vec<Step>,
    /// The register of each place of the tape.
    register: Vec<Option<Place>>,
}

impl Compiler<'_> {
    pub fn compiled(tape: &Tape) -> IntervalProgram {
        let operations = tape.operations();
        let mut compiler = Compiler {
            tape,
            steps: Vec::new(),
            register: vec![None; operations.len()],
        };
        for (place, &operation) in operations.iter().enumerate() {
            if compiler.register[place].is_none() {
                compiler.compile(place, operation);
            }
        }
        let Compiler {
            mut steps,
            register,
            ..
        } = compiler;
        // The field is to be in the last register.
        if let Some(&Some(register)) = register.last()
            && register + 1 != steps.len()
        {
            steps.push(Step::TimesNumber(register, 1.0));
        }
        IntervalProgram { steps }
    }

    fn compile(&mut self, place: Place, operation: Operation) {
        let step = match operation {
            Operation::Coordinate(axis) => Step::Coordinate(axis),
            Operation::Constant(index) => {
                Step::Constant(enclosing_rational(&self.tape.constants()[index]))
            }
            Operation::Unary(Unary::Sine | Unary::Cosine, a) => return self.angle(place, a),
            Operation::Unary(function, a) => Step::Unary(function, self.at(a)),
            Operation::Binary(function, a, b) => self.binary(function, a, b),
            Operation::WholePower(a, 1) => Step::TimesNumber(self.at(a), 1.0),
            Operation::WholePower(a, 2) => Step::Square(self.at(a)),
            Operation::WholePower(a, n) => Step::WholePower(self.at(a), n),
        };
        self.register[place] = Some(self.steps.len());
        self.steps.push(self.folded(step).unwrap_or(step));
    }

    /// Where an earlier result is; earlier places have registers.
    fn at(&self, place: Place) -> Place {
        self.register.get(place).copied().flatten().unwrap_or(0)
    }

    fn bounds(&self, place: Place) -> Option<[f64; 2]> {
        match self.steps[self.at(place)] {
            Step::Constant(bounds) => Some(bounds),
            _ => None,
        }
    }

    fn number(&self, place: Place) -> Option<f64> {
        let [low, high] = self.bounds(place)?;
        (low == high).then_some(low)
    }

    fn binary(&self, function: Binary, a: Place, b: Place) -> Step {
        let (at_a, at_b) = (self.at(a), self.at(b));
        match function {
            Binary::Product if a == b => Step::Square(at_a),
            Binary::Product => match (self.number(a), self.number(b)) {
                (Some(c), _) => Step::TimesNumber(at_b, c),
                (_, Some(c)) => Step::TimesNumber(at_a, c),
                _ => Step::Binary(function, at_a, at_b),
            },
            Binary::Sum => match (self.bounds(a), self.bounds(b)) {
                (Some(c), _) => Step::PlusConstant(at_b, c),
                (_, Some(c)) => Step::PlusConstant(at_a, c),
                _ => Step::Binary(function, at_a, at_b),
            },
            Binary::Difference => match self.bounds(b) {
                Some([low, high]) => Step::PlusConstant(at_a, [-high, -low]),
                None => Step::Binary(function, at_a, at_b),
            },
            _ => Step::Binary(function, at_a, at_b),
        }
    }

    /// The enclosure of a step that depends on constants alone; none where it may be undefined.
    fn folded(&self, step: Step) -> Option<Step> {
        let constant = |place: Place| match self.steps[place] {
            Step::Constant(bounds) => Some(ScalarInterval::splat(One, bounds)),
            _ => None,
        };
        let mut domain = Domain::unbroken(One);
        let value = match step {
            Step::Unary(function, a) => constant(a)?.unary(function, &mut domain),
            Step::Binary(function, a, b) => {
                constant(a)?.binary(function, constant(b)?, &mut domain)
            }
            Step::WholePower(a, n) => Arithmetic::whole_power(constant(a)?, n, &mut domain),
            Step::Square(a) => constant(a)?.squared(),
            Step::TimesNumber(a, c) => Interval::times_number(constant(a)?, c),
            Step::PlusConstant(a, c) => constant(a)? + ScalarInterval::splat(One, c),
            _ => return None,
        };
        (!domain.broken && !domain.void).then_some(Step::Constant([value.low, value.high]))
    }

    /// Sine and cosine of the same angle are computed together.
    fn angle(&mut self, place: Place, a: Place) {
        let start = self.steps.len();
        self.steps.push(Step::SineCosine(self.at(a)));
        self.steps.push(Step::Filled);
        for (other, operation) in self.tape.operations().iter().enumerate().skip(place) {
            match operation {
                Operation::Unary(Unary::Sine, b) if *b == a => self.register[other] = Some(start),
                Operation::Unary(Unary::Cosine, b) if *b == a => {
                    self.register[other] = Some(start + 1);
                }
                _ => {}
            }
        }
    }
}
