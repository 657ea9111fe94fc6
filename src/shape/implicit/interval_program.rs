//! A tape made ready for intervals: constants enclosed once, and operations told apart that can
//! be cheaper or tighter than they look (squares, multiples, sine with cosine).
//!
//! Evaluated over any lanes of f64, as a value alone or with its slope along a line.

use super::tape::{Binary, Operation, Place, Tape, Unary};
use crate::math::instructions::DoubleLanes;
use crate::math::interval::{Domain, Interval, ScalarInterval, enclosing_rational};
use crate::math::jet::Jet;
use crate::math::scalar_lane::One;

/// One operation on registers.
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

/// The arithmetic of a program: intervals, or intervals with slopes.
trait Arithmetic<L: DoubleLanes>: Copy {
    fn constant(value: Interval<L>) -> Self;
    fn unary(self, function: Unary, domain: &mut Domain<L>) -> Self;
    fn binary(self, function: Binary, other: Self, domain: &mut Domain<L>) -> Self;
    fn whole_power(self, n: i32, domain: &mut Domain<L>) -> Self;
    fn squared(self) -> Self;
    fn times_number(self, c: f64) -> Self;
    fn plus_constant(self, c: Interval<L>) -> Self;
    fn sine_cosine(self) -> (Self, Self);
}

/// Functions of one value, one copy for each instruction set: they are long.
#[inline(never)]
fn function_of<L: DoubleLanes>(
    function: Unary,
    a: &Interval<L>,
    domain: &mut Domain<L>,
) -> Interval<L> {
    a.lanes.vectorize(
        #[inline(always)]
        || match function {
            Unary::Negative => -*a,
            Unary::SquareRoot => a.square_root_noted(domain),
            Unary::Absolute => a.absolute(),
            Unary::Exponential => a.exponential(),
            Unary::Logarithm => a.logarithm(domain),
            Unary::Sine => a.sine_cosine().0,
            Unary::Cosine => a.sine_cosine().1,
            Unary::Tangent => a.tangent(domain),
            Unary::ArcSine => a.arc_sine(domain),
            Unary::ArcCosine => a.arc_cosine(domain),
            Unary::ArcTangent => a.arc_tangent(),
            Unary::HyperbolicSine => a.hyperbolic_sine(),
            Unary::HyperbolicCosine => a.hyperbolic_cosine(),
            Unary::HyperbolicTangent => a.hyperbolic_tangent(),
        },
    )
}

/// aᵇ, the angle of the point (b, a): one copy for each instruction set.
#[inline(never)]
fn function_of_two<L: DoubleLanes>(
    function: Binary,
    [a, b]: [&Interval<L>; 2],
    domain: &mut Domain<L>,
) -> Interval<L> {
    a.lanes.vectorize(
        #[inline(always)]
        || match function {
            Binary::Power => a.power(*b, domain),
            _ => a.arc_tangent_of_quotient(*b, domain),
        },
    )
}

/// The slope of a function of one value: a′ times or over something.
#[inline(never)]
fn slope_of<L: DoubleLanes>(
    function: Unary,
    a: &Jet<L>,
    value: &Interval<L>,
    domain: &mut Domain<L>,
) -> Interval<L> {
    a.value.lanes.vectorize(
        #[inline(always)]
        || {
            let one = Interval::splat(a.value.lanes, [1.0, 1.0]);
            let (x, y) = (a.value, *value);
            let factor = match function {
                Unary::Negative => -one,
                Unary::Exponential => y,
                Unary::Sine => function_of(Unary::Cosine, &x, domain),
                Unary::Cosine => -function_of(Unary::Sine, &x, domain),
                Unary::Tangent => one + y.squared(),
                Unary::HyperbolicSine => function_of(Unary::HyperbolicCosine, &x, domain),
                Unary::HyperbolicCosine => function_of(Unary::HyperbolicSine, &x, domain),
                Unary::HyperbolicTangent => one - y.squared(),
                _ => one,
            };
            let divisor = match function {
                Unary::SquareRoot => y.times_number(2.0),
                Unary::Logarithm => x,
                Unary::ArcSine => ((one - x) * (one + x)).square_root(),
                Unary::ArcCosine => -((one - x) * (one + x)).square_root(),
                Unary::ArcTangent => one + x.squared(),
                _ => return a.slope * factor,
            };
            a.slope / divisor
        },
    )
}

/// A whole power: one copy for each instruction set.
#[inline(never)]
fn whole_power_of<L: DoubleLanes>(a: &Jet<L>, n: i32, domain: &mut Domain<L>) -> Jet<L> {
    a.value.lanes.vectorize(
        #[inline(always)]
        || a.whole_power(n, domain),
    )
}

impl<L: DoubleLanes> Arithmetic<L> for Interval<L> {
    #[inline(always)]
    fn constant(value: Interval<L>) -> Self {
        value
    }
    #[inline(always)]
    fn unary(self, function: Unary, domain: &mut Domain<L>) -> Self {
        function_of(function, &self, domain)
    }
    #[inline(always)]
    fn binary(self, function: Binary, other: Self, domain: &mut Domain<L>) -> Self {
        match function {
            Binary::Sum => self + other,
            Binary::Difference => self - other,
            Binary::Product => self * other,
            Binary::Quotient => self.quotient_noted(other, domain),
            Binary::Minimum => self.smaller(other),
            Binary::Maximum => self.larger(other),
            Binary::ArcTangent2 | Binary::Power => {
                function_of_two(function, [&self, &other], domain)
            }
        }
    }
    #[inline(always)]
    fn whole_power(self, n: i32, domain: &mut Domain<L>) -> Self {
        whole_power_of(&Jet::constant(self), n, domain).value
    }
    #[inline(always)]
    fn squared(self) -> Self {
        Interval::squared(self)
    }
    #[inline(always)]
    fn times_number(self, c: f64) -> Self {
        Interval::times_number(self, c)
    }
    #[inline(always)]
    fn plus_constant(self, c: Interval<L>) -> Self {
        self + c
    }
    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        self.sine_cosine_thin()
    }
}

impl<L: DoubleLanes> Arithmetic<L> for Jet<L> {
    #[inline(always)]
    fn constant(value: Interval<L>) -> Self {
        Jet::constant(value)
    }
    #[inline(always)]
    fn unary(self, function: Unary, domain: &mut Domain<L>) -> Self {
        if function == Unary::Absolute {
            return self.absolute();
        }
        let value = function_of(function, &self.value, domain);
        let slope = slope_of(function, &self, &value, domain);
        Jet { value, slope }
    }
    #[inline(always)]
    fn binary(self, function: Binary, other: Self, domain: &mut Domain<L>) -> Self {
        match function {
            Binary::Sum => self.plus(other),
            Binary::Difference => self.minus(other),
            Binary::Product => self.times(other),
            Binary::Quotient => self.quotient(other, domain),
            Binary::Minimum => self.smaller(other),
            Binary::Maximum => self.larger(other),
            Binary::ArcTangent2 | Binary::Power => {
                let value = function_of_two(function, [&self.value, &other.value], domain);
                let slope = if function == Binary::Power {
                    let logarithm = function_of(Unary::Logarithm, &self.value, domain);
                    self.slope_of_power(other, value, logarithm)
                } else {
                    self.slope_of_angle(other)
                };
                Jet { value, slope }
            }
        }
    }
    #[inline(always)]
    fn whole_power(self, n: i32, domain: &mut Domain<L>) -> Self {
        whole_power_of(&self, n, domain)
    }
    #[inline(always)]
    fn squared(self) -> Self {
        Jet::squared(self)
    }
    #[inline(always)]
    fn times_number(self, c: f64) -> Self {
        Jet::times_number(self, c)
    }
    #[inline(always)]
    fn plus_constant(self, c: Interval<L>) -> Self {
        Jet::plus_constant(self, c)
    }
    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        let (s, c) = self.value.sine_cosine();
        (self.chained(s, c), self.chained(c, -s))
    }
}

impl IntervalProgram {
    /// The program of a tape.
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
        l.vectorize(
            #[inline(always)]
            || self.run(l, coordinates, Interval::whole(l), registers),
        )
    }

    /// Enclosures of the field and of its slope along the coordinates' own slopes. A stage, too.
    #[inline(never)]
    pub fn jet<L: DoubleLanes>(
        &self,
        l: L,
        coordinates: &[Jet<L>; 3],
        registers: &mut Vec<Jet<L>>,
    ) -> (Jet<L>, Domain<L>) {
        l.vectorize(
            #[inline(always)]
            || {
                let anything = Jet {
                    value: Interval::whole(l),
                    slope: Interval::whole(l),
                };
                self.run(l, coordinates, anything, registers)
            },
        )
    }

    #[inline(always)]
    fn run<L: DoubleLanes, A: Arithmetic<L>>(
        &self,
        l: L,
        coordinates: &[A; 3],
        anything: A,
        registers: &mut Vec<A>,
    ) -> (A, Domain<L>) {
        let mut domain = Domain::unbroken(l);
        registers.clear();
        for step in &self.steps {
            let r = &*registers;
            let value = match *step {
                Step::Coordinate(axis) => coordinates[axis],
                Step::Constant(bounds) => A::constant(Interval::splat(l, bounds)),
                Step::Unary(function, a) => r[a].unary(function, &mut domain),
                Step::Binary(function, a, b) => r[a].binary(function, r[b], &mut domain),
                Step::WholePower(a, n) => r[a].whole_power(n, &mut domain),
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
        (registers.last().copied().unwrap_or(anything), domain)
    }
}

/// Turns a tape into a program.
struct Compiler<'a> {
    tape: &'a Tape,
    steps: Vec<Step>,
    /// The register of each place of the tape.
    register: Vec<Option<Place>>,
}

impl<'a> Compiler<'a> {
    fn new(tape: &'a Tape) -> Self {
        Self {
            tape,
            steps: Vec::new(),
            register: vec![None; tape.operations().len()],
        }
    }

    fn run(mut self) -> IntervalProgram {
        let operations = self.tape.operations();
        let last = operations.len().wrapping_sub(1);
        for (place, &operation) in operations.iter().enumerate() {
            if self.register[place].is_none() {
                self.compile(place, operation);
            }
        }
        // The field is to be in the last register.
        if let Some(&Some(register)) = self.register.get(last)
            && register + 1 != self.steps.len()
        {
            self.steps.push(Step::TimesNumber(register, 1.0));
        }
        IntervalProgram { steps: self.steps }
    }

    fn compile(&mut self, place: Place, operation: Operation) {
        let step = match operation {
            Operation::Coordinate(axis) => Step::Coordinate(axis),
            Operation::Constant(index) => {
                Step::Constant(enclosing_rational(&self.tape.constants()[index]))
            }
            Operation::Unary(function @ (Unary::Sine | Unary::Cosine), a) => {
                return self.angle(place, function, a);
            }
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
    fn angle(&mut self, place: Place, function: Unary, a: Place) {
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
        debug_assert!(matches!(function, Unary::Sine | Unary::Cosine));
    }
}
