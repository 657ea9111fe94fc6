//! Sums, differences, products, quotients and square roots of random intervals.

use std::cmp::Ordering;

use etalon::Instructions;
use etalon_doors::intervals::{Bounds, Operation, arithmetic, same_bits};

use super::exact::{compare_product, compare_sum};
use super::random::Source;

/// Whether the bounds hold the exact result of two numbers; true where there is none.
pub fn holds(operation: Operation, x: f64, y: f64, [low, high]: [f64; 2]) -> bool {
    // The order of the exact result and a bound.
    let order = |z: f64| match operation {
        Operation::Sum => compare_sum(x, y, z),
        Operation::Difference => compare_sum(x, -y, z),
        Operation::Product => compare_product(x, y, z),
        // x / y ⋚ z as x ⋚ z y, turned round for negative y.
        Operation::Quotient if y < 0.0 => compare_product(z, y, x),
        Operation::Quotient => compare_product(z, y, x).reverse(),
        Operation::SquareRoot if z < 0.0 => Ordering::Greater,
        Operation::SquareRoot => compare_product(z, z, x).reverse(),
    };
    // Infinite bounds of the right sign hold everything; NaN and the wrong ones nothing.
    let ordered = |bound: f64, wanted: Ordering| match bound {
        f64::INFINITY | f64::NEG_INFINITY => (bound > 0.0) == (wanted == Ordering::Less),
        _ => !bound.is_nan() && [wanted, Ordering::Equal].contains(&order(bound)),
    };
    let undefined = match operation {
        Operation::Quotient => y == 0.0,
        Operation::SquareRoot => x < 0.0,
        _ => false,
    };
    undefined || ordered(low, Ordering::Greater) && ordered(high, Ordering::Less)
}

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
    pub fn joined(self, other: Self) -> Self {
        Self {
            checked: self.checked + other.checked,
            violated: self.violated + other.violated,
            different: self.different + other.different,
            example: self.example.or(other.example),
        }
    }

    /// What the first instruction set says, and how many say something else.
    ///
    /// # Panics
    /// If there is no instruction set.
    pub fn of<R>(mut results: impl Iterator<Item = R>, same: impl Fn(&R, &R) -> bool) -> (R, Self) {
        let first = results
            .next()
            .expect("every machine has an instruction set");
        let report = Self {
            different: results.filter(|other| !same(&first, other)).count() as u64,
            ..Self::default()
        };
        (first, report)
    }

    /// Counts what is not `held`, and keeps the words of the first.
    pub fn note(&mut self, held: bool, words: impl FnOnce() -> String) {
        if !held {
            self.violated += 1;
            self.example.get_or_insert_with(words);
        }
    }

    /// Whether nothing is wrong.
    pub fn is_good(&self) -> bool {
        self.violated == 0 && self.different == 0
    }
}

/// Checks `count` (a multiple of eight) random intervals on each instruction set; `unsound` leaves out
/// the rounding outward, to see that this is noticed.
pub fn check(operation: Operation, seed: u64, count: usize, unsound: bool) -> Report {
    let mut source = Source::new(seed);
    let pairs = (0..count).map(|_| <(Bounds, Bounds)>::from(source.pair()));
    let (a, b): (Vec<_>, Vec<_>) = pairs.unzip();
    let results = Instructions::all().into_iter();
    let results = results.map(|set| arithmetic(set, operation, [&a, &b], unsound));
    let (first, mut report) = Report::of(results, |a, b| same_bits(a, b));
    for ((a, b), bounds) in a.into_iter().zip(b).zip(first) {
        for x in ends(a) {
            for y in ends(b) {
                let held = holds(operation, x, y, bounds);
                report.note(held, || {
                    format!("{operation:?} of {x:e}, {y:e} is not in {bounds:?}")
                });
            }
        }
    }
    report.checked = count as u64;
    report
}

/// The finite ends, between which all these operations have their extremes.
fn ends(bounds: [f64; 2]) -> impl Iterator<Item = f64> {
    bounds.map(|x| x.clamp(-f64::MAX, f64::MAX)).into_iter()
}
