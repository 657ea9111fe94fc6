//! The zero set of a tape from the form of its outermost operations: products, powers, differences
//! of squares.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};

use super::tape::{Binary, Operation, Place, Tape, Unary};

/// A field whose zeros are among those of a product.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    pub tape: Tape,
    pub multiplicity: u32,
}

/// A field as ± a positive constant × its factors, each to its multiplicity.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Factors {
    pub negative: bool,
    /// The factors, each different; at least one unless the field is constant.
    pub factors: Vec<Factor>,
}

/// More factors than this are left together: each costs a search of its own.
const MOST_FACTORS: usize = 64;

impl Tape {
    /// The operations that the result at `root` needs, as a tape of its own, and for each of them
    /// the place it had.
    pub fn rooted(&self, root: Place) -> (Tape, Vec<Place>) {
        let operations = self.operations();
        let mut needed = vec![false; operations.len()];
        needed[root] = true;
        for place in (0..=root).rev().filter(|p| *p < operations.len()) {
            if needed[place] {
                for operand in operands(&operations[place]).into_iter().flatten() {
                    needed[operand] = true;
                }
            }
        }
        let mut tape = Tape::default();
        let mut moved = vec![0; operations.len()];
        let places: Vec<Place> = (0..=root).filter(|p| needed[*p]).collect();
        for &place in &places {
            moved[place] = tape.push_moved(self, place, &moved);
        }
        (tape, places)
    }

    /// Appends all operations of another tape; returns the place of its field.
    fn append(&mut self, other: &Tape) -> Place {
        let mut moved = Vec::with_capacity(other.operations().len());
        for place in 0..other.operations().len() {
            moved.push(self.push_moved(other, place, &moved));
        }
        moved.last().copied().unwrap_or(0)
    }

    /// An operation of another tape whose operands stand here at `moved`.
    fn push_moved(&mut self, other: &Tape, place: Place, moved: &[Place]) -> Place {
        match other.operations()[place] {
            Operation::Constant(index) => self.push_constant(other.constants()[index].clone()),
            Operation::Coordinate(axis) => self.push(Operation::Coordinate(axis)),
            Operation::Unary(function, a) => self.push(Operation::Unary(function, moved[a])),
            Operation::Binary(function, a, b) => {
                self.push(Operation::Binary(function, moved[a], moved[b]))
            }
            Operation::WholePower(a, n) => self.push(Operation::WholePower(moved[a], n)),
        }
    }

    /// The field's outermost products and powers taken apart; a² − b² counts as (a − b)(a + b),
    /// where a constant b² must have a rational root. The zero set is that of the factors
    /// together, wherever all of them are defined.
    pub fn factors(&self) -> Factors {
        let mut found = Factors::default();
        let mut waiting = vec![(self.clone(), 1u32)];
        while let Some((tape, multiplicity)) = waiting.pop() {
            let room = waiting.len() + found.factors.len() < MOST_FACTORS;
            match tape.split().filter(|_| room) {
                Some((negative, parts)) => {
                    found.negative ^= negative && multiplicity % 2 == 1;
                    for (part, n) in parts.into_iter().rev() {
                        waiting.push((part, multiplicity.saturating_mul(n)));
                    }
                }
                None => found.add(tape, multiplicity),
            }
        }
        found
    }

    /// The outermost operation taken apart: whether the sign changes, and the parts with their
    /// powers.
    fn split(&self) -> Option<(bool, Vec<(Tape, u32)>)> {
        let operations = self.operations();
        let part = |place: Place| (self.rooted(place).0, 1);
        match *operations.last()? {
            Operation::Unary(Unary::Negative, a) => Some((true, vec![part(a)])),
            Operation::WholePower(a, n) if n > 0 => {
                Some((false, vec![(part(a).0, n.unsigned_abs())]))
            }
            Operation::Binary(Binary::Product, a, b) => Some(match (self.at(a), self.at(b)) {
                (Some(c), _) if !c.is_zero() => (c.is_negative(), vec![part(b)]),
                (_, Some(c)) if !c.is_zero() => (c.is_negative(), vec![part(a)]),
                _ => (false, vec![part(a), part(b)]),
            }),
            Operation::Binary(Binary::Difference, a, b) => {
                Some((false, minus_and_plus(&self.root_of(a)?, &self.root_of(b)?)))
            }
            Operation::Binary(Binary::Sum, a, b) => {
                let negative = |place: Place| self.at(place).filter(|c| c.is_negative());
                let mut orders = [(a, b), (b, a)].into_iter();
                let (c, other) = orders.find_map(|(c, other)| Some((negative(c)?, other)))?;
                let root = constant(square_root(&-c)?);
                let field = self.root_of(other).filter(|_| self.at(other).is_none())?;
                Some((false, minus_and_plus(&field, &root)))
            }
            _ => None,
        }
    }

    fn at(&self, place: Place) -> Option<&BigRational> {
        match self.operations()[place] {
            Operation::Constant(index) => Some(&self.constants()[index]),
            _ => None,
        }
    }

    /// What the result at a place is the square of.
    fn root_of(&self, place: Place) -> Option<Tape> {
        match self.operations()[place] {
            Operation::WholePower(a, n) if n > 0 && n % 2 == 0 => {
                let (mut tape, _) = self.rooted(a);
                if n > 2 {
                    let last = tape.operations().len() - 1;
                    tape.push(Operation::WholePower(last, n / 2));
                }
                Some(tape)
            }
            Operation::Constant(index) => {
                let c = &self.constants()[index];
                square_root(c).filter(|_| c.is_positive()).map(constant)
            }
            _ => None,
        }
    }
}

fn constant(c: BigRational) -> Tape {
    let mut tape = Tape::default();
    tape.push_constant(c);
    tape
}

/// a − b and a + b.
fn minus_and_plus(a: &Tape, b: &Tape) -> Vec<(Tape, u32)> {
    let factors = [Binary::Difference, Binary::Sum].map(|function| {
        let mut tape = Tape::default();
        let (a, b) = (tape.append(a), tape.append(b));
        tape.push(Operation::Binary(function, a, b));
        (tape, 1)
    });
    factors.into()
}

impl Factors {
    fn add(&mut self, tape: Tape, multiplicity: u32) {
        match self.factors.iter_mut().find(|f| f.tape == tape) {
            Some(known) => known.multiplicity = known.multiplicity.saturating_add(multiplicity),
            None => self.factors.push(Factor { tape, multiplicity }),
        }
    }
}

pub fn operands(operation: &Operation) -> [Option<Place>; 2] {
    match *operation {
        Operation::Coordinate(_) | Operation::Constant(_) => [None, None],
        Operation::Unary(_, a) | Operation::WholePower(a, _) => [Some(a), None],
        Operation::Binary(_, a, b) => [Some(a), Some(b)],
    }
}

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
