//! The contract of materials: laws, densities, reciprocity and energy, as functions over it, run over
//! the list of materials and over a surface that is Lambertian, a modified Phong lobe and a mirror at
//! once. Parameters come from what the materials declare, so that a new one is tested unasked.

#![allow(
    clippy::unwrap_used,
    reason = "the tests' own scenes are right, and what they hold is known"
)]

use std::f64::consts::TAU;
use std::ops::Bound;
use std::path::Path;

use etalon::Overrides;
use etalon::inside::declare::{Declaration, Quantity, Range};
use etalon::inside::material::{MaterialKind, Transport};
use etalon::inside::math::instructions::Precision;
use etalon::inside::scene;
use etalon::inside::stats::family::sidak;
use etalon_doors::material::{
    C, Evaluation, Sample, Setting, Subject, evaluate_each, lambertian_and_general, sample_each,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::statistics_support::{chi_square, normal_p, t_test};

/// Probability of a false alarm of one suite over all its cases.
const LEVEL: f64 = 1e-4;
/// Random numbers of a case.
const DRAWN: usize = 1 << 16;
/// Angles of incidence, degrees.
const ANGLES: [f64; 5] = [0.0, 30.0, 60.0, 85.0, 89.9];

/// What is tested: the contract, or a copy of it with a mistake.
#[derive(Clone, Copy)]
struct Contract {
    sample: fn(Subject, &Setting, &[[f64; 3]]) -> Vec<Sample>,
    evaluate: fn(Subject, &Setting, &[DVec3]) -> Vec<Evaluation>,
}

const RIGHT: Contract = Contract {
    sample: sample_each,
    evaluate: evaluate_each,
};

struct Case {
    subject: Subject,
    setting: Setting,
}

impl Case {
    fn name(&self) -> String {
        format!("{:?} {:?}", self.subject, self.setting)
    }

    fn with(&self, setting: Setting) -> Self {
        Self {
            subject: self.subject,
            setting,
        }
    }
}

/// Numbers in a range, from one end to the other.
fn numbers(range: &Range) -> [f64; 3] {
    let end = |bound: Bound<f64>| match bound {
        Bound::Included(x) | Bound::Excluded(x) => Some(x),
        Bound::Unbounded => None,
    };
    match (end(range.low), end(range.high)) {
        (Some(low), Some(high)) => [0.1, 0.5, 0.9].map(|t| low + t * (high - low)),
        (Some(low), None) => [0.1, 1.0, 10.0].map(|x| low + x),
        (None, Some(high)) => [0.1, 1.0, 10.0].map(|x| high - x),
        (None, None) => [-1.0, 0.0, 1.0],
    }
}

/// Spectra and numbers as a declaration allows them; three sets.
fn parameters(kind: MaterialKind) -> Vec<([[f64; C]; 2], [f64; 3])> {
    let declaration = kind.declaration();
    let quantities = || {
        let beside = declaration.beside.iter().map(|own| own.quantity);
        [declaration.main.quantity].into_iter().chain(beside)
    };
    let mut spectra: Vec<[f64; C]> = Vec::new();
    for quantity in quantities() {
        spectra.extend(match quantity {
            Quantity::True
            | Quantity::Number { .. }
            | Quantity::Point
            | Quantity::Direction
            | Quantity::Table(_) => vec![],
            Quantity::Spectrum(_) => vec![[0.0, 0.4, 0.8, 1.0]],
            Quantity::TwoSpectra(_) => vec![[0.0, 0.2, 0.1, 0.4], [0.3, 0.0, 0.2, 0.5]],
            Quantity::Metal => vec![[1.4, 0.8, 0.2, 0.1], [1.8, 2.0, 3.0, 4.0]],
            Quantity::Glass => vec![[1.53, 1.52, 1.51, 1.5], [0.0; C]],
        });
    }
    spectra.resize(2, [0.0; C]);
    let set = |i: usize| {
        let own = quantities().filter_map(|quantity| match quantity {
            Quantity::Number { range, .. } => Some(numbers(&range)[i]),
            _ => None,
        });
        let own: Vec<f64> = own.collect();
        ([spectra[0], spectra[1]], kind.numbers(&own, DVec3::ONE))
    };
    (0..3).map(set).collect()
}

fn subjects() -> Vec<(Subject, [[f64; C]; 2], [f64; 3])> {
    let listed = MaterialKind::ALL.iter().flat_map(|kind| {
        let mut sets = parameters(*kind);
        sets.dedup();
        let own = move |(spectra, numbers)| (Subject::Listed(*kind), spectra, numbers);
        sets.into_iter().map(own)
    });
    // Exponents 1, 7 and 31; with all three parts, and with each of them alone.
    let spectra = [[0.0, 0.2, 0.1, 0.4], [0.3, 0.0, 0.2, 0.5]];
    let phong = [
        [1.0, 0.1, 0.5],
        [3.0, 0.1, 0.3],
        [5.0, 0.05, 0.8],
        [3.0, 0.0, 1.0],
        [3.0, 0.0, 0.0],
        [3.0, 1.0, 0.5],
    ];
    // A mirror that sends everything on leaves nothing for the rest, and what is never chosen must not
    // be there: the weights of its light would have no variance.
    let black = [0.0; C];
    let [diffuse, lobe] = spectra;
    let of = |numbers: [f64; 3]| match numbers {
        [_, 1.0, _] => (Subject::Phong, [black; 2], numbers),
        [_, _, 1.0] => (Subject::Phong, [black, lobe], numbers),
        [_, _, 0.0] => (Subject::Phong, [diffuse, black], numbers),
        _ => (Subject::Phong, spectra, numbers),
    };
    listed.chain(phong.map(of)).collect()
}

/// Every subject at every angle, from both sides, by both kinds of transport, in both precisions.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let normal = DVec3::new(0.36, -0.48, 0.8);
    let tangent = DVec3::new(0.8, 0.6, 0.0);
    for (subject, spectra, numbers) in subjects() {
        let refracts = matches!(subject, Subject::Listed(kind) if kind.refracts());
        // Vacuum, water, and something denser than the inside.
        for n in [1.0, 1.33, 1.7] {
            for angle in ANGLES.map(f64::to_radians) {
                for (front, transport) in [
                    (true, Transport::Radiance),
                    (false, Transport::Radiance),
                    (true, Transport::Importance),
                    (false, Transport::Importance),
                ] {
                    for precision in Precision::ALL {
                        let setting = Setting {
                            precision,
                            transport,
                            normal,
                            front,
                            wo: angle.cos() * normal + angle.sin() * tangent,
                            spectra,
                            numbers,
                            outside: [n; C],
                            disperses: refracts,
                            ended: false,
                            hero: 2,
                        };
                        let ended = Setting {
                            ended: true,
                            ..setting.clone()
                        };
                        let both = [setting, ended].into_iter();
                        let few = both.take(1 + usize::from(refracts));
                        cases.extend(few.map(|setting| Case { subject, setting }));
                    }
                }
            }
        }
    }
    cases
}

/// Random numbers, the same for every case.
fn drawn() -> Vec<[f64; 3]> {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    // Representable in either precision.
    let mut one = || f64::from(rng.random::<u32>() >> 8) / f64::from(1 << 24);
    (0..DRAWN).map(|_| [one(), one(), one()]).collect()
}

/// The indices on the near and on the far side of wo, at each wavelength.
fn indices(setting: &Setting) -> [[f64; C]; 2] {
    let (inside, outside) = (setting.spectra[0], setting.outside);
    if setting.front {
        [outside, inside]
    } else {
        [inside, outside]
    }
}

/// The distinct delta events of a case.
fn delta_events(contract: Contract, case: &Case) -> Vec<Sample> {
    let choices: Vec<[f64; 3]> = (0..1 << 12)
        .map(|i| [f64::from(i) / f64::from(1 << 12), 0.25, 0.5])
        .collect();
    let mut events: Vec<Sample> = Vec::new();
    for event in (contract.sample)(case.subject, &case.setting, &choices) {
        let new = |other: &Sample| other.transmitted != event.transmitted;
        if event.delta && event.pdf > 0.0 && events.iter().all(new) {
            events.push(event);
        }
    }
    events
}

/// Reflection and refraction go where their laws send them.
fn laws(contract: Contract, case: &Case) -> Result<(), String> {
    let Setting {
        precision,
        normal,
        wo,
        hero,
        disperses,
        ended,
        ..
    } = case.setting;
    // A direction is the sum of two rounded ones, enlarged at most by the smaller index.
    let allowed = 32.0 * precision.roundoff();
    for event in delta_events(contract, case) {
        let wi = event.direction;
        let [near, far] = indices(&case.setting).map(|n| n[hero]);
        let cosine = wo.dot(normal);
        let want = if event.transmitted {
            // Snell's law for the tangential parts; what is left is the cosine.
            let tangential = -(wo - cosine * normal) * (near / far);
            tangential - (1.0 - tangential.length_squared()).max(0.0).sqrt() * normal
        } else {
            2.0 * cosine * normal - wo
        };
        // Near the critical angle the cosine is the root of a small difference.
        let steep = if event.transmitted {
            1.0 / want.dot(normal).abs().max(precision.roundoff().sqrt())
        } else {
            1.0
        };
        let off = (wi - want).length();
        if off > allowed * steep {
            return Err(format!("{want} is missed by {off:e}"));
        }
        if (wi.length() - 1.0).abs() > allowed {
            return Err(format!("{wi} is not of unit length"));
        }
        if event.ends != (event.transmitted && disperses && !ended) {
            return Err("wavelengths end where they should not, or live".to_owned());
        }
    }
    Ok(())
}

/// What delta events leave of the light: nothing is won, and what refracts loses nothing.
fn energy(contract: Contract, case: &Case) -> Result<(), String> {
    let allowed = 64.0 * case.setting.precision.roundoff();
    let lossless =
        matches!(case.subject, Subject::Listed(kind) if kind.refracts() && !kind.is_spread());
    let mut total = [0.0; C];
    for hero in 0..C {
        let setting = Setting {
            hero,
            ..case.setting.clone()
        };
        let [near, far] = indices(&setting).map(|n| n[hero]);
        for event in delta_events(contract, &case.with(setting.clone())) {
            for (c, total) in total.iter_mut().enumerate() {
                // With the others ended, the hero alone is right.
                if setting.ended && c != hero {
                    continue;
                }
                let mut share = event.pdf * event.weight[c];
                if event.transmitted && setting.transport == Transport::Radiance {
                    share *= (far / near) * (far / near);
                }
                let heroes = if setting.ended { 1.0 } else { C as f64 };
                *total += share / heroes;
            }
        }
    }
    for total in total {
        if total > 1.0 + allowed || lossless && total < 1.0 - allowed {
            return Err(format!("{total} of the light goes on"));
        }
    }
    Ok(())
}

/// As often as their probabilities say.
fn frequencies(contract: Contract, case: &Case, u: &[[f64; 3]]) -> Vec<f64> {
    let drawn = (contract.sample)(case.subject, &case.setting, u);
    let events = delta_events(contract, case);
    let p_value = |event: &Sample| {
        let same = |other: &&Sample| other.delta && other.transmitted == event.transmitted;
        let count = drawn.iter().filter(same).count() as f64;
        let (n, p) = (drawn.len() as f64, event.pdf);
        let spread = (n * p * (1.0 - p)).sqrt();
        // A probability of 1 is rounded.
        (n * (1.0 - p) > 1.0).then(|| normal_p((count - n * p) / spread))
    };
    events.iter().filter_map(p_value).collect()
}

/// The way back has the density that the event says, and as much goes there.
fn way_back(contract: Contract, case: &Case, u: &[[f64; 3]]) -> Result<(), String> {
    let Setting {
        precision,
        normal,
        front,
        wo,
        ..
    } = case.setting;
    let events = (contract.sample)(case.subject, &case.setting, &u[..64]);
    for event in events.iter().filter(|event| event.pdf > 0.0) {
        let side = if event.transmitted { -1.0 } else { 1.0 };
        if side * event.direction.dot(normal) <= 0.0 {
            continue;
        }
        let back = case.with(Setting {
            normal: side * normal,
            front: front != event.transmitted,
            wo: event.direction,
            // The way back is one of those wavelengths that go on.
            ended: case.setting.ended || event.ends,
            ..case.setting.clone()
        });
        // What refracts comes back along the surface with the cosine c = √(1 − η² sin²), where sin² is
        // off by a few roundings u: c is off by u/c, which is u/c² of itself, and so is what enters.
        let grazing = wo.dot(normal).abs();
        let magnified = if event.transmitted {
            4.0 / (grazing * grazing)
        } else {
            0.0
        };
        let close = |a: f64, b: f64, what: &str| {
            // Densities of sharp lobes and reflectances at grazing angles magnify what directions
            // are off by; at the largest angle by a few hundred.
            let allowed = (4096.0 + magnified) * precision.roundoff() * a.abs().max(b.abs());
            if (a - b).abs() <= allowed {
                Ok(())
            } else {
                Err(format!("{what}: {a} and {b} for {event:?}"))
            }
        };
        if event.delta {
            let events = delta_events(contract, &back);
            let same = |other: &&Sample| other.transmitted == event.transmitted;
            let Some(other) = events.iter().find(same) else {
                return Err(format!("no way back for {event:?}"));
            };
            close(event.reverse, other.pdf, "probabilities")?;
            continue;
        }
        let there = (contract.evaluate)(case.subject, &case.setting, &[event.direction])[0];
        let back = (contract.evaluate)(case.subject, &back.setting, &[wo])[0];
        close(event.pdf, there.pdf, "sample and evaluate")?;
        close(event.reverse, there.reverse, "sample and evaluate, back")?;
        close(there.reverse, back.pdf, "densities there and back")?;
        for c in 0..C {
            close(there.value[c], back.value[c], "reciprocity")?;
            let weight = there.value[c] * event.direction.dot(normal).abs() / there.pdf;
            close(event.weight[c], weight, "weights")?;
        }
    }
    Ok(())
}

/// A grid over the sphere about the normal: cells of equal area.
const ROWS: usize = 512;
const COLUMNS: usize = 256;
/// Cells of a bin, each way.
const BIN: [usize; 2] = [32, 16];

fn frame(normal: DVec3) -> [DVec3; 2] {
    let s = normal.any_orthonormal_vector();
    [s, normal.cross(s)]
}

fn sphere(normal: DVec3) -> Vec<DVec3> {
    let [s, t] = frame(normal);
    let cell = |i: usize| {
        let z = 1.0 - (2.0 * (i / COLUMNS) as f64 + 1.0) / ROWS as f64;
        let angle = TAU * ((i % COLUMNS) as f64 + 0.5) / COLUMNS as f64;
        let r = (1.0 - z * z).sqrt();
        z * normal + r * (angle.cos() * s + angle.sin() * t)
    };
    (0..ROWS * COLUMNS).map(cell).collect()
}

/// The bin of a cell.
fn bin(row: usize, column: usize) -> usize {
    row / BIN[0] * (COLUMNS / BIN[1]) + column / BIN[1]
}

/// Directions are as frequent as their density says: the p-value of χ², and the integral of the
/// density.
fn densities(contract: Contract, case: &Case, u: &[[f64; 3]]) -> (Option<f64>, f64) {
    let normal = case.setting.normal;
    let grid = sphere(normal);
    let area = 2.0 * TAU / grid.len() as f64;
    let mut expected = vec![0.0; bin(ROWS - 1, COLUMNS - 1) + 1];
    let evaluated = (contract.evaluate)(case.subject, &case.setting, &grid);
    for (i, own) in evaluated.iter().enumerate() {
        expected[bin(i / COLUMNS, i % COLUMNS)] += own.pdf * area;
    }
    let integral: f64 = expected.iter().sum();
    let mut counts = vec![0; expected.len()];
    let [s, t] = frame(normal);
    let events = (contract.sample)(case.subject, &case.setting, u);
    for event in events.iter().filter(|event| !event.delta) {
        let wi = event.direction;
        let row = ((1.0 - wi.dot(normal)) / 2.0 * ROWS as f64) as usize;
        let turn = (wi.dot(t).atan2(wi.dot(s)) / TAU).rem_euclid(1.0);
        let column = (turn * COLUMNS as f64) as usize;
        counts[bin(row.min(ROWS - 1), column.min(COLUMNS - 1))] += 1;
    }
    let drawn: u64 = counts.iter().sum();
    for expected in &mut expected {
        *expected *= drawn as f64 / integral;
    }
    (
        (drawn > 1000).then(|| chi_square(&counts, &expected)),
        integral,
    )
}

/// The share of the light that goes on, by integration of `evaluate` and the delta events, and the
/// p-values of the mean weights of `sample` against it.
fn furnace(contract: Contract, case: &Case, u: &[[f64; 3]]) -> ([f64; C], Vec<f64>) {
    let normal = case.setting.normal;
    let grid = sphere(normal);
    let area = 2.0 * TAU / grid.len() as f64;
    let mut share = [0.0; C];
    let evaluated = (contract.evaluate)(case.subject, &case.setting, &grid);
    for (wi, own) in grid.iter().zip(&evaluated) {
        for (share, value) in share.iter_mut().zip(own.value) {
            *share += value * wi.dot(normal).abs() * area;
        }
    }
    for event in delta_events(contract, case) {
        for (share, weight) in share.iter_mut().zip(event.weight) {
            *share += event.pdf * weight;
        }
    }
    let events = (contract.sample)(case.subject, &case.setting, u);
    let p_values = (0..C).filter_map(|c| {
        let weights: Vec<f64> = events.iter().map(|event| event.weight[c]).collect();
        let constant = weights.iter().all(|w| (w - weights[0]).abs() < 1e-5);
        (!constant).then(|| t_test(&weights, share[c]))
    });
    (share, p_values.collect())
}

/// Integrals over the grid are off by about 1 in 2¹⁰: cells are 2⁻⁸ wide, lobes 0.2 and more.
const GRID: f64 = 1.0 / 1024.0;

fn spread(case: &Case) -> bool {
    match case.subject {
        Subject::Listed(kind) => kind.is_spread(),
        Subject::Phong => case.setting.numbers[1] < 1.0,
    }
}

fn all(what: &str, cases: &[Case], test: impl Fn(&Case) -> Result<(), String>) {
    let wrong: Vec<String> = cases
        .iter()
        .filter_map(|case| Some(format!("{}: {}", case.name(), test(case).err()?)))
        .collect();
    let shown = wrong.iter().take(8).cloned().collect::<Vec<_>>().join("\n");
    assert!(wrong.is_empty(), "{what}, {} wrong:\n{shown}", wrong.len());
}

fn no_alarm(p_values: &[f64]) -> bool {
    let least = p_values.iter().copied().fold(1.0, f64::min);
    least >= sidak(LEVEL, p_values.len().max(1))
}

/// Those whose statistics are worth their time: each subject and angle once.
fn few() -> Vec<Case> {
    let few = |case: &Case| {
        let Setting {
            transport,
            front,
            outside,
            ended,
            ..
        } = case.setting;
        transport == Transport::Radiance && front && outside[0] == 1.0 && !ended
    };
    cases().into_iter().filter(few).collect()
}

#[test]
fn delta_events_obey_the_laws_of_reflection_and_refraction() {
    all("laws", &cases(), |case| laws(RIGHT, case));
}

#[test]
fn delta_events_win_no_energy_and_glass_loses_none() {
    all("energy", &cases(), |case| energy(RIGHT, case));
}

#[test]
fn there_and_back_are_alike() {
    let u = drawn();
    all("way back", &cases(), |case| way_back(RIGHT, case, &u));
}

#[test]
fn events_and_directions_are_as_frequent_as_they_say() {
    let u = drawn();
    let mut p_values = Vec::new();
    for case in few() {
        p_values.extend(frequencies(RIGHT, &case, &u));
        let (p_value, integral) = densities(RIGHT, &case, &u);
        let delta: f64 = delta_events(RIGHT, &case).iter().map(|e| e.pdf).sum();
        let something = spread(&case) || delta > 0.0;
        let whole = if something { 1.0 } else { 0.0 };
        assert!(
            (integral + delta - whole).abs() < GRID,
            "{}: {integral}",
            case.name()
        );
        p_values.extend(p_value);
    }
    assert!(no_alarm(&p_values), "{p_values:?}");
}

#[test]
fn a_furnace_shows_what_evaluate_says_and_nothing_shines() {
    let u = drawn();
    let mut p_values = Vec::new();
    for case in few() {
        let (share, own) = furnace(RIGHT, &case, &u);
        // Dispersion gives the hero what the others lose.
        let most = if case.setting.disperses {
            C as f64
        } else {
            1.0
        };
        let dark = share
            .iter()
            .all(|share| (0.0..=most + GRID).contains(share));
        assert!(dark, "{}: {share:?}", case.name());
        p_values.extend(own);
    }
    assert!(no_alarm(&p_values), "{p_values:?}");
}

fn too_dense(subject: Subject, setting: &Setting, wi: &[DVec3]) -> Vec<Evaluation> {
    // χ² grows by about 500 with it, the expected value is 256 ± 23.
    let tilt = |wi: &DVec3| 1.0 + 0.2 * wi.dot(setting.normal.any_orthonormal_vector());
    let evaluated = evaluate_each(subject, setting, wi).into_iter().zip(wi);
    let wrong = |(own, wi): (Evaluation, &DVec3)| Evaluation {
        pdf: own.pdf * tilt(wi),
        value: own.value.map(|value| value * tilt(wi)),
        ..own
    };
    evaluated.map(wrong).collect()
}

fn too_heavy(subject: Subject, setting: &Setting, u: &[[f64; 3]]) -> Vec<Sample> {
    let heavier = |event: Sample| Sample {
        weight: event.weight.map(|weight| 1.05 * weight),
        pdf: if event.delta {
            event.pdf * 0.9
        } else {
            event.pdf
        },
        direction: (event.direction + 1e-3 * setting.normal).normalize(),
        ..event
    };
    let events = sample_each(subject, setting, u).into_iter();
    events.map(heavier).collect()
}

#[test]
fn the_suites_notice_mistakes() {
    let u = drawn();
    let phong = |case: &Case| {
        case.subject == Subject::Phong
            && case.setting.numbers == [3.0, 0.1, 0.3]
            && case.setting.precision == Precision::Double
    };
    let all = few();
    let case = all.iter().filter(|case| phong(case)).nth(2).unwrap();
    let glass = Subject::Listed(MaterialKind::Glass);
    let glass = all.iter().find(|case| case.subject == glass).unwrap();
    let dense = Contract {
        evaluate: too_dense,
        ..RIGHT
    };
    let heavy = Contract {
        sample: too_heavy,
        ..RIGHT
    };
    assert!(!no_alarm(&[densities(dense, case, &u).0.unwrap()]));
    assert!(way_back(dense, case, &u).is_err());
    assert!(laws(heavy, case).is_err() && way_back(heavy, case, &u).is_err());
    assert!(energy(heavy, glass).is_err());
    assert!(!no_alarm(&frequencies(heavy, case, &u)));
    assert!(!no_alarm(&furnace(heavy, case, &u).1));
    for (right, whole) in [(case, 0.9), (glass, 0.0)] {
        assert!(laws(RIGHT, right).is_ok() && energy(RIGHT, right).is_ok());
        assert!((densities(RIGHT, right, &u).1 - whole).abs() < GRID);
    }
}

/// bsdf · cos/pdf = albedo: what the loop relies on for Lambertian surfaces. Each way rounds at most
/// ten times, and once more to be compared.
#[test]
fn lambertian_surfaces_are_lit_alike_the_short_way_and_the_general() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    for case in cases() {
        let setting = &case.setting;
        let diffuse = case.subject == Subject::Listed(MaterialKind::Diffuse);
        if !diffuse {
            continue;
        }
        for _ in 0..256 {
            let [x, y, z] = [0; 3].map(|_| rng.random_range(-1.0..1.0));
            let wi = DVec3::new(x, y, z).normalize();
            let wi = if wi.dot(setting.normal) < 0.0 {
                -wi
            } else {
                wi
            };
            let pdf = f64::exp2(rng.random_range(-12.0..12.0));
            for extended in [true, false] {
                let [special, general] = lambertian_and_general(setting, wi, pdf, extended);
                for (a, b) in special.into_iter().zip(general) {
                    let allowed = 21.0 * setting.precision.roundoff() * a;
                    assert!((a - b).abs() <= allowed, "{a} {b}");
                }
                // Without the weight against scattered rays there would be more.
                let [unweighted, _] = lambertian_and_general(setting, wi, pdf, false);
                assert!(special[3] <= unweighted[3] * (1.0 + 1e-6));
            }
        }
    }
}

/// A material as it is written with everything that it declares.
fn written(declaration: &Declaration, number: impl Fn(&Range) -> f64) -> String {
    let value = |quantity: Quantity| match quantity {
        Quantity::True => "true".to_owned(),
        Quantity::Number { range, .. } => format!("{:?}", number(&range)),
        Quantity::Spectrum(_) => "0.5".to_owned(),
        Quantity::TwoSpectra(_) => "[0.2, 0.3]".to_owned(),
        Quantity::Metal => "\"Ag\"".to_owned(),
        Quantity::Glass => "{ ior = 1.5 }".to_owned(),
        Quantity::Point | Quantity::Direction => "[1, 2, 3]".to_owned(),
        Quantity::Table(_) => unreachable!("no material has a table"),
    };
    let mut main = value(declaration.main.quantity);
    if let Some(within) = declaration.within {
        main = format!("{{ {within} = {main} }}");
    }
    let beside = declaration.beside.iter();
    let beside = beside.map(|own| format!(", {} = {}", own.key, value(own.quantity)));
    let beside: String = beside.collect();
    format!("{{ {} = {main}{beside} }}", declaration.main.key)
}

fn read(material: &str) -> Result<scene::Scene, scene::SceneError> {
    let text = format!(
        "[camera]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nfov = 40\n[image]\nsize = [1, 1]\nspp = 1\n\
         [materials]\nm = {material}\n"
    );
    scene::parse("test.toml", &text, Path::new(""), &Overrides::default())
}

#[test]
fn materials_are_read_as_they_declare_themselves() {
    let guide = include_str!("../scenes/README.md");
    for kind in MaterialKind::ALL {
        let declaration = kind.declaration();
        let text = written(&declaration, |range| numbers(range)[1]);
        let surface = &read(&text).unwrap().materials[0].value.surface;
        assert_eq!(surface.kind, *kind, "{text}");
        let count = surface.values.len();
        let spectra = surface.spectra().count();
        assert!(spectra <= count && count <= declaration.spectra() + declaration.beside.len());
        for own in declaration.beside {
            if let Quantity::Number { range, .. } = own.quantity {
                // Something is excluded, and said to be.
                let wrong = written(&declaration, |_| -1e9);
                assert!(!range.contains(-1e9));
                let error = read(&wrong).unwrap_err().to_string();
                assert!(
                    error.contains(own.key) && error.contains(&range.words()),
                    "{error}"
                );
            }
        }
        let beside = declaration.beside.iter().map(|own| own.key);
        for key in beside
            .chain(declaration.within)
            .chain([declaration.main.key])
        {
            let known = guide.contains(&format!("`{key}`")) || guide.contains(&format!("{key} ="));
            assert!(
                known || cfg!(feature = "planted"),
                "{key} is not in scenes/README.md"
            );
        }
    }
}
