//! Intervals hold what they must: a sample of what `tools/soundness` checks at length, in the same
//! words, on every instruction set of the machine.

#[allow(dead_code, reason = "the tool joins reports, tests do not")]
#[path = "../tools/soundness/src/arithmetic.rs"]
mod arithmetic;
#[path = "../tools/soundness/src/exact.rs"]
mod exact;
#[path = "../tools/soundness/src/functions.rs"]
mod functions;
#[path = "../tools/soundness/src/random.rs"]
mod random;

use std::cmp::Ordering;

use etalon_doors::intervals::{Function, Operation};

/// 200 000 intervals for each of + − × ÷ √: 10⁶ together.
#[test]
fn arithmetic_holds_the_exact_results() {
    for &operation in Operation::ALL {
        let report = arithmetic::check(operation, 11, 200_000, false);
        assert!(report.is_good(), "{operation:?}: {report:?}");
        assert_eq!(report.checked, 200_000);
    }
}

/// Rounding to nearest instead of outward is noticed, for each operation.
#[test]
fn rounding_to_nearest_is_noticed() {
    for &operation in Operation::ALL {
        let report = arithmetic::check(operation, 12, 8_000, true);
        assert!(report.violated > 1_000, "{operation:?}: {report:?}");
    }
}

/// Each function against 192 bits.
#[test]
fn functions_hold_the_reference() {
    for &function in Function::ALL {
        let report = functions::check(function, 13, 1_600, false).unwrap();
        assert!(report.is_good(), "{function:?}: {report:?}");
    }
}

/// Enclosures that are sixteen steps too narrow are noticed, for each function.
#[test]
fn narrow_functions_are_noticed() {
    for &function in Function::ALL {
        let report = functions::check(function, 14, 800, true).unwrap();
        assert!(report.violated > 100, "{function:?}: {report:?}");
    }
}

/// The exact comparisons themselves, where rounded arithmetic would answer otherwise.
#[test]
fn exact_comparisons_see_what_rounding_hides() {
    use Ordering::{Equal, Greater, Less};
    let (u, tiny, most) = (f64::EPSILON, f64::from_bits(1), f64::MAX);
    for (x, y, z, order) in [
        (1.0, u / 8.0, 1.0, Greater),
        (1.0, -u / 8.0, 1.0, Less),
        (0.5, 0.5, 1.0, Equal),
        (most, tiny, most, Greater),
        (most, most, most, Greater),
    ] {
        assert_eq!(exact::compare_sum(x, y, z), order, "{x} + {y}, {z}");
    }
    let x = 1.0 + u;
    for (x, y, z, order) in [
        (x, x, x * x, Greater),
        (tiny, 0.5, tiny, Less),
        (tiny, 0.5, 0.0, Greater),
        (-3.0, 2.0, -6.0, Equal),
        (1e200, 1e200, most, Greater),
    ] {
        assert_eq!(exact::compare_product(x, y, z), order, "{x} {y}, {z}");
    }
}
