//! Sums, differences, products, quotients and square roots of random intervals.

use std::cmp::Ordering;

use etalon::Instructions;
use etalon::inside::math::instructions::{DoubleLanes, Job};
use etalon::inside::math::interval::Interval;

use super::exact::{compare_product, compare_sum};
use super::random::Source;

/// The operations that are checked exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// a + b.
    Sum,
    /// a − b.
    Difference,
    /// a · b.
    Product,
    /// a / b.
    Quotient,
    /// √a.
    SquareRoot,
}

/// All of them.
pub const OPERATIONS: [Operation; 5] = [
    Operation::Sum,
    Operation::Difference,
    Operation::Product,
    Operation::Quotient,
    Operation::SquareRoot,
];

/// Bounds of many intervals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bounds {
    /// Lower bounds.
    pub low: Vec<f64>,
    /// Upper bounds.
    pub high: Vec<f64>,
}

impl Bounds {
    fn push(&mut self, [low, high]: [f64; 2]) {
        self.low.push(low);
        self.high.push(high);
    }

    /// Those of one interval.
    pub fn at(&self, i: usize) -> [f64; 2] {
        [self.low[i], self.high[i]]
    }

    /// Whether all are the same bits.
    pub fn same_bits(&self, other: &Self) -> bool {
        let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        bits(&self.low) == bits(&other.low) && bits(&self.high) == bits(&other.high)
    }
}

/// An operation on many intervals. The number of them is a multiple of eight.
pub struct Apply<'a> {
    /// Which.
    pub operation: Operation,
    /// First operands.
    pub a: &'a Bounds,
    /// Second operands.
    pub b: &'a Bounds,
    /// Leave out the rounding outward, to see that this is noticed.
    pub unsound: bool,
}

impl Job<f64> for Apply<'_> {
    type Output = Bounds;

    #[inline(always)]
    fn run<L: DoubleLanes>(self, l: L) -> Bounds {
        let count = self.a.low.len();
        let mut out = Bounds {
            low: vec![0.0; count],
            high: vec![0.0; count],
        };
        let mut i = 0;
        while i + L::COUNT <= count {
            let a = Interval::new(l, l.load(&self.a.low[i..]), l.load(&self.a.high[i..]));
            let b = Interval::new(l, l.load(&self.b.low[i..]), l.load(&self.b.high[i..]));
            let c = if self.unsound {
                nearest(self.operation, a, b)
            } else {
                outward(self.operation, a, b)
            };
            l.store(c.low, &mut out.low[i..]);
            l.store(c.high, &mut out.high[i..]);
            i += L::COUNT;
        }
        out
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

/// The mistake that must be found: bounds rounded to nearest.
#[inline(always)]
fn nearest<L: DoubleLanes>(operation: Operation, a: Interval<L>, b: Interval<L>) -> Interval<L> {
    use etalon::inside::math::lanes::Real;
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

/// Whether the bounds hold the exact result of two numbers; true where there is none.
pub fn holds(operation: Operation, x: f64, y: f64, [low, high]: [f64; 2]) -> bool {
    let ordered = |bound: f64, order: &dyn Fn(f64) -> Ordering, wanted: Ordering| {
        // Infinite bounds of the right sign hold everything; NaN and the wrong ones nothing.
        if bound.is_infinite() {
            return (bound > 0.0) == (wanted == Ordering::Less);
        }
        !bound.is_nan() && (order(bound) == wanted || order(bound) == Ordering::Equal)
    };
    // The order of the exact result and a bound.
    let order: Box<dyn Fn(f64) -> Ordering> = match operation {
        Operation::Sum => Box::new(move |z| compare_sum(x, y, z)),
        Operation::Difference => Box::new(move |z| compare_sum(x, -y, z)),
        Operation::Product => Box::new(move |z| compare_product(x, y, z)),
        Operation::Quotient if y == 0.0 => return true,
        // x / y ⋚ z as x ⋚ z y, turned round for negative y.
        Operation::Quotient if y < 0.0 => Box::new(move |z| compare_product(z, y, x)),
        Operation::Quotient => Box::new(move |z| compare_product(z, y, x).reverse()),
        Operation::SquareRoot if x < 0.0 => return true,
        Operation::SquareRoot => Box::new(move |z| {
            if z < 0.0 {
                Ordering::Greater
            } else {
                compare_product(z, z, x).reverse()
            }
        }),
    };
    ordered(low, &*order, Ordering::Greater) && ordered(high, &*order, Ordering::Less)
}

/// What a check has found.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// Intervals checked on every instruction set.
    pub checked: u64,
    /// Intervals that do not hold an exact result.
    pub violated: u64,
    /// Batches in which instruction sets disagree.
    pub different: u64,
    /// The first violation in words.
    pub example: Option<String>,
}

impl Report {
    /// Both together.
    pub fn joined(self, other: Self) -> Self {
        Self {
            checked: self.checked + other.checked,
            violated: self.violated + other.violated,
            different: self.different + other.different,
            example: self.example.or(other.example),
        }
    }

    /// Whether nothing is wrong.
    pub fn is_good(&self) -> bool {
        self.violated == 0 && self.different == 0
    }
}

/// Checks `count` (a multiple of eight) random intervals on each instruction set.
pub fn check(operation: Operation, seed: u64, count: usize, unsound: bool) -> Report {
    let mut source = Source::new(seed);
    let (mut a, mut b) = (Bounds::default(), Bounds::default());
    for _ in 0..count {
        let [first, second] = source.pair();
        a.push(first);
        b.push(second);
    }
    let mut report = Report {
        checked: count as u64,
        ..Report::default()
    };
    let mut results = Instructions::all().into_iter().map(|instructions| {
        instructions.run(Apply {
            operation,
            a: &a,
            b: &b,
            unsound,
        })
    });
    let Some(first) = results.next() else {
        return report;
    };
    report.different = results.filter(|other| !first.same_bits(other)).count() as u64;
    for i in 0..count {
        let bounds = first.at(i);
        for x in ends(a.at(i)) {
            for y in ends(b.at(i)) {
                if !holds(operation, x, y, bounds) {
                    report.violated += 1;
                    report.example.get_or_insert_with(|| {
                        format!("{operation:?} of {x:e} and {y:e} is not in {bounds:?}")
                    });
                }
            }
        }
    }
    report
}

/// The finite ends, between which all these operations have their extremes.
fn ends(bounds: [f64; 2]) -> impl Iterator<Item = f64> {
    bounds.map(|x| x.clamp(-f64::MAX, f64::MAX)).into_iter()
}
