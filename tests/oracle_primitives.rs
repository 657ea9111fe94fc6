//! The primitives' oracle: rays with answers from exact rational arithmetic.
//!
//! `tests/data/primitives.csv`, `tests/data/transforms.csv`: every ray is meant exactly as its f64
//! numbers; 22 significant digits of t.

use etalon::inside::shape::{Start, Tally};

use crate::oracle_support::{number, primitive_fault, primitives, ray};

#[test]
fn every_ray_agrees_with_the_oracle() {
    let mut tally = Tally::default();
    let mut compared = 0;
    let mut failures = Vec::new();
    let table = primitives();
    for (row, placed, condition) in &table {
        let (id, ray) = (&row["id"], ray(row));
        let hit = placed.first_hit(&ray, number(row, "tmin"), Start::Free, &mut tally);
        failures.extend(primitive_fault(row, hit.map(|hit| (hit.t, hit.normal))));
        let Some(hit) = hit else { continue };
        let unit = (hit.normal.length() - 1.0).abs() < 4.0 * f64::EPSILON;
        if !(hit.t.is_finite() && hit.point.is_finite() && hit.local.is_finite() && unit) {
            failures.push(format!("{id}: not a proper hit: {hit:?}"));
        }
        if row["touch"] == "1" {
            continue;
        }
        compared += usize::from(!row["t"].is_empty());
        let outward = hit.normal.dot(ray.direction);
        // Not more than rounding of the dot product's own terms can hide.
        let clear = outward.abs() > 1e-12 * condition * ray.direction.length();
        if !row["nx"].is_empty() && clear && hit.front != (outward < 0.0) {
            failures.push(format!("{id}: front {}, n·d {outward}", hit.front));
        }
    }
    println!("{tally:?}");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert_eq!((table.len(), compared), (3000, 1557));
    assert_eq!(tally.double + tally.double_double + tally.exact, 3000);
}
