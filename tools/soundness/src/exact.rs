//! Comparisons of exact sums and products with numbers.

use std::cmp::Ordering;

use etalon::inside::math::exact::Exact;
use etalon::inside::math::number::Number;

/// x + y ⋚ z for finite numbers, exactly.
pub fn compare_sum(x: f64, y: f64, z: f64) -> Ordering {
    compare(x + y, z, || Exact::of(x).plus(&Exact::of(y)))
}

/// x · y ⋚ z for finite numbers, exactly.
pub fn compare_product(x: f64, y: f64, z: f64) -> Ordering {
    compare(x * y, z, || Exact::of(x).times(&Exact::of(y)))
}

/// The order of a number and z. Rounding is monotone: what is rounded to another number than z lies on
/// the same side of z before it is rounded.
fn compare(rounded: f64, z: f64, exact: impl FnOnce() -> Exact) -> Ordering {
    let order = rounded.partial_cmp(&z).unwrap_or(Ordering::Equal);
    order.then_with(|| {
        let rest = exact().minus(&Exact::of(z));
        rest.sign().unwrap_or(Ordering::Equal)
    })
}
