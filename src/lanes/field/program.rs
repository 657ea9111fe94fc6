//! A polynomial field along a line, as a list of operations on forms.
//!
//! On a line every coordinate is a form of degree 1 in two homogeneous variables, and a polynomial
//! field of degree n becomes a form of degree n. With the variables (1 − s, s) the coefficients,
//! divided by binomials, are Bernstein coefficients on [0, 1] (Farouki and Rajan 1988, the "scaled
//! Bernstein" form); with (1, t) they are those of powers of t. In both a product is a plain
//! convolution, and a sum of unequal degrees multiplies the lower one by the form that is 1:
//! (1 − s) + s, or 1.
//!
//! The list is made once from the tape, with sums flattened, equal parts shared and every place
//! and degree fixed, so that it runs in any arithmetic without allocation.

pub mod bounds;

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{CheckedAdd, CheckedMul, One, ToPrimitive, Zero};

use super::tape::{Binary, Operation, Tape, Unary};
use crate::math::exact::Exact;
use crate::math::number::Number;

/// Largest degree along a line; beyond, fields are treated like any other expression.
pub const LARGEST_DEGREE: usize = 24;
/// Most coefficients of intermediate forms.
pub const MOST_ROWS: usize = 1024;

/// A form: where its coefficients stand, and its degree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// Place of the first of `degree` + 1 coefficients.
    pub at: usize,
    pub degree: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// The nearest f64 and the nearest f64 of the rest.
    pub parts: [f64; 2],
    /// The constant times the ratio of denominators of result and operand: an integer.
    pub exact: BigInt,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    Coordinate {
        axis: usize,
        /// Result, of degree 1.
        to: Form,
    },
    Product {
        a: Form,
        /// The other; the same one for a square.
        b: Form,
        to: Form,
    },
    /// Σ factor · form + constant.
    Combination {
        /// Operands, by rising degree.
        terms: Vec<(Factor, Form)>,
        constant: Factor,
        to: Form,
    },
}

/// A field that is polynomial, ready for lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    pub steps: Vec<Step>,
    pub result: Form,
    /// How many coefficients the steps need room for.
    pub rows: usize,
}

impl Program {
    /// The field as a form of the least of the given degrees, in ascending order, that holds it;
    /// `None` where the tape is not a polynomial, or one of a larger degree.
    pub fn new(tape: &Tape, degrees: &[usize]) -> Option<Self> {
        let mut algebra = Algebra::default();
        let mut values: Vec<Linear> = Vec::new();
        for operation in tape.operations() {
            let value = algebra.value(tape, &values, operation)?;
            values.push(value);
        }
        let field = values.last()?;
        let degree = algebra.degree(field);
        let raised = *degrees.iter().find(|d| **d >= degree)?;
        let mut emission = Emission {
            algebra: &algebra,
            steps: Vec::new(),
            atoms: vec![None; algebra.atoms.len()],
            combinations: Vec::new(),
            rows: 0,
        };
        let result = emission.combination(field, raised).form;
        let Emission { steps, rows, .. } = emission;
        (rows <= MOST_ROWS).then_some(Self {
            steps,
            result,
            rows,
        })
    }

    /// Coefficients of a positive multiple of the field, lowest power first and none above the
    /// given one, where the coordinates are (a + b t) / scale with integers a, b and scale > 0;
    /// `None` where the integers overflow.
    pub fn powers<N: Whole>(
        &self,
        coordinates: &[[N; 2]; 3],
        scale: &N,
        highest: usize,
    ) -> Option<Vec<N>> {
        let mut rows = vec![N::zero(); self.rows];
        for step in &self.steps {
            match step {
                Step::Coordinate { axis, to } => {
                    rows[to.at..to.at + 2].clone_from_slice(&coordinates[*axis]);
                }
                Step::Product { a, b, to } => {
                    for i in 0..=a.degree.min(highest) {
                        for j in 0..=b.degree.min(highest - i) {
                            let product = rows[a.at + i].checked_mul(&rows[b.at + j])?;
                            rows[to.at + i + j] = rows[to.at + i + j].checked_add(&product)?;
                        }
                    }
                }
                Step::Combination {
                    terms,
                    constant,
                    to,
                } => {
                    let mut sum = vec![N::zero(); to.degree.min(highest) + 1];
                    sum[0] = N::of(&constant.exact)?;
                    let mut degree = 0;
                    for (factor, form) in terms {
                        raise(&mut sum, form.degree - degree, scale)?;
                        degree = form.degree;
                        let factor = N::of(&factor.exact)?;
                        for (i, s) in sum.iter_mut().enumerate().take(degree + 1) {
                            *s = s.checked_add(&factor.checked_mul(&rows[form.at + i])?)?;
                        }
                    }
                    raise(&mut sum, to.degree - degree, scale)?;
                    rows[to.at..to.at + sum.len()].clone_from_slice(&sum);
                }
            }
        }
        let result = &rows[self.result.at..=self.result.at + self.result.degree.min(highest)];
        Some(result.to_vec())
    }
}

/// Raises a form by some degrees: the form that is 1 is the scale, at any t.
fn raise<N: Whole>(form: &mut [N], degrees: usize, scale: &N) -> Option<()> {
    for _ in 0..degrees {
        for c in form.iter_mut() {
            *c = c.checked_mul(scale)?;
        }
    }
    Some(())
}

/// Integers; operations give `None` where their range ends.
pub trait Whole: Clone + Zero + CheckedAdd + CheckedMul {
    fn of(x: &BigInt) -> Option<Self>;
}

impl Whole for BigInt {
    fn of(x: &BigInt) -> Option<Self> {
        Some(x.clone())
    }
}

impl Whole for i128 {
    fn of(x: &BigInt) -> Option<Self> {
        x.to_i128()
    }
}

type AtomIndex = usize;

#[derive(Debug, Clone, PartialEq)]
enum Atom {
    Coordinate(usize),
    Product(Linear, Linear),
}

/// constant + Σ factor · atom, atoms ascending.
#[derive(Debug, Clone, PartialEq)]
struct Linear {
    constant: BigRational,
    terms: Vec<(AtomIndex, BigRational)>,
}

impl Linear {
    fn constant(constant: BigRational) -> Self {
        Self {
            constant,
            terms: Vec::new(),
        }
    }

    /// The one atom that this is a multiple of.
    fn single(&self) -> Option<(AtomIndex, &BigRational)> {
        match self.terms.as_slice() {
            [(atom, factor)] if self.constant.is_zero() => Some((*atom, factor)),
            _ => None,
        }
    }

    fn scaled(&self, factor: &BigRational) -> Self {
        if factor.is_zero() {
            return Self::constant(BigRational::zero());
        }
        Self {
            constant: &self.constant * factor,
            terms: self.terms.iter().map(|(a, c)| (*a, c * factor)).collect(),
        }
    }

    fn plus(&self, other: &Self) -> Self {
        let mut terms = self.terms.clone();
        for (atom, factor) in &other.terms {
            match terms.binary_search_by_key(atom, |(a, _)| *a) {
                Ok(i) => terms[i].1 += factor,
                Err(i) => terms.insert(i, (*atom, factor.clone())),
            }
        }
        terms.retain(|(_, factor)| !factor.is_zero());
        Self {
            constant: &self.constant + &other.constant,
            terms,
        }
    }
}

#[derive(Default)]
struct Algebra {
    atoms: Vec<Atom>,
    degrees: Vec<usize>,
}

impl Algebra {
    fn value(&mut self, tape: &Tape, done: &[Linear], operation: &Operation) -> Option<Linear> {
        Some(match *operation {
            Operation::Coordinate(axis) => self.atom(Atom::Coordinate(axis)),
            Operation::Constant(index) => Linear::constant(tape.constants()[index].clone()),
            Operation::Unary(Unary::Negative, a) => done[a].scaled(&-BigRational::one()),
            Operation::Binary(Binary::Sum, a, b) => done[a].plus(&done[b]),
            Operation::Binary(Binary::Difference, a, b) => {
                done[a].plus(&done[b].scaled(&-BigRational::one()))
            }
            Operation::Binary(Binary::Product, a, b) => self.product(&done[a], &done[b])?,
            Operation::Binary(Binary::Quotient, a, b) => {
                let divisor = &done[b];
                let constant = divisor.terms.is_empty() && !divisor.constant.is_zero();
                constant.then(|| done[a].scaled(&divisor.constant.recip()))?
            }
            Operation::WholePower(a, n) => self.power(&done[a], u32::try_from(n).ok()?)?,
            Operation::Unary(..) | Operation::Binary(..) => return None,
        })
    }

    fn atom(&mut self, atom: Atom) -> Linear {
        let known = self.atoms.iter().position(|a| *a == atom);
        let index = known.unwrap_or_else(|| {
            self.degrees.push(match &atom {
                Atom::Coordinate(_) => 1,
                Atom::Product(a, b) => self.degree(a) + self.degree(b),
            });
            self.atoms.push(atom);
            self.atoms.len() - 1
        });
        Linear {
            constant: BigRational::zero(),
            terms: vec![(index, BigRational::one())],
        }
    }

    fn degree(&self, linear: &Linear) -> usize {
        let degrees = linear.terms.iter().map(|(atom, _)| self.degrees[*atom]);
        degrees.max().unwrap_or(0)
    }

    fn product(&mut self, a: &Linear, b: &Linear) -> Option<Linear> {
        if a.terms.is_empty() {
            return Some(b.scaled(&a.constant));
        }
        if b.terms.is_empty() {
            return Some(a.scaled(&b.constant));
        }
        if self.degree(a) + self.degree(b) > LARGEST_DEGREE {
            return None;
        }
        // Constant factors of single atoms are taken out, so that more products are equal.
        let mut factor = BigRational::one();
        let mut bare = |linear: &Linear| match linear.single() {
            Some((_, c)) => {
                factor *= c;
                linear.scaled(&c.recip())
            }
            None => linear.clone(),
        };
        let (a, b) = (bare(a), bare(b));
        Some(self.atom(Atom::Product(a, b)).scaled(&factor))
    }

    fn power(&mut self, a: &Linear, n: u32) -> Option<Linear> {
        match n {
            0 => Some(Linear::constant(BigRational::one())),
            1 => Some(a.clone()),
            _ => {
                let half = self.power(a, n / 2)?;
                let square = self.product(&half, &half)?;
                if n.is_multiple_of(2) {
                    return Some(square);
                }
                self.product(&square, a)
            }
        }
    }
}

/// A form that has its place, and the denominator of its integer version.
#[derive(Clone)]
struct Placed {
    form: Form,
    denominator: BigInt,
}

struct Emission<'a> {
    algebra: &'a Algebra,
    steps: Vec<Step>,
    atoms: Vec<Option<Placed>>,
    combinations: Vec<(Linear, Placed)>,
    rows: usize,
}

impl Emission<'_> {
    fn room(&mut self, degree: usize) -> Form {
        let at = self.rows;
        self.rows += degree + 1;
        Form { at, degree }
    }

    fn atom(&mut self, index: AtomIndex) -> Placed {
        if let Some(placed) = &self.atoms[index] {
            return placed.clone();
        }
        let algebra = self.algebra;
        let (form, denominator) = match &algebra.atoms[index] {
            Atom::Coordinate(axis) => {
                let to = self.room(1);
                self.steps.push(Step::Coordinate { axis: *axis, to });
                (to, BigInt::one())
            }
            Atom::Product(a, b) => {
                let (left, right) = (self.linear(a), self.linear(b));
                let (a, b) = (left.form, right.form);
                let to = self.room(a.degree + b.degree);
                self.steps.push(Step::Product { a, b, to });
                (to, left.denominator * right.denominator)
            }
        };
        let placed = Placed { form, denominator };
        self.atoms[index] = Some(placed.clone());
        placed
    }

    /// The form of a sum; single atoms stand for themselves.
    fn linear(&mut self, linear: &Linear) -> Placed {
        match linear.single() {
            Some((atom, factor)) if factor.is_one() => self.atom(atom),
            _ => self.combination(linear, 0),
        }
    }

    fn combination(&mut self, linear: &Linear, least: usize) -> Placed {
        let known = self.combinations.iter().find(|(l, _)| l == linear);
        if let Some((_, placed)) = known.filter(|(_, p)| p.form.degree >= least) {
            return placed.clone();
        }
        let terms = linear.terms.iter();
        let mut operands: Vec<(Placed, &BigRational)> = terms
            .map(|(atom, factor)| (self.atom(*atom), factor))
            .collect();
        operands.sort_by_key(|(placed, _)| placed.form.degree);
        let mut denominator = linear.constant.denom().clone();
        for (placed, factor) in &operands {
            denominator = denominator.lcm(&(&placed.denominator * factor.denom()));
        }
        let factor = |value: &BigRational, of: &BigInt| Factor {
            parts: parts(value),
            exact: value.numer() * &denominator / (value.denom() * of),
        };
        let terms: Vec<(Factor, Form)> = operands
            .iter()
            .map(|(placed, value)| (factor(value, &placed.denominator), placed.form))
            .collect();
        let constant = factor(&linear.constant, &BigInt::one());
        let degree = terms.last().map_or(0, |(_, form)| form.degree).max(least);
        let to = self.room(degree);
        self.steps.push(Step::Combination {
            terms,
            constant,
            to,
        });
        let form = to;
        let placed = Placed { form, denominator };
        self.combinations.push((linear.clone(), placed.clone()));
        placed
    }
}

/// A rational as the nearest f64 (or one of its neighbours) and the same of the rest.
fn parts(value: &BigRational) -> [f64; 2] {
    let high = nearest(value);
    if !high.is_finite() {
        return [high, 0.0];
    }
    let rest = BigRational::from_float(high).map_or_else(BigRational::zero, |h| value - h);
    [high, nearest(&rest)]
}

/// The nearest f64 of n / d, or one of its neighbours.
pub(super) fn nearest(value: &BigRational) -> f64 {
    let whole = |x: &BigInt| Exact::integer(x.clone());
    let quotient = whole(value.numer()).divided_by(&whole(value.denom()));
    quotient.to_f64()
}
