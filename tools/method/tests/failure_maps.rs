//! What the plan takes stands on the safe side of every failure map.

use etalon_method::failures::chart::{csv, svg};
use etalon_method::failures::families::FAMILIES;
use etalon_method::failures::{Method, Point, SUBJECTS, points};
use etalon_method::finders::Precision;
use rayon::prelude::*;

/// Rays a point: with a share of one in ten wrong, one point alone would show it with 9 in 10.
const RAYS: usize = 24;

/// Each shape and family at every other difficulty, the hardest included.
fn sample() -> Vec<Point> {
    let pairs = SUBJECTS
        .into_iter()
        .flat_map(|subject| FAMILIES.map(|family| (subject, family)));
    let pairs: Vec<_> = pairs.collect();
    pairs
        .into_par_iter()
        .flat_map_iter(|(subject, family)| {
            let exponents = family.exponents().into_iter().rev().step_by(2);
            exponents.flat_map(move |exponent| points(subject, family, exponent, RAYS))
        })
        .collect()
}

fn total(points: &[Point], which: impl Fn(&Point) -> bool) -> [u32; 3] {
    let chosen = points.iter().filter(|p| which(p));
    chosen.fold([0; 3], |[rays, wrong, undecided], p| {
        let score = p.score;
        [
            rays + score.rays,
            wrong + score.wrong,
            undecided + score.undecided,
        ]
    })
}

#[test]
fn the_plan_stands_on_the_safe_side() {
    let points = sample();
    let unsafe_ones: Vec<&Point> = points.iter().filter(|p| !p.is_safe()).collect();
    assert!(unsafe_ones.is_empty(), "{unsafe_ones:#?}");
    // Every point was asked about, or the above says nothing.
    assert!(points.iter().all(|p| p.score.rays == RAYS as u32));
    let planned = |precision| {
        let single = |p: &Point| p.method == Method::Ladder && p.precision == precision;
        total(&points, single)[0]
    };
    assert!(planned(Precision::Single) > 0 && planned(Precision::Double) > 0);
    // And the rays are hard: what believes its rounding is wrong on many.
    for precision in [Precision::Single, Precision::Double] {
        for method in [Method::Textbook(precision), Method::SignChange(precision)] {
            let [rays, wrong, _] = total(&points, |p| p.method == method);
            println!("{method:?}: {wrong} of {rays}");
            assert!(wrong > rays / 50, "{method:?}: {wrong} of {rays}");
        }
    }
    for family in FAMILIES {
        let textbook = Method::Textbook(Precision::Single);
        let [rays, wrong, _] = total(&points, |p| p.family == family && p.method == textbook);
        assert!(wrong > 0, "{family:?}: none of {rays}");
    }
    // The table has them all, the picture a row for each shape.
    assert_eq!(csv(&points).lines().count(), points.len() + 1);
    let picture = svg(&points).unwrap_or_else(|error| panic!("{error}"));
    assert!(SUBJECTS.iter().all(|s| picture.contains(s.name())));
}
