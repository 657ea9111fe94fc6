//! Reading the oracle's tables, whose answers come from exact rational arithmetic.

#![allow(
    clippy::unwrap_used,
    reason = "a malformed oracle file must fail the test"
)]

use std::collections::HashMap;

use etalon::study::finders::{Oracle, OracleShape};
use glam::DVec3;

/// Rays with implicit surfaces: every number is meant exactly, t to 22 digits.
pub const IMPLICIT: &str = include_str!("data/implicit.csv");

/// A line by the names of its columns.
pub type Row = HashMap<String, String>;

/// The lines below the heading.
pub fn rows(text: &str) -> Vec<Row> {
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

/// A column as a number.
pub fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap()
}

/// Three columns as a vector.
pub fn vector(row: &Row, names: [&str; 3]) -> DVec3 {
    DVec3::from_array(names.map(|name| number(row, name)))
}

/// The surfaces that the rays of [`IMPLICIT`] are about.
pub fn shapes() -> Vec<OracleShape> {
    Oracle::new(None, None).unwrap().shapes
}
