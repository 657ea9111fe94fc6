//! Soundness of the first rung: what lanes call certain must be what the certified ladder says of
//! the very same rounded ray, and both crossings must lie within the stated error.

#![allow(
    clippy::unwrap_used,
    reason = "a malformed oracle file must fail the test"
)]

use std::collections::HashMap;

use etalon::Instructions;
use etalon::inside::math::affine::Affine;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::shape::{Placed, Ray, ShapeKind};
use etalon_doors::shapes::{RaySpan, crossings, spans};
use glam::DVec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::lanes_support::{PRECISIONS, Precision, on_each, same_bits};
use crate::shape_ladder::{KINDS, critical_point, cubed, decade, matrix};

/// One ray against one shape, in f64.
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
            let (kind, to_world) = (case.placed.kind(), case.placed.to_world());
            format!("{kind:?} {to_world:?}\n  {answer:?}\n  {truth:?}")
        };
        if answer.hit && answer.miss {
            self.wrong.push(what());
        } else if answer.miss {
            // The shape may also lie behind as a whole.
            if truth.is_some_and(|[_, far]| far.t >= 0.0) {
                self.wrong.push(what());
            }
        } else if answer.hit {
            self.hits += 1;
            let Some([near, far]) = &truth else {
                self.wrong.push(what());
                return;
            };
            let share = share(answer.near, near.t).max(share(answer.far, far.t));
            if share > 1.0 || share.is_nan() {
                self.wrong.push(format!("{share} of the bound: {}", what()));
            } else {
                self.tightest = self.tightest.max(share);
            }
        } else {
            self.undecided += 1;
        }
    }

    fn check_all(cases: &[Case], precision: Precision) -> Self {
        let mut record = Self::default();
        for (case, answer) in cases
            .iter()
            .zip(ask(Instructions::best(), precision, cases))
        {
            record.check(case, &answer);
        }
        record
    }

    fn assert_sound(&self, what: &str) {
        println!(
            "{what}: {} rays, {} hits, {:.2} % undecided, closest to a bound {:.3}",
            self.asked,
            self.hits,
            100.0 * self.undecided as f64 / self.asked as f64,
            self.tightest,
        );
        assert!(
            self.wrong.is_empty(),
            "{what}: {} wrong, such as\n{}",
            self.wrong.len(),
            self.wrong[..self.wrong.len().min(3)].join("\n")
        );
    }
}

/// The oracle's rays, with unit directions as the loop has them.
fn oracle_cases() -> Vec<Case> {
    let read = |text: &'static str| {
        csv::ReaderBuilder::new()
            .flexible(true)
            .from_reader(text.as_bytes())
            .deserialize()
            .map(Result::unwrap)
            .collect::<Vec<HashMap<String, String>>>()
    };
    let number = |row: &HashMap<String, String>, name: &str| -> f64 { row[name].parse().unwrap() };
    let transforms: HashMap<String, Affine> = read(include_str!("data/transforms.csv"))
        .iter()
        .map(|row| {
            let rows = [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| number(row, &format!("m{i}{j}"))));
            (row["transform"].clone(), Affine { rows })
        })
        .collect();
    read(include_str!("data/primitives.csv"))
        .iter()
        .map(|row| {
            let kind = match row["shape"].as_str() {
                "sphere" => ShapeKind::Sphere,
                "cube" => ShapeKind::Cube,
                "cylinder" => ShapeKind::Cylinder,
                "rect" => ShapeKind::Rectangle,
                "disk" => ShapeKind::Disk,
                other => panic!("unknown shape {other}"),
            };
            let vector = |names: [&str; 3]| DVec3::from_array(names.map(|n| number(row, n)));
            Case {
                placed: Placed::new(kind, &transforms[&row["transform"]]).unwrap(),
                ray: Ray {
                    origin: vector(["ox", "oy", "oz"]),
                    direction: vector(["dx", "dy", "dz"]).normalize(),
                },
            }
        })
        .collect()
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
    let direction = to_world.vector(local);
    let direction = if direction.length() > 0.0 {
        direction.normalize()
    } else {
        DVec3::X
    };
    Ray {
        origin: to_world.point(aim - local * away),
        direction,
    }
}

fn nasty_cases(precision: Precision, seed: u64, rounds: usize) -> Vec<Case> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut cases = Vec::new();
    for round in 0..rounds {
        let kind = KINDS[round % KINDS.len()];
        let to_world = if rng.random_bool(0.5) {
            matrix(&mut rng)
        } else {
            gentle(&mut rng)
        };
        let placed = Placed::new(kind, &to_world).unwrap();
        for _ in 0..4 {
            let mut ray = nasty(&mut rng, &to_world, precision);
            if rng.random_bool(0.1) {
                // From the very centre, and from far off the shape.
                ray.origin = to_world.point(cubed(&mut rng) * decade(&mut rng, -20.0, 3.0));
            }
            cases.push(Case {
                placed: placed.clone(),
                ray,
            });
        }
    }
    cases
}

/// A transform such as scenes have.
fn gentle(rng: &mut impl Rng) -> Affine {
    let mut rows = [[0.0; 4]; 3];
    for (i, row) in rows.iter_mut().enumerate() {
        for entry in row.iter_mut() {
            *entry = rng.random_range(-1.0..1.0);
        }
        row[i] += 2.0;
        row[3] *= 10.0;
    }
    Affine { rows }
}

#[test]
fn lanes_never_contradict_the_ladder_on_nasty_rays() {
    for precision in PRECISIONS {
        let cases = nasty_cases(precision, 0x0050_facd, 12_000);
        for &kind in KINDS {
            let mine: Vec<Case> = cases
                .iter()
                .filter(|case| case.placed.kind() == kind)
                .map(|case| Case {
                    placed: case.placed.clone(),
                    ray: case.ray,
                })
                .collect();
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
        let cases: Vec<Case> = (0..6_000)
            .map(|round| {
                let to_world = gentle(&mut rng);
                let aim = to_world.point(1.5 * cubed(&mut rng));
                let origin = to_world.point(6.0 * cubed(&mut rng));
                Case {
                    placed: Placed::new(KINDS[round % KINDS.len()], &to_world).unwrap(),
                    ray: Ray {
                        origin,
                        direction: (aim - origin).normalize(),
                    },
                }
            })
            .collect();
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
                assert!(
                    (a.hit, a.miss) == (b.hit, b.miss)
                        && same_bits(a.near[0], b.near[0])
                        && same_bits(a.near[1], b.near[1])
                        && same_bits(a.far[0], b.far[0])
                        && same_bits(a.far[1], b.far[1]),
                    "{name}: {a:?} {b:?}"
                );
            }
        }
    }
}

#[test]
fn a_wrong_span_is_noticed() {
    let cases = nasty_cases(Precision::Double, 9, 300);
    let mut record = Record::default();
    for (case, mut answer) in cases
        .iter()
        .zip(ask(Instructions::best(), Precision::Double, &cases))
    {
        // A bound a million times too small, as of a forgotten term.
        for [low, high] in [&mut answer.near, &mut answer.far] {
            let (middle, half) = ((*low + *high) / 2.0, (*high - *low) / 2.0);
            (*low, *high) = (middle - 1e-6 * half, middle + 1e-6 * half);
        }
        record.check(case, &answer);
    }
    assert!(record.wrong.len() > 10, "{}", record.wrong.len());
    let mut record = Record::default();
    for (case, mut answer) in cases
        .iter()
        .zip(ask(Instructions::best(), Precision::Double, &cases))
    {
        (answer.hit, answer.miss) = (answer.miss, answer.hit);
        record.check(case, &answer);
    }
    assert!(record.wrong.len() > 300);
}
