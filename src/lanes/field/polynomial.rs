//! Exact polynomials in x, y and z with rational coefficients.

use std::cell::Cell;
use std::collections::BTreeMap;

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use super::tape::{Algebra, Binary, Tape, Unary};

/// Exponents of x, y and z.
pub type Exponents = [u32; 3];

/// Highest total degree that is recognised.
pub const MOST_DEGREE: u32 = 64;
/// Most products of two terms that recognising may take: some tenths of a second.
const MOST_PRODUCTS: u64 = 1 << 21;

/// A polynomial: integer coefficients over one common positive denominator.
///
/// No coefficient is zero, and no factor > 1 is common to all coefficients and the denominator, so
/// that equal polynomials are represented equally.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Polynomial {
    terms: BTreeMap<Exponents, BigInt>,
    denominator: BigInt,
}

impl Polynomial {
    /// Integer coefficients by exponents, over a common denominator other than zero.
    pub fn new(terms: impl IntoIterator<Item = (Exponents, BigInt)>, denominator: BigInt) -> Self {
        let mut sums = BTreeMap::<Exponents, BigInt>::new();
        for (exponents, coefficient) in terms {
            *sums.entry(exponents).or_default() += coefficient;
        }
        Self {
            terms: sums,
            denominator,
        }
        .reduced()
    }

    pub fn constant(value: &BigRational) -> Self {
        Self::new([([0; 3], value.numer().clone())], value.denom().clone())
    }

    pub fn coordinate(axis: usize) -> Self {
        let mut exponents = [0; 3];
        exponents[axis] = 1;
        Self::new([(exponents, BigInt::one())], BigInt::one())
    }

    /// The field of a tape, where it is built from sums, differences, products and whole powers
    /// alone and neither its degree exceeds [`MOST_DEGREE`] nor multiplying it out a bound on
    /// work.
    pub fn from_tape(tape: &Tape) -> Option<Self> {
        let recognition = Recognition {
            budget: Cell::new(MOST_PRODUCTS),
        };
        tape.evaluate(&recognition, &mut Vec::new())?
    }

    fn reduced(mut self) -> Self {
        self.terms.retain(|_, c| !c.is_zero());
        let mut common = self.denominator.clone();
        for coefficient in self.terms.values() {
            if common.abs().is_one() {
                break;
            }
            common = common.gcd(coefficient);
        }
        if self.denominator.is_negative() != common.is_negative() {
            common = -common;
        }
        if !common.is_one() {
            for coefficient in self.terms.values_mut() {
                *coefficient /= &common;
            }
            self.denominator /= common;
        }
        self
    }

    /// Coefficients other than zero, in lexical order of the exponents.
    pub fn terms(&self) -> impl Iterator<Item = (Exponents, BigRational)> + '_ {
        let rational = |c: &BigInt| BigRational::new(c.clone(), self.denominator.clone());
        self.terms.iter().map(move |(e, c)| (*e, rational(c)))
    }

    /// The least positive integer that makes all coefficients integers.
    pub fn denominator(&self) -> &BigInt {
        &self.denominator
    }

    /// Total degree; 0 for constants, zero among them.
    pub fn degree(&self) -> u32 {
        let sums = self.terms.keys().map(|e| e.iter().sum());
        sums.max().unwrap_or(0)
    }

    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    pub fn is_constant(&self) -> bool {
        self.degree() == 0
    }

    pub fn plus(&self, other: &Self) -> Self {
        let ours = self.terms.iter().map(|(e, c)| (*e, c * &other.denominator));
        let theirs = other.terms.iter().map(|(e, c)| (*e, c * &self.denominator));
        Self::new(ours.chain(theirs), &self.denominator * &other.denominator)
    }

    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }

    pub fn negated(&self) -> Self {
        let terms = self.terms.iter().map(|(e, c)| (*e, -c));
        Self {
            terms: terms.collect(),
            denominator: self.denominator.clone(),
        }
    }

    pub fn times(&self, other: &Self) -> Self {
        let sum = |e: &Exponents, f: &Exponents| [e[0] + f[0], e[1] + f[1], e[2] + f[2]];
        let products = self.terms.iter().flat_map(|(e, a)| {
            let product = move |(f, b): (&Exponents, &BigInt)| (sum(e, f), a * b);
            other.terms.iter().map(product)
        });
        Self::new(products, &self.denominator * &other.denominator)
    }
}

/// Tapes in the arithmetic of polynomials; `None` stands for what is none.
struct Recognition {
    /// Products of terms that may yet be formed.
    budget: Cell<u64>,
}

impl Recognition {
    fn product(&self, a: &Polynomial, b: &Polynomial) -> Option<Polynomial> {
        let work = a.terms.len() as u64 * b.terms.len() as u64;
        let left = self.budget.get().checked_sub(work)?;
        self.budget.set(left);
        (a.degree() + b.degree() <= MOST_DEGREE).then(|| a.times(b))
    }
}

impl Algebra for Recognition {
    type Value = Option<Polynomial>;

    fn coordinate(&self, axis: usize) -> Self::Value {
        Some(Polynomial::coordinate(axis))
    }

    fn constant(&self, _: usize, exact: &BigRational) -> Self::Value {
        Some(Polynomial::constant(exact))
    }

    fn unary(&self, function: Unary, a: &Self::Value) -> Self::Value {
        match function {
            Unary::Negative => a.as_ref().map(Polynomial::negated),
            _ => None,
        }
    }

    fn binary(&self, function: Binary, a: &Self::Value, b: &Self::Value) -> Self::Value {
        let (a, b) = (a.as_ref()?, b.as_ref()?);
        let added = (a.terms.len() + b.terms.len()) as u64;
        self.budget.set(self.budget.get().checked_sub(added)?);
        match function {
            Binary::Sum => Some(a.plus(b)),
            Binary::Difference => Some(a.minus(b)),
            Binary::Product => self.product(a, b),
            Binary::Quotient if b.is_constant() => {
                let divisor = b.terms().next()?.1;
                Some(a.times(&Polynomial::constant(&divisor.recip())))
            }
            _ => None,
        }
    }

    fn whole_power(&self, a: &Self::Value, n: i32) -> Self::Value {
        let a = a.as_ref()?;
        let n = u32::try_from(n).ok()?;
        if a.degree().checked_mul(n)? > MOST_DEGREE {
            return None;
        }
        let mut power = Polynomial::constant(&BigRational::one());
        // From the highest bit down: squares, and a factor where the bit is set.
        for bit in (0..u32::BITS - n.leading_zeros()).rev() {
            power = self.product(&power, &power)?;
            if n >> bit & 1 == 1 {
                power = self.product(&power, a)?;
            }
        }
        Some(power)
    }
}
