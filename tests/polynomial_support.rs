//! Exact polynomials as references: values and derivatives.

use etalon::inside::field::polynomial::{Exponents, Polynomial};
use num_rational::BigRational;

/// Coefficients other than zero.
pub type Terms = Vec<(Exponents, BigRational)>;

/// The exact value at a point.
pub fn value(terms: &Terms, point: &[BigRational; 3]) -> BigRational {
    let power = |i: usize, e: &Exponents| point[i].pow(e[i].cast_signed());
    let term = |(e, c): &(Exponents, BigRational)| c * power(0, e) * power(1, e) * power(2, e);
    terms.iter().map(term).sum()
}

/// The derivatives along x, y and z.
pub fn gradient(polynomial: &Polynomial) -> [Terms; 3] {
    [0, 1, 2].map(|axis| {
        let lowered = |(mut e, c): (Exponents, BigRational)| {
            let n = BigRational::from_integer(e[axis].into());
            e[axis] = e[axis].checked_sub(1)?;
            Some((e, c * n))
        };
        polynomial.terms().filter_map(lowered).collect()
    })
}

/// The positive multiple whose first coefficient is 1 or −1: the same signs, the same zeros.
pub fn scaled(polynomial: &Polynomial) -> Terms {
    let terms: Terms = polynomial.terms().collect();
    let size = num_traits::Signed::abs(&terms[0].1);
    terms.into_iter().map(|(e, c)| (e, c / &size)).collect()
}
