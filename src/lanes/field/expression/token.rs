//! Words of an expression.

use std::ops::Range;

use num_bigint::BigInt;
use num_rational::BigRational;

use super::MOST_BITS;
use super::error::{ExpressionError, Problem};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Word {
    Number,
    Name,
    /// One of + - * / ^ ( ) and the comma.
    Mark(u8),
    End,
}

#[derive(Debug, Clone)]
pub(super) struct Token {
    pub word: Word,
    pub span: Range<usize>,
}

/// The word that begins at or after `from`.
pub(super) fn next(text: &str, from: usize) -> Result<Token, ExpressionError> {
    let bytes = text.as_bytes();
    let start = from + count(&bytes[from..], |b| b.is_ascii_whitespace());
    let rest = &bytes[start..];
    let token = |word, length| Token {
        word,
        span: start..start + length,
    };
    let Some(&first) = rest.first() else {
        return Ok(token(Word::End, 0));
    };
    match first {
        b'+' | b'-' | b'*' | b'/' | b'^' | b'(' | b')' | b',' => Ok(token(Word::Mark(first), 1)),
        b'0'..=b'9' | b'.' => match number_length(rest) {
            0 => Err(Problem::Character('.').at(start..start + 1)),
            length => Ok(token(Word::Number, length)),
        },
        _ if begins_name(first) => Ok(token(Word::Name, count(rest, in_name))),
        _ => {
            let character = text[start..].chars().next().unwrap_or(' ');
            let span = start..start + character.len_utf8();
            let error = Problem::Character(character).at(span);
            Err(match plain(character) {
                Some(written) => error.expected(format!("\"{written}\"")),
                None => error,
            })
        }
    }
}

/// How a typographic sign is written here.
fn plain(character: char) -> Option<&'static str> {
    Some(match character {
        '−' | '–' => "-",
        '·' | '×' | '⋅' => "*",
        '÷' => "/",
        'π' => "pi",
        '√' => "sqrt",
        '²' => "^2",
        '³' => "^3",
        '[' | '{' => "(",
        ']' | '}' => ")",
        '=' => "an expression f that stands for the surface f = 0",
        _ => return None,
    })
}

fn count(bytes: &[u8], test: impl Fn(u8) -> bool) -> usize {
    bytes.iter().take_while(|b| test(**b)).count()
}

fn begins_name(byte: u8) -> bool {
    byte.is_ascii_alphabetic() || byte == b'_'
}

fn in_name(byte: u8) -> bool {
    begins_name(byte) || byte.is_ascii_digit()
}

pub(super) fn is_name(text: &str) -> bool {
    text.bytes().next().is_some_and(begins_name) && text.bytes().all(in_name)
}

/// Length of digits with an optional point and exponent; 0 where there are no digits. An `e` without
/// digits after it is not part of the number.
fn number_length(bytes: &[u8]) -> usize {
    let digits = |from: usize| count(&bytes[from..], |b| b.is_ascii_digit());
    let whole = digits(0);
    let mut length = whole;
    if bytes.get(length) == Some(&b'.') {
        let fraction = digits(length + 1);
        length += 1 + fraction;
        if whole + fraction == 0 {
            return 0;
        }
    }
    if length == 0 {
        return 0;
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let exponent = digits((length + 1 + sign).min(bytes.len()));
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}

/// The rational number that a decimal denotes: an optional sign, digits, an optional point, an optional
/// exponent. `None` where it is something else or beyond [`MOST_BITS`].
pub fn rational(text: &str) -> Option<BigRational> {
    let (negative, unsigned) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let bytes = unsigned.as_bytes();
    if bytes.is_empty() || number_length(bytes) != bytes.len() {
        return None;
    }
    let (significand, exponent) = unsigned.split_once(['e', 'E']).unwrap_or((unsigned, "0"));
    let (whole, fraction) = significand.split_once('.').unwrap_or((significand, ""));
    let digits: String = [whole, fraction].concat();
    // Ten needs more than three bits: longer ones are beyond the limit in any case.
    let most = MOST_BITS as usize / 3;
    let digits = digits.trim_start_matches('0');
    if digits.is_empty() {
        return Some(BigRational::default());
    }
    if digits.len() > most {
        return None;
    }
    let exponent = exponent.parse::<i64>().ok()?;
    let exponent = exponent.checked_sub(i64::try_from(fraction.len()).ok()?)?;
    if exponent.unsigned_abs() > most as u64 {
        return None;
    }
    let power = BigInt::from(10).pow(exponent.unsigned_abs() as u32);
    let digits: BigInt = digits.parse().ok()?;
    let digits = if negative { -digits } else { digits };
    let value = if exponent < 0 {
        BigRational::new(digits, power)
    } else {
        BigRational::from_integer(digits * power)
    };
    fits(&value).then_some(value)
}

/// Whether a constant is within [`MOST_BITS`].
pub(super) fn fits(value: &BigRational) -> bool {
    value.numer().bits().max(value.denom().bits()) <= MOST_BITS
}
