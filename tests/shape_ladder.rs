//! Every tier of the ladder against the exact one, on rays made to be nasty; odd input.

use std::cmp::Ordering;

use etalon::inside::math::affine::Affine;
use etalon::inside::math::double_double::DoubleDouble;
use etalon::inside::math::exact::Exact;
use etalon::inside::math::number::{Bounded, Number};
use etalon::inside::shape::ladder::{Question, ScaledRay};
use etalon::inside::shape::list::FirstCrossing;
use etalon::inside::shape::{Hit, Placed, Query, Ray, ShapeKind, SingularMatrix, Start, Tally};
use etalon_doors::shapes::{Through, crossings};
use glam::{DMat3, DQuat, DVec3};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::support::ray;

/// Every kind in turn.
pub fn kind_of(round: usize) -> ShapeKind {
    ShapeKind::ALL[round % ShapeKind::ALL.len()]
}

fn signed(rng: &mut impl Rng) -> f64 {
    rng.random_range(-1.0..1.0)
}

/// Uniform in [-1, 1)³.
pub fn cubed(rng: &mut impl Rng) -> DVec3 {
    DVec3::new(signed(rng), signed(rng), signed(rng))
}

fn any<const N: usize>(rng: &mut impl Rng, of: [f64; N]) -> f64 {
    of[rng.random_range(0..N)]
}

/// 10^x for x drawn from the range.
pub fn decade(rng: &mut impl Rng, from: f64, to: f64) -> f64 {
    libm::exp10(rng.random_range(from..to))
}

/// A random transform, of any scale and condition.
pub fn matrix(rng: &mut impl Rng) -> Affine {
    let linear = match rng.random_range(0..4) {
        0 => DMat3::IDENTITY,
        1 => {
            let shear = DVec3::new(1.0, decade(rng, -8.0, 0.0), 0.0);
            DMat3::from_cols(DVec3::X, shear, -DVec3::Z)
        }
        _ => {
            let mut rotation = || {
                let q = DQuat::from_xyzw(signed(rng), signed(rng), signed(rng), 1.5);
                DMat3::from_quat(q.normalize())
            };
            let (left, right) = (rotation(), rotation());
            let stretch = DVec3::new(1.0, decade(rng, -8.0, 0.0), -decade(rng, -4.0, 0.0));
            left * DMat3::from_diagonal(stretch) * right
        }
    };
    let scale = any(rng, [1.0, 1.0, 1e-6, 1e12, 0.5]);
    let shift = cubed(rng) * scale * any(rng, [0.0, 1.0, 1e4]);
    let m = (linear * scale).to_cols_array_2d();
    Affine {
        rows: [0, 1, 2].map(|i| [m[0][i], m[1][i], m[2][i], shift[i]]),
    }
}

/// A canonical point where answers change: a corner, an edge, a rim, a silhouette, a face.
pub fn critical_point(rng: &mut impl Rng) -> DVec3 {
    let p = cubed(rng);
    match rng.random_range(0..3) {
        0 => {
            let mut rounded = |x: f64| if rng.random_bool(0.6) { x.signum() } else { x };
            p.to_array().map(&mut rounded).into()
        }
        1 => p.normalize(),
        _ => {
            let round = p.truncate().normalize();
            round.extend(any(rng, [-1.0, 0.0, 1.0, p.z]))
        }
    }
}

/// A shape scaled, then shifted.
pub fn placed(kind: ShapeKind, scale: f64, shift: DVec3) -> Placed {
    let matrix = Affine::translate(shift).after(&Affine::scale(DVec3::splat(scale)));
    Placed::new(kind, &matrix).unwrap()
}

pub fn first_hit(placed: &Placed, ray: &Ray, t_min: f64, start: Start) -> Option<Hit> {
    placed.first_hit(ray, t_min, start, &mut Tally::default())
}

fn nasty_ray(rng: &mut impl Rng, to_world: &Affine) -> (Ray, f64) {
    let p = critical_point(rng);
    let epsilon = match rng.random_range(0..4) {
        0 => 0.0,
        _ => decade(rng, -17.0, -1.0),
    };
    let aim = p + cubed(rng) * epsilon;
    let mut local = match rng.random_range(0..4) {
        // Tangent to whatever is round here.
        0 => p.cross(cubed(rng)),
        1 => DVec3::AXES[rng.random_range(0..3)],
        2 => DVec3::new(p.y, -p.x, 0.0),
        _ => cubed(rng),
    };
    if rng.random_bool(0.1) {
        local[rng.random_range(0..3)] = any(rng, [5e-324, -5e-324, -0.0, 1e-310, 1e-200]);
    }
    let away = match rng.random_range(0..4) {
        0 => 0.0,
        1 => 3.0,
        2 => signed(rng),
        _ => decade(rng, 0.0, 8.0),
    };
    let origin = to_world.point(aim - local * away);
    let mut direction = to_world.vector(local);
    if direction == DVec3::ZERO {
        direction = DVec3::X;
    }
    let direction = direction * any(rng, [1.0, 1.0, 1.0, 1e200, 1e-290]);
    let t_min = any(rng, [0.0, 0.0, 5.960_464_477_539_063e-8, 1.0]);
    (Ray { origin, direction }, t_min)
}

#[derive(Debug, Default)]
struct Decided {
    double: usize,
    double_double: usize,
    asked: usize,
    hits: usize,
}

impl Decided {
    fn ask<Q>(&mut self, placed: &Placed, ray: &ScaledRay, question: &Q, what: &str)
    where
        Q: Question<Answer: PartialEq + std::fmt::Debug>,
    {
        let ladder = &placed.ladder;
        let truth = question.ask(&ladder.exact.local(ray));
        assert!(truth.is_some(), "exact numbers must decide: {what}");
        let double = question.ask(&ladder.double.local(ray));
        let double_double = question.ask(&ladder.double_double.local(ray));
        for (tier, answer) in [("f64", &double), ("double-double", &double_double)] {
            assert!(answer.is_none() || *answer == truth, "{tier}: {what}");
        }
        self.asked += 1;
        self.double += usize::from(double.is_some());
        self.double_double += usize::from(double_double.is_some());
    }
}

#[test]
fn lower_tiers_never_contradict_the_exact_one() {
    let mut rng = Pcg64Mcg::seed_from_u64(0x001a_dde5);
    let mut decided = Decided::default();
    for round in 0..12_000 {
        let kind = kind_of(round);
        let to_world = matrix(&mut rng);
        let placed = Placed::new(kind, &to_world).unwrap();
        let (ray, t_min) = nasty_ray(&mut rng, &to_world);
        if !ray.is_valid() {
            continue;
        }
        let what = format!("{kind:?} {to_world:?} {ray:?} {t_min}");
        let t_max = f64::INFINITY;
        let (scaled, limits) = Query { ray, t_min, t_max }.scaled().unwrap();
        decided.ask(&placed, &scaled, &Through(kind), &what);
        for start in [Start::Free, Start::OnSurfaceInward] {
            let first = FirstCrossing {
                kind,
                ray: &scaled,
                limits: &limits,
                start,
            };
            decided.ask(&placed, &scaled, &first, &what);
        }
        if let Some(hit) = first_hit(&placed, &ray, t_min, Start::Free) {
            decided.hits += 1;
            let proper = hit.local.is_finite() && hit.t >= t_min && hit.point.is_finite();
            let unit = (hit.normal.length() - 1.0).abs() < 4.0 * f64::EPSILON;
            assert!(proper && unit, "{hit:?} {what}");
        }
    }
    println!("{decided:?}");
    // The test has teeth only if every tier is reached and left often, and both answers occur.
    let [asked, double, double_double] = [decided.asked, decided.double, decided.double_double];
    assert!(double > asked / 10 && double_double > double + asked / 10);
    assert!(double_double < asked - asked / 20 && decided.hits > 2_000);
}

/// Evaluates random expressions in N and exactly; the difference must never have a sign.
fn check_enclosures<N: Number>(seed: u64) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let consistent = |difference: N, what: &str| {
        let sign = difference.sign().unwrap_or(Ordering::Equal);
        assert_eq!(sign, Ordering::Equal, "{what}");
    };
    for _ in 0..2_000 {
        let mut start = || {
            let size = if rng.random_bool(0.5) { 1.0 } else { 120.0 };
            signed(&mut rng) * decade(&mut rng, -size, size)
        };
        let pool: Vec<f64> = (0..4).map(|_| start()).collect();
        let mut value = N::of(pool[0]);
        let mut truth = Exact::of(pool[0]);
        for _ in 0..8 {
            let x = pool[rng.random_range(0..4)];
            let (n, e) = (N::of(x), Exact::of(x));
            (value, truth) = match rng.random_range(0..4) {
                0 => (value.plus(&n), truth.plus(&e)),
                1 => (value.minus(&n), truth.minus(&e)),
                2 => (n.times(&value), e.times(&truth)),
                _ => (value.minus(&value.times(&n)), truth.minus(&truth.times(&e))),
            };
            consistent(value.minus(&N::enclosing(&truth)), "sum and product");
            let quotient = value.divided_by(&n);
            consistent(quotient.times(&n).minus(&N::enclosing(&truth)), "quotient");
            let root = value.squared().plus(&n.squared()).square_root();
            let square = truth.squared().plus(&e.squared());
            consistent(root.squared().minus(&N::enclosing(&square)), "root");
        }
    }
}

#[test]
fn error_bounds_hold_over_the_whole_range_of_exponents() {
    check_enclosures::<Bounded>(1);
    check_enclosures::<DoubleDouble>(2);
}

#[test]
fn exact_numbers_round_to_nearest() {
    let of = Exact::of;
    let tie = of(1.0).plus(&of(f64::EPSILON / 2.0));
    for (exact, nearest) in [
        (of(1.0).divided_by(&of(3.0)), 1.0 / 3.0),
        (of(2.0).square_root(), std::f64::consts::SQRT_2),
        // A tie goes to even, a tie with something behind it goes up.
        (tie.clone(), 1.0),
        (tie.plus(&of(5e-324)), 1.0 + f64::EPSILON),
        (of(-5e-324), -5e-324),
        (of(f64::MAX), f64::MAX),
        (of(f64::MAX).squared(), f64::INFINITY),
    ] {
        assert_eq!(exact.to_f64(), nearest);
    }
}

#[test]
fn a_start_on_the_surface_counts_the_far_crossing_only() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    for round in 0..600 {
        let kind = ShapeKind::ALL[round % 3];
        let to_world = matrix(&mut rng);
        let body = Placed::new(kind, &to_world).unwrap();
        let aim = to_world.point(0.5 * cubed(&mut rng));
        let origin = to_world.point(5.0 * cubed(&mut rng).normalize());
        let toward = ray(origin, aim - origin);
        let Some(entry) = first_hit(&body, &toward, 0.0, Start::Free) else {
            continue;
        };
        // From the rounded point of entry on: the exit it would have had, up to that rounding.
        let inward = ray(entry.point, toward.direction);
        let exit = first_hit(&body, &inward, 0.0, Start::OnSurfaceInward);
        let [near, far] = crossings(&body, &toward).unwrap();
        assert_eq!(near.t, entry.t);
        assert!(exit.is_none_or(|exit| !exit.front && far.t >= near.t));
        assert!(first_hit(&body, &inward, 0.0, Start::Excluded).is_none());
    }
    let disk = placed(ShapeKind::Disk, 1.0, DVec3::ZERO);
    let hit = |start| first_hit(&disk, &ray(DVec3::Z, -DVec3::Z), 0.0, start);
    assert!(hit(Start::OnSurfaceInward).is_none());
    assert!(hit(Start::Free).is_some_and(|hit| hit.front));
}

#[test]
fn odd_input_is_refused_quietly() {
    // One unit in the last place off a singular matrix is not singular.
    let barely = 4.0 + 4.0 * f64::EPSILON;
    let singular = Some(SingularMatrix);
    for (entry, refused) in [(4.0, singular), (barely, None), (f64::NAN, singular)] {
        let [a, c] = [[1.0, 2.0, 3.0, 0.0], [0.1, 0.2, 0.7, 0.0]];
        let rows = [a, [2.0, entry, 6.0, 0.0], c];
        let placed = Placed::new(ShapeKind::Cube, &Affine { rows });
        assert_eq!(placed.err(), refused);
    }
    let [least, most] = [f64::MIN_POSITIVE, f64::MAX];
    let [nan, infinite] = [f64::NAN, f64::INFINITY];
    let extreme = [0.0, 5e-324, least, 1e-160, 1.0, 1e160, most, nan, infinite];
    let pairs = extreme
        .iter()
        .flat_map(|a| extreme.iter().map(move |b| (*a, *b)));
    for &kind in ShapeKind::ALL {
        for scale in [1e-300, 1e-6, 1.0, 1e300] {
            let body = placed(kind, scale, DVec3::ONE);
            for (a, b) in pairs.clone() {
                let ray = ray(DVec3::new(a, -b, 0.5), DVec3::new(-a, b, 1e-3 * b));
                for t_min in [0.0, a, -b] {
                    if let Some(hit) = first_hit(&body, &ray, t_min, Start::Free) {
                        let finite = hit.point.is_finite() && hit.normal.is_finite();
                        let after = hit.t.is_finite() && hit.t >= t_min;
                        assert!(finite && after, "{hit:?}");
                    }
                }
            }
        }
    }
}
