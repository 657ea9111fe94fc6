//! Exact rational numbers.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;

/// √c where that is rational.
pub fn square_root(c: &BigRational) -> Option<BigRational> {
    if c.is_negative() {
        return None;
    }
    let root = |n: &BigInt| {
        let root = n.sqrt();
        (&root * &root == *n).then_some(root)
    };
    // In lowest terms numerator and denominator are squares on their own.
    Some(BigRational::new_raw(root(c.numer())?, root(c.denom())?))
}
