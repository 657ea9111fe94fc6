//! Reading the oracle's tables, whose answers come from exact rational arithmetic.

use std::collections::HashMap;
use std::path::Path;

use etalon::inside::math::affine::Affine;
use etalon::inside::shape::{Placed, Query, Ray, ShapeKind};
use glam::DVec3;

use crate::support::from_zero;

#[path = "../tools/method/src/finders/shapes.rs"]
mod shapes;

pub use shapes::OracleShape;
use shapes::read_shapes;

/// A line by the names of its columns.
pub type Row = HashMap<String, String>;

/// The lines below the heading.
pub fn table(text: &str) -> Vec<Row> {
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

/// The lines of a file in `tests/data`. In those of rays every number is meant exactly; t has 22
/// digits, of which the nearest f64 is taken.
pub fn rows(file: &str) -> Vec<Row> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    table(&std::fs::read_to_string(folder.join(file)).unwrap())
}

pub fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap()
}

/// Three columns as a vector.
pub fn vector(row: &Row, names: [&str; 3]) -> DVec3 {
    DVec3::from_array(names.map(|name| number(row, name)))
}

pub fn ray(row: &Row) -> Ray {
    Ray {
        origin: vector(row, ["ox", "oy", "oz"]),
        direction: vector(row, ["dx", "dy", "dz"]),
    }
}

/// What a ray of `implicit.csv` asks.
pub fn query(row: &Row) -> Query {
    Query {
        t_min: number(row, "tmin"),
        ..from_zero(ray(row).origin, ray(row).direction)
    }
}

/// The placed shape that each of the primitives' rays is about, with the condition of its matrix.
pub fn primitives() -> Vec<(Row, Placed, f64)> {
    let transform = |row: &Row| {
        let entry = |i: usize, j: usize| number(row, &format!("m{i}{j}"));
        let rows = [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| entry(i, j)));
        let value = (Affine { rows }, number(row, "cond_made"));
        (row["transform"].clone(), value)
    };
    let transforms: HashMap<_, _> = rows("transforms.csv").iter().map(transform).collect();
    let placed = |row: Row| {
        // A rectangle is "rect" there.
        let is_named = |kind: &&ShapeKind| {
            format!("{kind:?}")
                .to_lowercase()
                .starts_with(&row["shape"])
        };
        let kind = *ShapeKind::ALL.iter().find(is_named).unwrap();
        let (matrix, condition) = &transforms[&row["transform"]];
        let placed = Placed::new(kind, matrix).unwrap();
        (row, placed, *condition)
    };
    rows("primitives.csv").into_iter().map(placed).collect()
}

/// What is wrong with the first hit, t and normal, of a ray of the primitives' oracle.
pub fn primitive_fault(want: &Row, hit: Option<(f64, DVec3)>) -> Option<String> {
    let id = &want["id"];
    if want["touch"] == "1" {
        let (Some((t, _)), false) = (hit, want["t0"].is_empty()) else {
            return None;
        };
        let (t0, t1) = (number(want, "t0"), number(want, "t1"));
        // The printed bounds are read to within one unit in the last place.
        let slack = 2.0 * f64::EPSILON * t0.abs().max(t1.abs());
        let within = t >= t0 - slack && t <= t1 + slack;
        return (!within).then(|| format!("{id}: touch at {t}, not in [{t0}, {t1}]"));
    }
    if hit.is_some() != (want["hit"] == "1") {
        return Some(format!("{id}: hit {}, want {}", hit.is_some(), want["hit"]));
    }
    let (t, normal) = hit?;
    if !want["t"].is_empty() {
        let wanted = number(want, "t");
        // t is rounded from at least 57 good bits, by half a unit; the printed value is read likewise.
        if (t - wanted).abs() > 2.0 * f64::EPSILON * wanted.abs().max(f64::MIN_POSITIVE) {
            return Some(format!("{id}: t {t:?}, want {wanted:?}"));
        }
    }
    if !want["nx"].is_empty() {
        let wanted = vector(want, ["nx", "ny", "nz"]);
        // The normal of a condition number κ is as sharp as that of 1: it does not come from a rounded
        // inverse. One unit of rounding, and half a unit of the 15 digits that are printed.
        if (normal - wanted).abs().max_element() > f64::EPSILON + 1e-15 {
            return Some(format!("{id}: normal {normal}, want {wanted}"));
        }
    }
    None
}

/// The surfaces that the rays of `implicit.csv` are about.
pub fn shapes() -> Vec<OracleShape> {
    read_shapes(include_str!("data/implicit_shapes.csv")).unwrap()
}
