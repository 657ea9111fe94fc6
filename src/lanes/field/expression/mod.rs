//! The language in which scene files write fields f(x, y, z).
//!
//! ```text
//! sum      = product { ("+" | "-") product }
//! product  = sign { ("*" | "/") sign }
//! sign     = ("+" | "-") sign | power
//! power    = atom [ "^" sign ]                 so -x^2 = -(x^2) and x^y^z = x^(y^z)
//! atom     = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//!
//! Numbers are the rationals they look like: `0.1` is one tenth and `9/80` is no double. Names are
//! x, y, z, `pi` (as 4·atan 1, so that each arithmetic has it as exactly as it can), parameters and
//! the functions of [`FUNCTIONS`]. Operations on constants are done exactly where the result is
//! rational, and left on the tape where it is not.

mod build;
mod error;
mod fold;
mod parser;
mod token;

use std::ops::Range;

use glam::DVec3;
use num_rational::BigRational;

pub use error::{ExpressionError, Problem};
pub use token::rational;

use super::polynomial::Polynomial;
use super::tape::{Binary, Operation, Tape, Unary};
use build::Value;
use parser::Parser;

/// Longest expression, bytes.
pub const LONGEST: usize = 1 << 16;
/// Deepest nesting of parentheses, signs and exponents: a bound on the parser's own recursion.
pub const DEEPEST: usize = 128;
pub const MOST_OPERATIONS: usize = 4096;
/// Largest numerator and denominator of a constant, bits: the squares of all doubles fit.
pub const MOST_BITS: u64 = 4096;
/// Largest whole exponent of something that is not constant.
pub const MOST_EXPONENT: i32 = 1024;

/// A function that has a name: of one value, or of two; minimum and maximum take more, too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Function {
    Unary(Unary),
    Binary(Binary),
}

pub const FUNCTIONS: &[(&str, Function)] = &[
    ("sqrt", Function::Unary(Unary::SquareRoot)),
    ("abs", Function::Unary(Unary::Absolute)),
    ("min", Function::Binary(Binary::Minimum)),
    ("max", Function::Binary(Binary::Maximum)),
    ("exp", Function::Unary(Unary::Exponential)),
    ("log", Function::Unary(Unary::Logarithm)),
    ("sin", Function::Unary(Unary::Sine)),
    ("cos", Function::Unary(Unary::Cosine)),
    ("tan", Function::Unary(Unary::Tangent)),
    ("asin", Function::Unary(Unary::ArcSine)),
    ("acos", Function::Unary(Unary::ArcCosine)),
    ("atan", Function::Unary(Unary::ArcTangent)),
    ("atan2", Function::Binary(Binary::ArcTangent2)),
    ("sinh", Function::Unary(Unary::HyperbolicSine)),
    ("cosh", Function::Unary(Unary::HyperbolicCosine)),
    ("tanh", Function::Unary(Unary::HyperbolicTangent)),
];

/// Names that are neither functions nor parameters.
pub const RESERVED: &[&str] = &["x", "y", "z", "pi"];

#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// A letter or `_`, then letters, digits or `_`.
    pub name: String,
    pub value: BigRational,
}

/// A field that depends on the place, as far as the text shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    pub tape: Tape,
    /// For each operation the bytes of the text that wrote it first.
    pub spans: Vec<Range<usize>>,
    /// The same field as a polynomial, if it is one of moderate size.
    pub polynomial: Option<Polynomial>,
}

impl Expression {
    /// The solid where the field is negative *and* the point is in the box: the larger of the field and
    /// of the six half-spaces' own fields, so that it is closed by the box's faces. `None` for corners
    /// that are not finite.
    pub fn capped(&self, inside: &[DVec3; 2]) -> Option<Self> {
        let mut tape = self.tape.clone();
        let mut field = tape.operations().len() - 1;
        for axis in 0..3 {
            let coordinate = tape.push(Operation::Coordinate(axis));
            let [low, high] = inside.map(|corner| BigRational::from_float(corner[axis]));
            let (low, high) = (tape.push_constant(low?), tape.push_constant(high?));
            let below = tape.push(Operation::Binary(Binary::Difference, low, coordinate));
            let above = tape.push(Operation::Binary(Binary::Difference, coordinate, high));
            field = tape.push(Operation::Binary(Binary::Maximum, field, below));
            field = tape.push(Operation::Binary(Binary::Maximum, field, above));
        }
        let whole = self.spans.last().cloned().unwrap_or_default();
        let mut spans = self.spans.clone();
        spans.resize(tape.operations().len(), whole);
        Some(Self {
            tape,
            spans,
            polynomial: None,
        })
    }
}

/// Reads a field.
///
/// # Errors
/// [`ExpressionError`] where the text does not follow the grammar, has an unknown name, exceeds a
/// limit, is undefined everywhere, or is found not to depend on x, y or z.
pub fn parse(text: &str, parameters: &[Parameter]) -> Result<Expression, ExpressionError> {
    let (builder, value) = Parser::read(text, parameters, true)?;
    let whole = text.len() - text.trim_start().len()..text.trim_end().len();
    let nowhere = |zero: bool| match zero {
        true => Err(Problem::EverywhereZero.at(whole.clone())),
        false => Err(Problem::Constant.at(whole.clone())),
    };
    let root = match value {
        Value::Constant(c) => return nowhere(c == BigRational::default()),
        Value::Result(place) => place,
    };
    let (tape, spans) = builder.finish(root);
    let moves = |o: &Operation| matches!(o, Operation::Coordinate(_));
    if !tape.operations().iter().any(moves) {
        return nowhere(false);
    }
    let polynomial = Polynomial::from_tape(&tape);
    match &polynomial {
        Some(p) if p.is_constant() => nowhere(p.is_zero()),
        _ => Ok(Expression {
            tape,
            spans,
            polynomial,
        }),
    }
}

/// Reads a rational constant, such as a parameter's value; `parameters` may be used in it.
///
/// # Errors
/// [`ExpressionError`] as for [`parse`], and where the value is not a rational number.
pub fn parse_constant(
    text: &str,
    parameters: &[Parameter],
) -> Result<BigRational, ExpressionError> {
    match Parser::read(text, parameters, false)? {
        (_, Value::Constant(value)) => Ok(value),
        _ => Err(Problem::NotRational.at(0..text.len())),
    }
}

/// Whether a parameter may have this name.
///
/// # Errors
/// [`Problem`] where the name is taken or not a name at all.
pub fn check_name(name: &str) -> Result<(), Problem> {
    let taken = RESERVED.contains(&name) || FUNCTIONS.iter().any(|(known, _)| *known == name);
    if taken {
        return Err(Problem::NameTaken(name.to_owned()));
    }
    let not_a_name = || Problem::NotAName(name.to_owned());
    token::is_name(name).then_some(()).ok_or_else(not_a_name)
}
