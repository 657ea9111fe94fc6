//! Reading the oracle's tables, whose answers come from exact rational arithmetic.

#![allow(
    clippy::unwrap_used,
    reason = "a malformed oracle file must fail the test"
)]

use std::collections::HashMap;
use std::sync::Arc;

use etalon::inside::field::expression::{Expression, Parameter, parse, rational};
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

/// A surface within the cube [−half_width, half_width]³.
pub struct OracleShape {
    /// What rays call it.
    pub name: String,
    /// Half the cube's edge.
    pub half_width: f64,
    /// Its field.
    pub field: Arc<Expression>,
}

impl OracleShape {
    /// The cube's corners.
    pub fn inside(&self) -> [DVec3; 2] {
        [-self.half_width, self.half_width].map(DVec3::splat)
    }
}

/// The surfaces that the rays of [`IMPLICIT`] are about: lines
/// `name;half_width;degree;expression[, NAME=value]` below a heading.
pub fn shapes() -> Vec<OracleShape> {
    let lines = include_str!("data/implicit_shapes.csv").lines().skip(1);
    let shape = |line: &str| {
        let [name, half, _, written] = line.split(';').collect::<Vec<_>>().try_into().unwrap();
        let mut parts = written.split(", ");
        let expression = parts.next().unwrap();
        let parameters = parts.map(|part| {
            let (name, value) = part.split_once('=').unwrap();
            Parameter {
                name: name.to_owned(),
                value: rational(value).unwrap(),
            }
        });
        let parameters: Vec<Parameter> = parameters.collect();
        OracleShape {
            name: name.to_owned(),
            half_width: half.parse().unwrap(),
            field: Arc::new(parse(expression, &parameters).unwrap()),
        }
    };
    lines.map(shape).collect()
}
