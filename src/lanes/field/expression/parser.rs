//! From words to operations, by recursive descent.

use std::ops::Range;

use super::build::{Builder, Value};
use super::error::{ExpressionError, Problem};
use super::token::{self, Token, Word};
use super::{DEEPEST, FUNCTIONS, Function, LONGEST, Parameter, RESERVED, rational};
use crate::field::tape::{Binary, Operation, Unary};

type Parsed = Result<(Value, Range<usize>), ExpressionError>;

pub(super) struct Parser<'a> {
    text: &'a str,
    parameters: &'a [Parameter],
    /// Whether x, y and z may occur.
    coordinates: bool,
    token: Token,
    depth: usize,
    builder: Builder,
}

/// What may begin a value.
const VALUE: &str = "a number, a name, a function or \"(\"";
/// What may follow a value.
const OPERATOR: &str = "one of + - * / ^";

impl<'a> Parser<'a> {
    pub fn read(
        text: &'a str,
        parameters: &'a [Parameter],
        coordinates: bool,
    ) -> Result<(Builder, Value), ExpressionError> {
        if text.len() > LONGEST {
            return Err(Problem::TooLong.at(LONGEST..text.len()));
        }
        let mut parser = Self {
            text,
            parameters,
            coordinates,
            token: token::next(text, 0)?,
            depth: 0,
            builder: Builder::default(),
        };
        if parser.token.word == Word::End {
            return Err(Problem::Empty.at(0..text.len()));
        }
        let (value, _) = parser.sum()?;
        match parser.token.word {
            Word::End => Ok((parser.builder, value)),
            Word::Mark(b')') => Err(Problem::Closing.at(parser.token.span)),
            _ => Err(parser.unexpected(OPERATOR)),
        }
    }

    fn advance(&mut self) -> Result<Token, ExpressionError> {
        let next = token::next(self.text, self.token.span.end)?;
        Ok(std::mem::replace(&mut self.token, next))
    }

    fn at(&self, mark: u8) -> bool {
        self.token.word == Word::Mark(mark)
    }

    fn unexpected(&self, expected: &str) -> ExpressionError {
        let span = self.token.span.clone();
        let problem = match self.token.word {
            Word::End => Problem::End,
            _ => Problem::Unexpected(self.text[span.clone()].to_owned()),
        };
        problem.at(span).expected(expected)
    }

    /// One level further down, with a bound on how many there are.
    fn deeper(&mut self, read: impl FnOnce(&mut Self) -> Parsed) -> Parsed {
        if self.depth == DEEPEST {
            let span = self.token.span.clone();
            return Err(Problem::TooDeep.at(span));
        }
        self.depth += 1;
        let parsed = read(self);
        self.depth -= 1;
        parsed
    }

    fn make(
        &mut self,
        span: Range<usize>,
        make: impl FnOnce(&mut Builder) -> Result<Value, Problem>,
    ) -> Parsed {
        self.builder.span = span.clone();
        match make(&mut self.builder) {
            Ok(value) => Ok((value, span)),
            Err(problem) => Err(problem.at(span)),
        }
    }

    fn sum(&mut self) -> Parsed {
        self.chain(b"+-", Self::product)
    }

    fn product(&mut self) -> Parsed {
        self.chain(b"*/", Self::sign)
    }

    /// Operands with marks between, joined from left to right.
    fn chain(&mut self, marks: &[u8; 2], operand: impl Fn(&mut Self) -> Parsed) -> Parsed {
        let (mut left, mut span) = operand(self)?;
        while let Word::Mark(mark) = self.token.word
            && marks.contains(&mark)
        {
            self.advance()?;
            let (right, end) = operand(self)?;
            let whole = span.start..end.end;
            (left, span) = self.make(whole, |builder| match mark {
                b'+' => builder.sum(left, right),
                b'-' => builder.difference(left, right),
                b'*' => builder.product(left, right),
                _ => builder.quotient(left, right),
            })?;
        }
        Ok((left, span))
    }

    fn sign(&mut self) -> Parsed {
        let Word::Mark(mark @ (b'+' | b'-')) = self.token.word else {
            return self.power();
        };
        let start = self.advance()?.span.start;
        let (value, span) = self.deeper(Self::sign)?;
        let whole = start..span.end;
        if mark == b'+' {
            return Ok((value, whole));
        }
        self.make(whole, |builder| builder.unary(Unary::Negative, value))
    }

    fn power(&mut self) -> Parsed {
        let (base, span) = self.atom()?;
        if !self.at(b'^') {
            return Ok((base, span));
        }
        self.advance()?;
        let (exponent, end) = self.deeper(Self::sign)?;
        let whole = span.start..end.end;
        self.make(whole, |builder| builder.power(base, exponent))
    }

    fn atom(&mut self) -> Parsed {
        match self.token.word {
            Word::Number => {
                let span = self.advance()?.span;
                let value = rational(&self.text[span.clone()]);
                let value = value.ok_or(Problem::TooManyDigits);
                self.make(span, |_| value.map(Value::Constant))
            }
            Word::Name => {
                let span = self.advance()?.span;
                self.name(span)
            }
            Word::Mark(b'(') => {
                let open = self.advance()?.span;
                let (value, _) = self.deeper(Self::sum)?;
                let close = self.close(&open, "one of + - * / ^ or \")\"")?;
                Ok((value, open.start..close.end))
            }
            _ => Err(self.unexpected(VALUE)),
        }
    }

    /// The `)` that belongs to the `(` at `open`.
    fn close(
        &mut self,
        open: &Range<usize>,
        expected: &str,
    ) -> Result<Range<usize>, ExpressionError> {
        match self.token.word {
            Word::Mark(b')') => Ok(self.advance()?.span),
            Word::End => Err(Problem::Opening.at(open.clone())),
            _ => Err(self.unexpected(expected)),
        }
    }

    fn name(&mut self, span: Range<usize>) -> Parsed {
        let text = self.text;
        let name = &text[span.clone()];
        if self.at(b'(') {
            return self.call(name, span);
        }
        if let Some(parameter) = self.parameters.iter().find(|p| p.name == name) {
            return Ok((Value::Constant(parameter.value.clone()), span));
        }
        match ["x", "y", "z"].iter().position(|axis| *axis == name) {
            Some(axis) if self.coordinates => {
                return self.make(span, |builder| builder.push(Operation::Coordinate(axis)));
            }
            Some(_) => return Err(Problem::Coordinate(name.to_owned()).at(span)),
            None => {}
        }
        if name == "pi" {
            return self.make(span, Builder::pi);
        }
        if FUNCTIONS.iter().any(|(known, _)| *known == name) {
            return Err(Problem::NoCall(name.to_owned()).at(span));
        }
        let parameters = self.parameters.iter().map(|p| p.name.as_str());
        // It may be a misspelt function without its arguments.
        let functions = FUNCTIONS.iter().map(|(name, _)| *name);
        let names = RESERVED.iter().copied().chain(parameters).chain(functions);
        Err(Problem::UnknownName(name.to_owned()).at(span).names(names))
    }

    fn call(&mut self, name: &str, span: Range<usize>) -> Parsed {
        let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
            let taken = RESERVED.contains(&name) || self.parameters.iter().any(|p| p.name == name);
            let error = Problem::UnknownFunction(name.to_owned()).at(span);
            return Err(match taken {
                true => error.expected("an operator between a name and \"(\", such as *"),
                false => error.names(FUNCTIONS.iter().map(|(name, _)| *name)),
            });
        };
        let open = self.advance()?.span;
        let mut arguments = Vec::new();
        if !self.at(b')') {
            arguments.push(self.deeper(Self::sum)?.0);
            while self.at(b',') {
                self.advance()?;
                arguments.push(self.deeper(Self::sum)?.0);
            }
        }
        let close = self.close(&open, "one of + - * / ^ , or \")\"")?;
        let whole = span.start..close.end;
        let (wanted, several) = match function {
            Function::Unary(_) => (1, false),
            Function::Binary(function) => (2, *function != Binary::ArcTangent2),
        };
        let found = arguments.len();
        if found < wanted || (found > wanted && !several) {
            let name = name.to_owned();
            let more = if several { " or more" } else { "" };
            let error = Problem::Arguments { name, found }.at(whole);
            return Err(error.expected(format!("{wanted}{more}")));
        }
        self.make(whole, |builder| apply(builder, *function, arguments))
    }
}

/// A function of its arguments, as many as it needs: the caller has counted them.
fn apply(
    builder: &mut Builder,
    function: Function,
    arguments: Vec<Value>,
) -> Result<Value, Problem> {
    let mut arguments = arguments.into_iter();
    let first = arguments.next().ok_or(Problem::End)?;
    match function {
        Function::Unary(function) => builder.unary(function, first),
        Function::Binary(function) => {
            arguments.try_fold(first, |value, next| builder.binary(function, value, next))
        }
    }
}
