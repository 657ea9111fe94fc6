//! Operations as they are put on a tape: constants are joined exactly, neutral ones left out.

use std::ops::Range;

use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

use super::error::Problem;
use super::token::fits;
use super::{MOST_EXPONENT, MOST_OPERATIONS, fold};
use crate::field::tape::{Binary, Operation, Place, Tape, Unary};

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Constant(BigRational),
    Result(Place),
}

#[derive(Debug, Default)]
pub(super) struct Builder {
    tape: Tape,
    spans: Vec<Range<usize>>,
    /// The bytes of the text that the operation being added comes from.
    pub span: Range<usize>,
}

type Built = Result<Value, Problem>;

impl Builder {
    /// Only the operations that `root` needs, with their spans.
    pub fn finish(&self, root: Place) -> (Tape, Vec<Range<usize>>) {
        let (tape, places) = self.tape.rooted(root);
        let spans = places.iter().map(|p| self.spans[*p].clone()).collect();
        (tape, spans)
    }

    pub fn push(&mut self, operation: Operation) -> Built {
        let place = self.tape.push(operation);
        self.note()?;
        Ok(Value::Result(place))
    }

    /// Gives a new operation its span.
    fn note(&mut self) -> Result<(), Problem> {
        let length = self.tape.operations().len();
        self.spans.resize(length, self.span.clone());
        if length > MOST_OPERATIONS {
            return Err(Problem::TooManyOperations);
        }
        Ok(())
    }

    fn place(&mut self, value: Value) -> Result<Place, Problem> {
        match value {
            Value::Result(place) => Ok(place),
            Value::Constant(value) => {
                let place = self.tape.push_constant(value);
                self.note()?;
                Ok(place)
            }
        }
    }

    /// A binary operation without simplification; the operands of sums, products, minima and maxima are
    /// sorted, so that both orders are one operation.
    fn push_binary(&mut self, function: Binary, a: Value, b: Value) -> Built {
        let (a, b) = (self.place(a)?, self.place(b)?);
        let commutes = matches!(
            function,
            Binary::Sum | Binary::Product | Binary::Minimum | Binary::Maximum
        );
        let (a, b) = if commutes && b < a { (b, a) } else { (a, b) };
        self.push(Operation::Binary(function, a, b))
    }

    /// π = 4 atan 1.
    pub fn pi(&mut self) -> Built {
        let one = self.place(Value::Constant(BigRational::one()))?;
        let quarter = self.push(Operation::Unary(Unary::ArcTangent, one))?;
        let four = Value::Constant(BigRational::from_integer(4.into()));
        self.push_binary(Binary::Product, four, quarter)
    }

    pub fn sum(&mut self, a: Value, b: Value) -> Built {
        match (&a, &b) {
            (Value::Constant(a), Value::Constant(b)) => constant(a + b),
            (Value::Constant(zero), other) | (other, Value::Constant(zero)) if zero.is_zero() => {
                Ok(other.clone())
            }
            _ => self.push_binary(Binary::Sum, a, b),
        }
    }

    pub fn difference(&mut self, a: Value, b: Value) -> Built {
        match (&a, &b) {
            (Value::Constant(a), Value::Constant(b)) => constant(a - b),
            (_, Value::Constant(zero)) if zero.is_zero() => Ok(a),
            (Value::Constant(zero), _) if zero.is_zero() => self.unary(Unary::Negative, b),
            _ if a == b => constant(BigRational::zero()),
            _ => self.push_binary(Binary::Difference, a, b),
        }
    }

    pub fn product(&mut self, a: Value, b: Value) -> Built {
        match (&a, &b) {
            (Value::Constant(a), Value::Constant(b)) => constant(a * b),
            (Value::Constant(c), _) | (_, Value::Constant(c)) if c.is_zero() => {
                constant(BigRational::zero())
            }
            (Value::Constant(c), other) | (other, Value::Constant(c)) if c.is_one() => {
                Ok(other.clone())
            }
            (Value::Constant(c), other) | (other, Value::Constant(c)) if (-c).is_one() => {
                self.unary(Unary::Negative, other.clone())
            }
            (Value::Result(left), Value::Result(right)) => {
                let ((base, m), (other, n)) = (self.as_power(*left), self.as_power(*right));
                match m.checked_add(n) {
                    Some(sum) if base == other && sum <= MOST_EXPONENT => {
                        self.push(Operation::WholePower(base, sum))
                    }
                    _ => self.push_binary(Binary::Product, a, b),
                }
            }
            _ => self.push_binary(Binary::Product, a, b),
        }
    }

    /// A result as base and exponent ≥ 1.
    fn as_power(&self, place: Place) -> (Place, i32) {
        match self.tape.operations()[place] {
            Operation::WholePower(base, n) if n > 0 => (base, n),
            _ => (place, 1),
        }
    }

    /// Division by a constant multiplies by its exact reciprocal.
    pub fn quotient(&mut self, a: Value, b: Value) -> Built {
        match &b {
            Value::Constant(c) if c.is_zero() => Err(Problem::Undefined("a division by zero")),
            Value::Constant(c) => self.product(a, Value::Constant(c.recip())),
            Value::Result(_) => self.push_binary(Binary::Quotient, a, b),
        }
    }

    /// aᵇ. A constant exponent makes it a whole power, or one of a square root, where it can.
    pub fn power(&mut self, base: Value, exponent: Value) -> Built {
        let Value::Constant(n) = &exponent else {
            return self.general_power(base, exponent);
        };
        if n.is_integer() {
            return self.whole_power(base, n.numer().to_i32().ok_or(Problem::ExponentTooLarge)?);
        }
        if *n.denom() == 2.into() {
            let twice = n.numer().to_i32().ok_or(Problem::ExponentTooLarge)?;
            let root = self.unary(Unary::SquareRoot, base)?;
            return self.whole_power(root, twice);
        }
        self.general_power(base, exponent)
    }

    fn general_power(&mut self, base: Value, exponent: Value) -> Built {
        let undefined = Problem::Undefined("a power of a constant that is not positive");
        match &base {
            Value::Constant(c) if !c.is_positive() => Err(undefined),
            _ => self.push_binary(Binary::Power, base, exponent),
        }
    }

    fn whole_power(&mut self, base: Value, n: i32) -> Built {
        let place = match base {
            Value::Constant(c) => return fold::whole_power(&c, n).and_then(constant),
            Value::Result(_) if n == 0 => return constant(BigRational::one()),
            Value::Result(place) => place,
        };
        if n == 1 {
            return Ok(Value::Result(place));
        }
        let power = (n > 0).then(|| self.as_power(place));
        let (inner, m) = power.unwrap_or((place, 1));
        let total = m.checked_mul(n).filter(|t| t.abs() <= MOST_EXPONENT);
        let total = total.ok_or(Problem::ExponentTooLarge)?;
        self.push(Operation::WholePower(inner, total))
    }

    pub fn unary(&mut self, function: Unary, a: Value) -> Built {
        match a {
            Value::Constant(c) => {
                if let Some(value) = fold::unary(function, &c)? {
                    return constant(value);
                }
                let place = self.place(Value::Constant(c))?;
                self.push(Operation::Unary(function, place))
            }
            Value::Result(place) => match (function, self.tape.operations()[place]) {
                (Unary::Negative, Operation::Unary(Unary::Negative, x)) => Ok(Value::Result(x)),
                (Unary::Absolute, Operation::Unary(Unary::Absolute, _)) => Ok(a),
                _ => self.push(Operation::Unary(function, place)),
            },
        }
    }

    pub fn binary(&mut self, function: Binary, a: Value, b: Value) -> Built {
        match (function, &a, &b) {
            (Binary::Minimum, Value::Constant(x), Value::Constant(y)) => constant(x.min(y).clone()),
            (Binary::Maximum, Value::Constant(x), Value::Constant(y)) => constant(x.max(y).clone()),
            (Binary::Minimum | Binary::Maximum, _, _) if a == b => Ok(a),
            (Binary::ArcTangent2, Value::Constant(y), Value::Constant(x))
                if y.is_zero() && x.is_zero() =>
            {
                Err(Problem::Undefined("the angle of the origin"))
            }
            _ => self.push_binary(function, a, b),
        }
    }
}

fn constant(value: BigRational) -> Built {
    let kept = Some(value).filter(fits).ok_or(Problem::TooManyDigits)?;
    Ok(Value::Constant(kept))
}
