//! The primitives' oracle: rays with answers from exact rational arithmetic.
//!
//! `tests/data/primitives.csv`, `tests/data/transforms.csv`: every ray is meant exactly as its f64
//! numbers; 22 significant digits of t.

#![allow(
    clippy::unwrap_used,
    reason = "a malformed oracle file must fail the test"
)]

use std::collections::HashMap;

use etalon::inside::math::affine::Affine;
use etalon::inside::shape::{Placed, Ray, ShapeKind, Start, Tally};

use crate::oracle_support::{number, rows, vector};

fn kind(name: &str) -> ShapeKind {
    match name {
        "sphere" => ShapeKind::Sphere,
        "cube" => ShapeKind::Cube,
        "cylinder" => ShapeKind::Cylinder,
        "rect" => ShapeKind::Rectangle,
        "disk" => ShapeKind::Disk,
        other => panic!("unknown shape {other}"),
    }
}

struct Transform {
    condition: f64,
    matrix: Affine,
}

fn transforms() -> HashMap<String, Transform> {
    rows(include_str!("data/transforms.csv"))
        .iter()
        .map(|row| {
            let entry = |i: usize, j: usize| number(row, &format!("m{i}{j}"));
            let matrix = Affine {
                rows: [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| entry(i, j))),
            };
            let condition = number(row, "cond_made");
            (row["transform"].clone(), Transform { condition, matrix })
        })
        .collect()
}

/// The oracle prints normals with 15 digits: half a unit of the last, per component.
const PRINTED_NORMAL: f64 = 1e-15;

#[test]
fn every_ray_agrees_with_the_oracle() {
    let transforms = transforms();
    let mut tally = Tally::default();
    let (mut worst_t, mut worst_normal, mut compared) = (0.0_f64, 0.0_f64, 0);
    let mut failures = Vec::new();
    let table = rows(include_str!("data/primitives.csv"));
    for row in &table {
        let id = &row["id"];
        let placed =
            Placed::new(kind(&row["shape"]), &transforms[&row["transform"]].matrix).unwrap();
        let ray = Ray {
            origin: vector(row, ["ox", "oy", "oz"]),
            direction: vector(row, ["dx", "dy", "dz"]),
        };
        let hit = placed.first_hit(&ray, number(row, "tmin"), Start::Free, &mut tally);
        if let Some(hit) = &hit {
            let unit = (hit.normal.length() - 1.0).abs() < 4.0 * f64::EPSILON;
            if !(hit.t.is_finite() && hit.point.is_finite() && hit.local.is_finite() && unit) {
                failures.push(format!("{id}: not a proper hit: {hit:?}"));
            }
        }
        if row["touch"] == "1" {
            if let (Some(hit), false) = (&hit, row["t0"].is_empty()) {
                let (t0, t1) = (number(row, "t0"), number(row, "t1"));
                // The printed bounds are read to within one unit in the last place.
                let slack = 2.0 * f64::EPSILON * t0.abs().max(t1.abs());
                if !(hit.t >= t0 - slack && hit.t <= t1 + slack) {
                    failures.push(format!("{id}: touch at {} not in [{t0}, {t1}]", hit.t));
                }
            }
            continue;
        }
        if hit.is_some() != (row["hit"] == "1") {
            failures.push(format!("{id}: hit {}, want {}", hit.is_some(), row["hit"]));
            continue;
        }
        let Some(hit) = hit else { continue };
        if !row["t"].is_empty() {
            let t = number(row, "t");
            let error = (hit.t - t).abs() / t.abs().max(f64::MIN_POSITIVE);
            worst_t = worst_t.max(error);
            compared += 1;
        }
        if !row["nx"].is_empty() {
            let normal = vector(row, ["nx", "ny", "nz"]);
            worst_normal = worst_normal.max((hit.normal - normal).abs().max_element());
            let outward = hit.normal.dot(ray.direction);
            let condition = transforms[&row["transform"]].condition;
            // Not more than rounding of the dot product's own terms can hide.
            if outward.abs() > 1e-12 * condition * ray.direction.length()
                && hit.front != (outward < 0.0)
            {
                failures.push(format!("{id}: front {}, n·d {outward}", hit.front));
            }
        }
    }
    println!("{tally:?}, t within {worst_t:e}, normals within {worst_normal:e}");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert_eq!((table.len(), compared), (3000, 1557));
    assert_eq!(tally.double + tally.double_double + tally.exact, 3000);
    // t is rounded from at least 57 good bits, by half a unit; the printed value is read likewise.
    assert!(worst_t <= 2.0 * f64::EPSILON, "{worst_t:e}");
    // The normal of a condition number κ is as sharp as that of 1: it does not come from a rounded
    // inverse. One unit of rounding, and the printed digits.
    assert!(
        worst_normal <= f64::EPSILON + PRINTED_NORMAL,
        "{worst_normal:e}"
    );
}
