//! What a kind of thing is called and which parameters it has, as data in the kind's own file. Scene
//! files are read, checked and listed by it; it knows nothing of files.

use std::ops::{Bound, RangeBounds};

use glam::DVec3;

use crate::spectrum::Spectrum;
use crate::spectrum::ior::RefractiveIndex;

/// What a spectrum is used as, which decides the values that it may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Values in [0, 1].
    Reflectance,
    /// Values from 0.
    Emission,
    /// Real part of a refractive index: values above 0.
    Index,
    /// Extinction coefficient: values from 0.
    Extinction,
}

/// Allowed numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    pub low: Bound<f64>,
    pub high: Bound<f64>,
}

impl Range {
    /// Numbers greater than 0.
    pub const POSITIVE: Self = Self {
        low: Bound::Excluded(0.0),
        high: Bound::Unbounded,
    };

    /// Numbers from 0.
    pub const NOT_NEGATIVE: Self = Self {
        low: Bound::Included(0.0),
        high: Bound::Unbounded,
    };

    /// Numbers from `low` to `high`, both allowed.
    pub const fn between(low: f64, high: f64) -> Self {
        Self {
            low: Bound::Included(low),
            high: Bound::Included(high),
        }
    }

    /// Whether a number is allowed.
    pub fn contains(&self, number: f64) -> bool {
        (self.low, self.high).contains(&number)
    }

    /// What a message expects.
    pub fn words(&self) -> String {
        let end = |bound, included, excluded| match bound {
            Bound::Included(end) => Some(format!("{included} {end}")),
            Bound::Excluded(end) => Some(format!("{excluded} {end}")),
            Bound::Unbounded => None,
        };
        let low = end(self.low, "of at least", "greater than");
        let high = end(self.high, "of at most", "less than");
        let ends: Vec<String> = low.into_iter().chain(high).collect();
        if ends.is_empty() {
            "a finite number".to_owned()
        } else {
            format!("a number {}", ends.join(" and "))
        }
    }
}

/// What a parameter is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantity {
    /// `true`: the key alone says everything.
    True,
    /// A number in a unit.
    Number {
        /// The unit; empty for plain numbers.
        unit: &'static str,
        /// Which numbers are allowed.
        range: Range,
    },
    Spectrum(Role),
    TwoSpectra(Role),
    /// n + ik of a metal: measured and named, or two spectra.
    Metal,
    /// n of a transparent medium: measured and named, a number, or a formula.
    Glass,
    /// A position in the world, scene units.
    Point,
    /// A vector other than zero; its length means nothing.
    Direction,
    /// A table with a key for each of these.
    Table(&'static [Parameter]),
}

impl Quantity {
    pub const fn number(unit: &'static str, range: Range) -> Self {
        Self::Number { unit, range }
    }

    /// As how many spectra the loop reads it.
    pub const fn spectra(self) -> usize {
        match self {
            Self::Spectrum(_) => 1,
            Self::TwoSpectra(_) | Self::Metal | Self::Glass => 2,
            _ => 0,
        }
    }
}

/// What is meant where a key is left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Usual {
    /// This number, or this value at all wavelengths.
    Number(f64),
    Direction(DVec3),
    /// No values: what the key describes is not there.
    Nothing,
}

/// A key and its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    pub key: &'static str,
    /// What it is, in words.
    pub what: &'static str,
    pub quantity: Quantity,
    /// What is meant where the key is left out; `None` if it must be there.
    pub default: Option<Usual>,
}

impl Parameter {
    /// One that must be there.
    pub const fn new(key: &'static str, what: &'static str, quantity: Quantity) -> Self {
        Self {
            key,
            what,
            quantity,
            default: None,
        }
    }

    /// One that may be left out.
    pub const fn usually(self, usual: Usual) -> Self {
        Self {
            default: Some(usual),
            ..self
        }
    }
}

/// A kind of thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Declaration {
    /// The key that says that something is of this kind, and its value.
    pub main: Parameter,
    /// A key in a table that is the value of the main key, whose value is the kind's: kinds that have
    /// the main key in common differ by it.
    pub within: Option<&'static str>,
    /// Parameters beside the main one.
    pub beside: &'static [Parameter],
}

impl Declaration {
    /// A kind whose key says everything.
    pub const fn new(key: &'static str, what: &'static str, quantity: Quantity) -> Self {
        Self {
            main: Parameter::new(key, what, quantity),
            within: None,
            beside: &[],
        }
    }

    /// The kind with these parameters beside the main one.
    pub const fn beside(self, beside: &'static [Parameter]) -> Self {
        Self { beside, ..self }
    }

    /// As how many spectra the loop reads its parameters.
    pub const fn spectra(&self) -> usize {
        let mut count = self.main.quantity.spectra();
        let mut i = 0;
        while i < self.beside.len() {
            count += self.beside[i].quantity.spectra();
            i += 1;
        }
        count
    }
}

/// A parameter's value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Of a [`Quantity::Number`].
    Number(f64),
    /// Of a [`Quantity::Spectrum`]; two of [`Quantity::TwoSpectra`].
    Spectrum(Spectrum),
    /// Of a [`Quantity::Metal`] or [`Quantity::Glass`].
    Index(RefractiveIndex),
    Point(DVec3),
    /// Of length 1.
    Direction(DVec3),
}

impl Value {
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    pub fn spectrum(&self) -> Option<&Spectrum> {
        match self {
            Self::Spectrum(spectrum) => Some(spectrum),
            _ => None,
        }
    }

    /// The vector of a point or direction.
    pub fn vector(&self) -> Option<DVec3> {
        match self {
            Self::Point(vector) | Self::Direction(vector) => Some(*vector),
            _ => None,
        }
    }
}
