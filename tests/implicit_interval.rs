//! The finders that work with enclosures: never wrong where they say that they know.

use std::collections::HashMap;

use etalon::inside::field::expression::parse;
use etalon::inside::field::interval_program::IntervalProgram;
use etalon::inside::field::over_box;
use etalon::inside::math::affine::Affine;
use etalon::inside::root::Outcome;
use etalon::inside::root::interval::{Enclosed, PIECES, Pieces, first_zero};
use etalon::inside::shape::Query;
use etalon::inside::shape::implicit::enclosed::{EnclosedField, Method, Searching};
use etalon::inside::shape::ladder::{Ladder, ScaledRay};
use glam::DVec3;

use crate::lanes_support::on_each;
use crate::oracle_support::{Row, number, query, rows, shapes};
use crate::support::{cube, from_zero};

/// Outcome with t in units of the ray's direction.
fn first_hit(field: &EnclosedField, half: f64, query: &Query, searching: &Searching) -> Outcome {
    let ladder = Ladder::new(&Affine::IDENTITY).unwrap();
    let scaled = ScaledRay::new(&query.ray);
    let unit = 2f64.powi(scaled.exponent);
    let local = ladder.double_double.local(&scaled);
    let inside = cube(half);
    let limits = [query.t_min * unit, f64::MAX];
    let mut found = field.first_hit(&local, &inside, limits, searching);
    if let Outcome::Found(root) = &mut found.outcome {
        root.enclosure = root.enclosure.map(|t| t / unit);
    }
    found.outcome
}

/// The first hit of a field as it is written, within a cube of edge 4.
fn written(text: &str, from: DVec3, direction: DVec3) -> Outcome {
    let field = EnclosedField::new(&parse(text, &[]).unwrap().tape);
    let query = from_zero(from, direction);
    first_hit(&field, 2.0, &query, &Searching::default())
}

/// Whether an outcome is a root that is this t, give or take `slack`.
fn is_at(outcome: Outcome, t: f64, slack: f64) -> bool {
    matches!(outcome, Outcome::Found(root)
        if root.enclosure[0] - slack <= t && t <= root.enclosure[1] + slack)
}

/// Runs oracle rays; returns how many stay undecided. Found must hold the true t, which is given with
/// 22 digits, and know its multiplicity or say that it does not.
fn undecided(rows: &[Row], method: Method, bound: u32) -> usize {
    let searching = Searching {
        method,
        bound,
        ..Searching::default()
    };
    let ready = shapes().into_iter().map(|shape| {
        let field = EnclosedField::new(&shape.field.tape);
        (shape.name, (field, shape.half_width))
    });
    let ready: HashMap<String, (EnclosedField, f64)> = ready.collect();
    let mut undecided = 0;
    for row in rows {
        let (field, half) = &ready[&row["shape"]];
        let (id, hits) = (&row["id"], row["hit"] == "1");
        let outcome = first_hit(field, *half, &query(row), &searching);
        match outcome {
            Outcome::Undecided => undecided += 1,
            Outcome::Absent => assert!(!hits, "{id}: not absent"),
            Outcome::Found(root) => {
                assert!(hits, "{id}: nothing is there");
                let t = number(row, "t");
                assert!(is_at(outcome, t, 0.0), "{id}: {t} not in {root:?}");
                let multiplicity = row["mult"].parse().unwrap();
                let known = root.multiplicity.unwrap_or(multiplicity);
                assert_eq!(known, multiplicity, "{id}");
            }
        }
    }
    undecided
}

/// 81 of 3 040 rays stay undecided, at even roots and within rounding of them; a simple
/// implementation leaves 209.
#[test]
fn subdivision_is_never_wrong_on_the_oracle() {
    let count = undecided(&rows("implicit.csv"), Method::Subdivision, 2_000);
    assert!(count <= 81, "{count} undecided");
}

/// Sphere tracing with a proved bound, on every tenth ray and with few steps: never wrong either.
#[test]
fn spheres_are_never_wrong_on_the_oracle() {
    let rows: Vec<Row> = rows("implicit.csv").into_iter().step_by(10).collect();
    let count = undecided(&rows, Method::Spheres, 400);
    assert!(count < rows.len() * 9 / 10, "{count} undecided");
}

/// Each instruction set gives the same bits, one lane after the other too.
#[test]
fn instruction_sets_agree() {
    let fields = [
        "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)",
        "exp(-x^2 - y^2) - tanh(z)/2 + log(2 + x)/9",
        "max(abs(x) - 1, min(y, z)) - asin(x/9)*acos(y/9) + atan2(z + 9, x + 20) - sqrt(x + 9)/4",
        "cosh(x/2) - sinh(y/3) - (z + 5)^(1/3) - tan(x/9)",
    ];
    for text in fields {
        let tape = parse(text, &[]).unwrap().tape;
        let field = EnclosedField::new(&tape);
        let mut decided = 0;
        for row in rows("implicit.csv").iter().step_by(40) {
            let hits = on_each(|instructions| {
                let searching = Searching {
                    instructions,
                    ..Searching::default()
                };
                first_hit(&field, 2.0, &query(row), &searching)
            });
            let same = hits.iter().all(|(_, hit)| *hit == hits[0].1);
            assert!(same, "{text} {}: {hits:?}", row["id"]);
            decided += usize::from(hits[0].1 != Outcome::Undecided);
        }
        assert!(decided > 60, "{text}: only {decided} decided");
    }
}

/// A function whose enclosures are off by a shift, as unsound rounding would make them.
struct Shifted(f64);

impl Enclosed for Shifted {
    fn over(&mut self, from: &[f64; PIECES], to: &[f64; PIECES]) -> Pieces {
        // (t − ½)² over pieces of [0, 1].
        let value = |i: usize| {
            let (a, b) = (from[i] - 0.5, to[i] - 0.5);
            let low = if a * b < 0.0 { 0.0 } else { (a * a).min(b * b) };
            [low - 1e-15, (a * a).max(b * b) + 1e-15].map(|end| end + self.0)
        };
        Pieces {
            value: [0, 1].map(|k| std::array::from_fn(|i| value(i)[k])),
            slope: [(from, -1e-15), (to, 1e-15)].map(|(t, off)| t.map(|t| 2.0 * (t - 0.5) + off)),
            broken: 0,
            void: 0,
        }
    }

    fn at(&mut self, t: &[f64; PIECES]) -> [[f64; PIECES]; 2] {
        self.over(t, t).value
    }
}

/// A double root can neither be proved nor excluded; one that is lifted off zero by more than the
/// enclosures' width is excluded, and that is what an unsound enclosure would do to the root.
#[test]
fn double_roots_stay_undecided_unless_enclosures_are_unsound() {
    let outcome = |shift| first_zero(&mut Shifted(shift), [0.0, 1.0], 2_000).outcome;
    assert_eq!(outcome(0.0), Outcome::Undecided);
    assert_eq!(outcome(1e-14), Outcome::Absent);
    assert!(matches!(outcome(-1e-6), Outcome::Found(_)));
}

/// The work bound ends a search that has nothing to hold on to.
#[test]
fn the_work_bound_ends_a_search() {
    struct Unknown;
    impl Enclosed for Unknown {
        fn over(&mut self, _: &[f64; PIECES], _: &[f64; PIECES]) -> Pieces {
            let all = [[f64::NEG_INFINITY; PIECES], [f64::INFINITY; PIECES]];
            Pieces {
                value: all,
                slope: all,
                broken: 0xff,
                void: 0,
            }
        }
        fn at(&mut self, _: &[f64; PIECES]) -> [[f64; PIECES]; 2] {
            [[1.0; PIECES], [1.0; PIECES]]
        }
    }
    let search = first_zero(&mut Unknown, [0.0, 1.0], 100);
    assert_eq!(search.outcome, Outcome::Undecided);
    assert!(search.evaluations <= 102, "{}", search.evaluations);
}

/// A zero of one factor is none of the product where another factor is undefined.
#[test]
fn undefined_factors_hide_zeros() {
    let outcome = |text: &str| written(text, DVec3::new(-5.0, 0.5, -0.5), DVec3::X);
    assert_eq!(outcome("x*sqrt(z)"), Outcome::Absent);
    assert!(matches!(outcome("x*sqrt(y)"), Outcome::Found(_)));
}

/// The bound of a square's slopes is none of its root's: |∇g²| may be far below |∇g|.
#[test]
fn factors_have_bounds_of_their_own() {
    let tape = parse("((x^2 + y^2 + z^2 - 1/4)/100)^2", &[]).unwrap().tape;
    let inside = cube(1.0);
    let field = EnclosedField::new(&tape).surveyed(&inside);
    let searching = Searching {
        method: Method::Spheres,
        ..Searching::default()
    };
    let query = from_zero(DVec3::new(-3.0, 0.1, 0.2), DVec3::X);
    let outcome = first_hit(&field, 1.0, &query, &searching);
    assert!(is_at(outcome, 3.0 - 0.2f64.sqrt(), 1e-12), "{outcome:?}");
}

/// What is proved of a field over a box, the same on every instruction set.
#[test]
fn boxes_are_surveyed() {
    let survey = |text: &str| {
        let program = IntervalProgram::new(&parse(text, &[]).unwrap().tape);
        let inside = cube(1.0);
        let all = on_each(|set| over_box::survey(set, &program, &inside));
        assert!(all.iter().all(|(_, other)| *other == all[0].1), "{all:?}");
        all[0].1
    };
    assert!(survey("sqrt(x - 2)").undefined);
    assert!(survey("x^2 + y^2 + z^2 + 1/10").empty);
    let sphere = survey("x^2 + y^2 + z^2 - 1/2");
    assert!(!sphere.empty && !sphere.undefined && !sphere.maybe_undefined);
    // |∇f| = 2r is 2√3 in the corners, and a part of the box is no sharper than that.
    let range = 12f64.sqrt()..3.5;
    assert!(range.contains(&sphere.steepness), "{sphere:?}");
    assert!(survey("log(x) - 3").maybe_undefined);
}

/// Where a field jumps from one sign to the other there is no surface: poles and the cut of the
/// angle are looked at from both sides, and neither found nor left undecided.
#[test]
fn jumps_are_no_hits() {
    let along = |text: &str| written(text, DVec3::new(-5.0, 0.2, 0.3), DVec3::X);
    let texts = "1/x; 1/x^3 + x; x^-5; atan2(x, y - 9) + y; 1/(x^2 - 2) - y";
    for text in texts.split(';') {
        assert_eq!(along(text), Outcome::Absent, "{text}");
    }
    // The pole at x = π/2 − 3/2 comes before the zero at x = arctan 20 − 3/2 − π.
    let zero = 5.0 + 20f64.atan() - 1.5;
    let outcome = along("tan(x + 3/2) - 20");
    assert!(is_at(outcome, zero, 1e-9), "{outcome:?}");
    let after = along("tan(x + 3/2) + 1000");
    assert!(matches!(after, Outcome::Found(_)), "{after:?}");
}
