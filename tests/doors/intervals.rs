//! Intervals in lanes.

use etalon_lanes::math::instructions::{DoubleLanes, Instructions, Job};
use etalon_lanes::math::interval::{Domain, Interval};
use etalon_lanes::math::lanes::{Mask, Real};
use etalon_lanes::math::packet::array;

use crate::columns::load;

/// The ends of an interval, low and high.
pub type Bounds = [f64; 2];

/// Whether all are the same bits.
pub fn same_bits(a: &[Bounds], b: &[Bounds]) -> bool {
    let bits = |x: &f64| x.to_bits();
    a.iter()
        .flatten()
        .map(bits)
        .eq(b.iter().flatten().map(bits))
}

/// An enum of these variants, and the list of all.
macro_rules! listed {
    ($(#[$doc:meta])* $name:ident: $($variant:ident),+) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $($variant),+
        }

        impl $name {
            pub const ALL: &[Self] = &[$(Self::$variant),+];
        }
    };
}

listed! { Operation: Sum, Difference, Product, Quotient, SquareRoot }

listed! {
    /// Those called thin are made for short intervals.
    Function: Exponential, Logarithm, Sine, Cosine, SineThin, CosineThin, Tangent, ArcSine, ArcCosine,
    ArcTangent, ArcTangent2, HyperbolicSine, HyperbolicCosine, HyperbolicTangent, Power, Seventh,
    MinusFourth
}

/// An operation on as many intervals as fill packets of any width. `to_nearest` leaves out the
/// rounding outward: a mistake that checks must find.
///
/// # Panics
/// If the number of intervals is no multiple of eight.
pub fn arithmetic(
    set: Instructions,
    operation: Operation,
    [a, b]: [&[Bounds]; 2],
    to_nearest: bool,
) -> Vec<Bounds> {
    let task = Task::Operation(operation, to_nearest);
    set.run(Each { task, a, b }).0
}

/// A function of as many intervals as fill packets of any width, and where it may be undefined.
///
/// # Panics
/// If the number of intervals is no multiple of eight.
pub fn function(
    set: Instructions,
    function: Function,
    [a, b]: [&[Bounds]; 2],
) -> (Vec<Bounds>, Vec<bool>) {
    let task = Task::Function(function);
    set.run(Each { task, a, b })
}

enum Task {
    Operation(Operation, bool),
    Function(Function),
}

struct Each<'a> {
    task: Task,
    a: &'a [Bounds],
    b: &'a [Bounds],
}

impl Job<f64> for Each<'_> {
    type Output = (Vec<Bounds>, Vec<bool>);

    #[inline(always)]
    fn run<L: DoubleLanes>(self, l: L) -> Self::Output {
        let count = self.a.len();
        assert!(count.is_multiple_of(8), "{count} intervals");
        let (mut bounds, mut broken) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (a, b) in self.a.chunks(L::COUNT).zip(self.b.chunks(L::COUNT)) {
            let ends = |x: &[Bounds], end: usize| load(l, x.iter().map(|x| x[end]));
            let a = Interval::new(l, ends(a, 0), ends(a, 1));
            let b = Interval::new(l, ends(b, 0), ends(b, 1));
            let mut domain = Domain::unbroken(l);
            let c = match self.task {
                Task::Operation(operation, true) => nearest(operation, a, b),
                Task::Operation(operation, false) => outward(operation, a, b),
                Task::Function(function) => of(function, a, b, &mut domain),
            };
            let (low, high, bits) = (array(l, c.low), array(l, c.high), domain.broken.bits());
            bounds.extend((0..L::COUNT).map(|i| [low[i], high[i]]));
            broken.extend((0..L::COUNT).map(|i| bits >> i & 1 == 1));
        }
        (bounds, broken)
    }
}

#[inline(always)]
fn outward<L: DoubleLanes>(operation: Operation, a: Interval<L>, b: Interval<L>) -> Interval<L> {
    match operation {
        Operation::Sum => a + b,
        Operation::Difference => a - b,
        Operation::Product => a * b,
        Operation::Quotient => a / b,
        Operation::SquareRoot => a.square_root(),
    }
}

/// Bounds rounded to nearest.
#[inline(always)]
fn nearest<L: DoubleLanes>(operation: Operation, a: Interval<L>, b: Interval<L>) -> Interval<L> {
    let l = a.lanes;
    let around = |[w, x, y, z]: [L::Real; 4]| {
        Interval::new(l, w.min(x).min(y.min(z)), w.max(x).max(y.max(z)))
    };
    match operation {
        Operation::Sum => Interval::new(l, a.low + b.low, a.high + b.high),
        Operation::Difference => Interval::new(l, a.low - b.high, a.high - b.low),
        Operation::Product => around([
            a.low * b.low,
            a.low * b.high,
            a.high * b.low,
            a.high * b.high,
        ]),
        Operation::Quotient => around([
            a.low / b.low,
            a.low / b.high,
            a.high / b.low,
            a.high / b.high,
        ])
        .whole_where(b.may_be_zero()),
        Operation::SquareRoot => Interval::new(l, a.low.max(l.real(0.0)).sqrt(), a.high.sqrt()),
    }
}

#[inline(always)]
fn of<L: DoubleLanes>(
    function: Function,
    a: Interval<L>,
    b: Interval<L>,
    domain: &mut Domain<L>,
) -> Interval<L> {
    match function {
        Function::Exponential => a.exponential(),
        Function::Logarithm => a.logarithm(domain),
        Function::Sine => a.sine_cosine().0,
        Function::Cosine => a.sine_cosine().1,
        Function::SineThin => a.sine_cosine_thin().0,
        Function::CosineThin => a.sine_cosine_thin().1,
        Function::Tangent => a.tangent(domain),
        Function::ArcSine => a.arc_sine(domain),
        Function::ArcCosine => a.arc_cosine(domain),
        Function::ArcTangent => a.arc_tangent(),
        Function::ArcTangent2 => a.arc_tangent_of_quotient(b, domain),
        Function::HyperbolicSine => a.hyperbolic_sine(),
        Function::HyperbolicCosine => a.hyperbolic_cosine(),
        Function::HyperbolicTangent => a.hyperbolic_tangent(),
        Function::Power => a.power(b, domain),
        Function::Seventh => a.whole_power(7),
        Function::MinusFourth => a.whole_power(-4),
    }
}
