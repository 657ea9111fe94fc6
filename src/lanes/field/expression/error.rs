//! Errors of expressions.

use std::ops::Range;

use super::{DEEPEST, LONGEST, MOST_BITS, MOST_EXPONENT, MOST_OPERATIONS};

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{problem}")]
pub struct ExpressionError {
    pub problem: Problem,
    /// The bytes of the expression it is about; empty at its end.
    pub span: Range<usize>,
    /// What the grammar allows there instead.
    pub expected: Option<String>,
    /// Where a name is unknown, all known names.
    pub names: Vec<String>,
}

impl ExpressionError {
    pub(super) fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// With all known names.
    pub(super) fn names<'a>(mut self, names: impl IntoIterator<Item = &'a str>) -> Self {
        self.names = names.into_iter().map(str::to_owned).collect();
        self
    }
}

impl From<Problem> for ExpressionError {
    /// A problem of a text as a whole.
    fn from(problem: Problem) -> Self {
        problem.at(0..0)
    }
}

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Problem {
    #[error("the expression is empty")]
    Empty,
    #[error("the expression ends here")]
    End,
    #[error("the character {0:?} has no meaning here")]
    Character(char),
    #[error("\"{0}\" cannot stand here")]
    Unexpected(String),
    #[error("this \")\" closes nothing")]
    Closing,
    #[error("this \"(\" is not closed")]
    Opening,
    #[error("the name \"{0}\" is not known")]
    UnknownName(String),
    #[error("there is no function \"{0}\"")]
    UnknownFunction(String),
    #[error("the function \"{0}\" has no arguments")]
    NoCall(String),
    #[error("\"{name}\" has {found} argument{}", if *found == 1 { "" } else { "s" })]
    Arguments { name: String, found: usize },
    #[error("the coordinate \"{0}\" in a constant")]
    Coordinate(String),
    #[error("the value is not a rational number")]
    NotRational,
    #[error("the name \"{0}\" means something already")]
    NameTaken(String),
    #[error("\"{0}\" is not a name")]
    NotAName(String),
    #[error("{0} is undefined")]
    Undefined(&'static str),
    #[error("the expression does not depend on x, y or z: its surface is empty")]
    Constant,
    #[error("the expression is zero everywhere")]
    EverywhereZero,
    #[error("the expression has more than {LONGEST} bytes")]
    TooLong,
    #[error("the expression is nested more than {DEEPEST} deep")]
    TooDeep,
    #[error("the expression has more than {MOST_OPERATIONS} different operations")]
    TooManyOperations,
    #[error("a constant here has more than {MOST_BITS} bits")]
    TooManyDigits,
    #[error("the exponent is beyond ±{MOST_EXPONENT}")]
    ExponentTooLarge,
}

impl Problem {
    pub(super) fn at(self, span: Range<usize>) -> ExpressionError {
        ExpressionError {
            expected: self.expected(),
            problem: self,
            span,
            names: Vec::new(),
        }
    }

    /// What is allowed instead, where it follows from the kind of problem alone.
    fn expected(&self) -> Option<String> {
        let words = match self {
            Self::Empty | Self::Constant | Self::EverywhereZero => {
                "an expression that depends on x, y or z, such as \"x^2 + y^2 + z^2 - 1\""
            }
            Self::Opening => "a \")\" for each \"(\"",
            Self::Closing => "a \"(\" before it, or nothing",
            Self::NotAName(_) => "a letter, then letters, digits or \"_\"",
            Self::NameTaken(_) => "a name other than x, y, z, pi and those of functions",
            Self::NotRational => "numbers joined by + - * / ^",
            Self::Coordinate(_) => "a constant without x, y and z",
            Self::NoCall(_) => "\"(\" after the name of a function",
            _ => return None,
        };
        Some(words.to_owned())
    }
}
