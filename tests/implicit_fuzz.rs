//! Invented expressions, sensible and senseless: none may panic, none may hang, and what is said to be
//! proved must be so.

use std::time::{Duration, Instant};

use etalon::inside::field::evaluate::Field;
use etalon::inside::field::expression::parse;
use etalon::inside::math::affine::Affine;
use etalon::inside::scene::FinderChoice;
use etalon::inside::shape::implicit::certified::Workspace;
use etalon::inside::shape::implicit::placed::{ImplicitAnswer, PlacedImplicit};
use etalon::inside::shape::{Ray, Tally};
use glam::DVec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::support::{from_zero, implicit, words};

const FUNCTIONS: &str = "sqrt abs exp log sin cos tan asin acos atan sinh cosh tanh";
/// Of these, the ones that are defined and continuous everywhere.
const TOTAL: &str = "abs sin cos atan tanh sinh";
const CONSTANTS: &str =
    "0 1 2 -1 1/3 9/80 pi 1e300 1e-300 1e400 (0/0) (1/0) 1e-17 12345678901234567890";
const EXPONENTS: &str = "2 3 -1 -2 0 0.5 1/3 7 20 1000 x 100000";

fn pick<'a>(random: &mut impl Rng, from: &'a str) -> &'a str {
    let from = words(from);
    from[random.random_range(0..from.len())]
}

/// An expression of some depth; a `tame` one has no poles, no undefined places and no huge numbers.
fn invented(random: &mut Pcg64Mcg, depth: u32, tame: bool) -> String {
    if depth == 0 || random.random_bool(0.1) {
        let from = match (random.random_bool(0.7), tame) {
            (true, _) => "x y z",
            (false, true) => "1 1/3 0.25 2",
            (false, false) => CONSTANTS,
        };
        return pick(random, from).to_owned();
    }
    let [a, b] = [(); 2].map(|()| invented(random, depth - 1, tame));
    let kind = random.random_range(0..10);
    let mut any = |of_tame, of_all| pick(random, if tame { of_tame } else { of_all });
    match kind {
        0..5 => format!("({a} {} {b})", any("+ - *", "+ - * /")),
        5 => format!("({a})^{}", any("2 3", EXPONENTS)),
        6..8 => format!("{}({a})", any(TOTAL, FUNCTIONS)),
        8 => format!("{}({a}, {b})", any("min max", "min max atan2")),
        _ => format!("-{a}"),
    }
}

fn placed(text: &str, finder: FinderChoice) -> Option<(PlacedImplicit, Field)> {
    let field = parse(text, &[]).ok()?;
    let scalar = Field::new(&field.tape);
    let implicit = implicit(field, 1.0, finder);
    let placed = PlacedImplicit::new(&implicit, &Affine::IDENTITY).unwrap();
    Some((placed, scalar))
}

/// A ray through the box; some lie in planes and along axes.
fn ray(random: &mut Pcg64Mcg) -> Ray {
    let mut direction = DVec3::ZERO;
    while direction == DVec3::ZERO {
        let mut one = || [-1.0, 0.0, random.random_range(-1.0..1.0)][random.random_range(0..3)];
        direction = DVec3::new(one(), one(), one());
    }
    let mut one = || random.random_range(-0.9..0.9);
    let target = DVec3::new(one(), one(), one());
    let origin = target - direction * 4.0;
    Ray { origin, direction }
}

fn ask(placed: &PlacedImplicit, ray: Ray, workspace: &mut Workspace) -> ImplicitAnswer {
    let query = from_zero(ray.origin, ray.direction);
    placed.first_hit(&query, workspace, &mut Tally::default())
}

const FINDERS: [FinderChoice; 4] = [
    FinderChoice::Auto,
    FinderChoice::Interval,
    FinderChoice::SphereTrace,
    FinderChoice::SignChange,
];

/// A millisecond or two is what the work bound allows; this is a machine that is busy otherwise.
const LONGEST: Duration = Duration::from_secs(2);

#[test]
fn no_expression_panics_or_hangs() {
    let mut random = Pcg64Mcg::seed_from_u64(8);
    let mut workspace = Workspace::default();
    let (mut fields, mut refused) = (0, 0);
    for case in 0..600 {
        let depth = random.random_range(1..7);
        let text = invented(&mut random, depth, false);
        let start = Instant::now();
        let finder = FINDERS[case % FINDERS.len()];
        let Some((placed, _)) = placed(&text, finder) else {
            refused += 1;
            continue;
        };
        fields += 1;
        for _ in 0..6 {
            let ray = ray(&mut random);
            if let ImplicitAnswer::Found(hit) = ask(&placed, ray, &mut workspace) {
                let sound = hit.t.is_finite() && hit.point.is_finite();
                let unit = hit.normal.is_none_or(|n| (n.length() - 1.0).abs() < 1e-12);
                assert!(sound && unit, "{text}: {hit:?}");
            }
        }
        assert!(start.elapsed() < LONGEST, "{text}: {:?}", start.elapsed());
    }
    println!("{fields} fields, {refused} refused");
    assert!(fields > 200 && refused > 50);
}

/// Where a tame field changes its sign between two points of a ray, clear of its rounding, the first
/// hit is not behind them, and none is no answer.
#[test]
fn no_change_of_sign_is_called_absent() {
    let mut random = Pcg64Mcg::seed_from_u64(9);
    let mut workspace = Workspace::default();
    let (mut changes, mut undecided) = (0, 0);
    for case in 0..400 {
        let depth = random.random_range(2..6);
        let text = invented(&mut random, depth, true);
        let finder = FINDERS[case % 3];
        let Some((placed, field)) = placed(&text, finder) else {
            continue;
        };
        for _ in 0..6 {
            let ray = ray(&mut random);
            let at = |t: f64| ray.origin + ray.direction * t;
            let steps = (0..=256).map(|i| f64::from(i) / 32.0);
            let inside = steps.filter(|t| at(*t).abs().max_element() < 1.0);
            let values: Vec<(f64, f64)> = inside.map(|t| (t, field.value(at(t)))).collect();
            let changed = values.windows(2).find(|pair| {
                let [(_, a), (_, b)] = [pair[0], pair[1]];
                a * b < 0.0 && a.abs().min(b.abs()) > 1e-9 && a.abs().max(b.abs()) < 1e3
            });
            let Some(&[_, (end, _)]) = changed else {
                continue;
            };
            changes += 1;
            match ask(&placed, ray, &mut workspace) {
                ImplicitAnswer::Found(hit) => assert!(hit.enclosure[0] <= end, "{text}: {hit:?}"),
                ImplicitAnswer::Undecided => undecided += 1,
                ImplicitAnswer::Absent => panic!("{text}: absent before {end} on {ray:?}"),
            }
        }
    }
    println!("{changes} changes of sign, {undecided} undecided");
    assert!(changes > 300 && undecided < changes / 2);
}
