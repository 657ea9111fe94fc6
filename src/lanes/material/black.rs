//! A surface that reflects nothing; where a path meets it, it ends.

use super::Material;
use crate::declare::{Declaration, Quantity};

/// Nothing is reflected.
pub struct Black;

impl Material for Black {
    const DECLARATION: Declaration = Declaration::new("black", "no reflection", Quantity::True);
    const WORDS: &'static str = "black";
}
