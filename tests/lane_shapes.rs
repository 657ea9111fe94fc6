//! Soundness of the first tier: what lanes call certain must be what the certified ladder says of
//! the very same rounded ray, and both crossings must lie within the stated error.

use etalon::Instructions;
use etalon::inside::math::affine::Affine;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::shape::{Placed, Ray, ShapeKind};
use etalon_doors::shapes::{RaySpan, crossings, spans};
use glam::DVec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::lanes_support::{PRECISIONS, Precision, on_each, same_bits};
use crate::oracle_support::{Row, primitives, ray};
use crate::shape_ladder::{critical_point, cubed, decade, kind_of, matrix};

/// One ray against one shape, in f64.
#[derive(Clone)]
struct Case {
    placed: Placed,
    ray: Ray,
}

/// What lanes say of cases on an instruction set.
fn ask(set: Instructions, precision: Precision, cases: &[Case]) -> Vec<RaySpan> {
    let cases: Vec<_> = cases.iter().map(|case| (&case.placed, case.ray)).collect();
    spans(set, precision, &cases)
}

/// How far the truth is from the middle of an enclosure, in units of half its width; the truth
/// itself is rounded to f64, by half a unit.
fn share([low, high]: [f64; 2], truth: f64) -> f64 {
    let off = (truth - (low + (high - low) / 2.0)).abs() - f64::ROUNDOFF * truth.abs();
    off.max(0.0) / ((high - low) / 2.0)
}

#[derive(Default)]
struct Record {
    asked: usize,
    undecided: usize,
    hits: usize,
    wrong: Vec<String>,
    /// Largest error of a crossing in units of its bound.
    tightest: f64,
}

impl Record {
    fn check(&mut self, case: &Case, answer: &RaySpan) {
        if !answer.ray.is_valid() {
            return;
        }
        self.asked += 1;
        let truth = crossings(&case.placed, &answer.ray);
        let what = || {
            let (kind, to_world) = (case.placed.kind, &case.placed.to_world);
            format!("{kind:?} {to_world:?}\n  {answer:?}\n  {truth:?}")
        };
        self.hits += usize::from(answer.hit && !answer.miss);
        match (answer.hit, answer.miss, &truth) {
            (true, true, _) | (true, false, None) => self.wrong.push(what()),
            // The shape may also lie behind as a whole.
            (false, true, Some([_, far])) if far.t >= 0.0 => self.wrong.push(what()),
            (false, true, _) => {}
            (true, false, Some([near, far])) => {
                let share = share(answer.near, near.t).max(share(answer.far, far.t));
                if share > 1.0 || share.is_nan() {
                    self.wrong.push(format!("{share} of the bound: {}", what()));
                } else {
                    self.tightest = self.tightest.max(share);
                }
            }
            (false, false, _) => self.undecided += 1,
        }
    }

    /// Checks answers that may be spoilt first.
    fn spoilt(cases: &[Case], precision: Precision, spoil: impl Fn(&mut RaySpan)) -> Self {
        let mut record = Self::default();
        let answers = ask(Instructions::best(), precision, cases);
        for (case, mut answer) in cases.iter().zip(answers) {
            spoil(&mut answer);
            record.check(case, &answer);
        }
        record
    }

    fn check_all(cases: &[Case], precision: Precision) -> Self {
        Self::spoilt(cases, precision, |_| ())
    }

    fn assert_sound(&self, what: &str) {
        let (rays, hits, tightest) = (self.asked, self.hits, self.tightest);
        let share = 100.0 * self.undecided as f64 / rays as f64;
        println!(
            "{what}: {rays} rays, {hits} hits, {share:.2} % undecided, closest to a bound {tightest:.3}"
        );
        let some = self.wrong[..self.wrong.len().min(3)].join("\n");
        assert_eq!(self.wrong.len(), 0, "{what}: such as\n{some}");
    }
}

/// The oracle's rays, with unit directions as the loop has them.
fn oracle_cases() -> Vec<Case> {
    let case = |(row, placed, _): (Row, Placed, f64)| {
        let mut ray = ray(&row);
        ray.direction = ray.direction.normalize();
        Case { placed, ray }
    };
    primitives().into_iter().map(case).collect()
}

#[test]
fn lanes_never_contradict_the_ladder_on_the_oracles_rays() {
    let cases = oracle_cases();
    assert_eq!(cases.len(), 3000);
    for precision in PRECISIONS {
        let record = Record::check_all(&cases, precision);
        record.assert_sound(&format!("oracle, {precision:?}"));
        // The file is made of hard cases: near misses down to 1e-15 of the size, origins 1e8 off.
        let decided = record.asked - record.undecided;
        assert!(decided > 1_000 && record.hits > 500);
    }
}

/// A random ray aimed within a hair of an edge, rim or silhouette, from near or far.
fn nasty(rng: &mut impl Rng, to_world: &Affine, precision: Precision) -> Ray {
    let p = critical_point(rng);
    let finest = libm::log10(precision.roundoff()) - 1.0;
    let epsilon = match rng.random_range(0..5) {
        0 => 0.0,
        _ => decade(rng, finest, 0.0),
    };
    let aim = p + cubed(rng) * epsilon;
    let mut local = match rng.random_range(0..5) {
        0 => p.cross(cubed(rng)),
        1 => DVec3::AXES[rng.random_range(0..3)],
        2 => DVec3::new(p.y, -p.x, 0.0),
        3 => DVec3::Z + cubed(rng) * decade(rng, finest, 0.0),
        _ => cubed(rng),
    };
    if rng.random_bool(0.05) {
        local[rng.random_range(0..3)] = 0.0;
    }
    let away = match rng.random_range(0..4) {
        0 => 0.0,
        1 => rng.random_range(-3.0..3.0),
        _ => decade(rng, -2.0, 6.0),
    };
    Ray {
        origin: to_world.point(aim - local * away),
        direction: to_world.vector(local).normalize_or(DVec3::X),
    }
}

fn nasty_cases(precision: Precision, seed: u64, rounds: usize) -> Vec<Case> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut cases = Vec::new();
    for round in 0..rounds {
        let kind = kind_of(round);
        let to_world = match rng.random_bool(0.5) {
            true => matrix(&mut rng),
            false => gentle(&mut rng),
        };
        let placed = Placed::new(kind, &to_world).unwrap();
        for _ in 0..4 {
            let mut ray = nasty(&mut rng, &to_world, precision);
            if rng.random_bool(0.1) {
                // From the very centre, and from far off the shape.
                ray.origin = to_world.point(cubed(&mut rng) * decade(&mut rng, -20.0, 3.0));
            }
            let placed = placed.clone();
            cases.push(Case { placed, ray });
        }
    }
    cases
}

/// A transform such as scenes have.
fn gentle(rng: &mut impl Rng) -> Affine {
    let rows = [0, 1, 2].map(|i| {
        let mut row = [(); 4].map(|()| rng.random_range(-1.0..1.0));
        row[i] += 2.0;
        row[3] *= 10.0;
        row
    });
    Affine { rows }
}

#[test]
fn lanes_never_contradict_the_ladder_on_nasty_rays() {
    for precision in PRECISIONS {
        let cases = nasty_cases(precision, 0x0050_facd, 12_000);
        for &kind in ShapeKind::ALL {
            let mine = cases.iter().filter(|case| case.placed.kind == kind);
            let mine: Vec<Case> = mine.cloned().collect();
            let record = Record::check_all(&mine, precision);
            record.assert_sound(&format!("{kind:?}, {precision:?}"));
            assert!(record.hits > 100 && record.undecided < record.asked);
        }
    }
}

#[test]
fn ordinary_rays_are_nearly_always_decided() {
    let mut rng = Pcg64Mcg::seed_from_u64(77);
    for precision in PRECISIONS {
        let mut case = |round: usize| {
            let to_world = gentle(&mut rng);
            let aim = to_world.point(1.5 * cubed(&mut rng));
            let origin = to_world.point(6.0 * cubed(&mut rng));
            let direction = (aim - origin).normalize();
            let placed = Placed::new(kind_of(round), &to_world).unwrap();
            let ray = Ray { origin, direction };
            Case { placed, ray }
        };
        let cases: Vec<Case> = (0..6_000).map(&mut case).collect();
        let record = Record::check_all(&cases, precision);
        record.assert_sound(&format!("ordinary, {precision:?}"));
        let share = record.undecided as f64 / record.asked as f64;
        // A bound that says nothing would be sound, too. The width of the doubtful band is some
        // tens of units of roundoff for these transforms.
        let band = 1e3 * precision.roundoff() + 2.0 / record.asked as f64;
        assert!(share <= band, "{share}");
    }
}

#[test]
fn all_instruction_sets_give_the_same_spans() {
    for precision in PRECISIONS {
        let cases = nasty_cases(precision, 4, 1_500);
        let all = on_each(|set| ask(set, precision, &cases));
        for (name, answers) in &all[1..] {
            for (a, b) in all[0].1.iter().zip(answers) {
                let ends = |span: &RaySpan| [span.near, span.far].concat();
                let same = ends(a).iter().zip(ends(b)).all(|(a, b)| same_bits(*a, b));
                let same = same && (a.hit, a.miss) == (b.hit, b.miss);
                assert!(same, "{name}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn a_wrong_span_is_noticed() {
    let cases = nasty_cases(Precision::Double, 9, 300);
    let wrong = |spoil: fn(&mut RaySpan)| {
        let record = Record::spoilt(&cases, Precision::Double, spoil);
        record.wrong.len()
    };
    // A bound a million times too small, as of a forgotten term.
    let narrow = wrong(|answer| {
        for [low, high] in [&mut answer.near, &mut answer.far] {
            let (middle, half) = ((*low + *high) / 2.0, (*high - *low) / 2.0);
            (*low, *high) = (middle - 1e-6 * half, middle + 1e-6 * half);
        }
    });
    assert!(narrow > 10, "{narrow}");
    let swapped = wrong(|answer| std::mem::swap(&mut answer.hit, &mut answer.miss));
    assert!(swapped > 300, "{swapped}");
}
