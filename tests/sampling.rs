//! Samplers: uniform margins, the variance that each kind of point set promises, scrambling that
//! is what it claims, replicates that partition the samples; warps against their densities.
//!
//! False alarms: this module's random tests share the family level 2e-4 (Šidák over an upper bound
//! of their number), seeds are fixed and nothing is tried twice.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use etalon::Instructions;
use etalon::inside::film::pixels::Pixels;
use etalon::inside::sample::Slot;
use etalon::inside::sample::replicates::Replicates;
use etalon::inside::sample::sequence::Sequence;
use etalon::inside::scene::SamplerKind;
use etalon::inside::stats::family::sidak;
use etalon_doors::samplers::{self, Numbers, Shuffle, power_weights, sample_numbers, shuffled};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::Value;

use crate::lanes_support::{PRECISIONS, Precision, everywhere, on_each};
use crate::statistics_support::{chi_square, moments, normal_p, t_test, variance_p};
use crate::truth_file::{number, truth};

/// Level of all random tests of this module together.
const FAMILY: f64 = 2e-4;
/// More than the number of single tests in it.
const TESTS: usize = 2_000;

fn level() -> f64 {
    sidak(FAMILY, TESTS)
}

pub const KINDS: [SamplerKind; 3] = [
    SamplerKind::Independent,
    SamplerKind::Stratified,
    SamplerKind::Sobol,
];
const NUMBERS: [Numbers; 5] = [
    Numbers::Camera,
    Numbers::Pair(Slot::Light, 0),
    Numbers::Pair(Slot::Bsdf, 3),
    Numbers::Single(Slot::Choice, 1),
    Numbers::Single(Slot::Roulette, 6),
];

pub fn sequence(kind: SamplerKind, seed: u64, spp: u32) -> Sequence {
    Sequence::new(kind, seed, spp, Replicates::Fixed(1))
}

/// Numbers on the best instruction set.
fn drawn(
    precision: Precision,
    sequence: &Sequence,
    numbers: Numbers,
    samples: impl Iterator<Item = [u32; 4]>,
) -> Vec<[f64; 5]> {
    let samples: Vec<[u32; 4]> = samples.collect();
    sample_numbers(Instructions::best(), precision, sequence, numbers, &samples)
}

/// All samples 0 … n − 1 of `pixels` pixels, pixel by pixel.
pub fn pixels_of(
    precision: Precision,
    sequence: Sequence,
    what: Numbers,
    pixels: u32,
    n: u32,
) -> Vec<[f64; 5]> {
    let requests = (0..pixels).flat_map(|p| (0..n).map(move |i| [p % 64, p / 64, 0, i]));
    drawn(precision, &sequence, what, requests)
}

#[test]
fn every_number_is_uniform_at_every_index() {
    for precision in PRECISIONS {
        for (kind, spp) in [
            (SamplerKind::Independent, 256),
            (SamplerKind::Stratified, 256),
            (SamplerKind::Stratified, 700),
            (SamplerKind::Sobol, 256),
        ] {
            let sequence = sequence(kind, 5, spp);
            for what in NUMBERS {
                // One number a pixel: those of a pixel are not independent of one another.
                for index in [0, 1, 6, 200] {
                    let requests = (0..12_800).map(|p| [p % 160, p / 160, p % 3, index]);
                    let drawn = drawn(precision, &sequence, what, requests);
                    for column in 0..what.width() {
                        let mut counts = [0; 64];
                        for x in drawn.iter().map(|numbers| numbers[column]) {
                            assert!((0.0..1.0).contains(&x));
                            counts[(x * 64.0) as usize] += 1;
                        }
                        let p = chi_square(&counts, &[200.0; 64]);
                        assert!(p > level(), "{kind:?} {what:?} {index} {column}: {p:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_sample_does_not_depend_on_its_company() {
    for precision in PRECISIONS {
        for kind in KINDS {
            for what in NUMBERS {
                let sequence = sequence(kind, 7, 64);
                let requests = (0..999).map(|i| [i % 7, i / 100, i % 2, i % 64]);
                let together = drawn(precision, &sequence, what, requests.clone());
                let backwards = drawn(precision, &sequence, what, requests.clone().rev());
                let requests: Vec<[u32; 4]> = requests.collect();
                assert!(together.iter().eq(backwards.iter().rev()));
                let ask = |set| sample_numbers(set, precision, &sequence, what, &requests);
                for (name, other) in on_each(ask) {
                    assert_eq!(together, other, "{name}");
                }
                // Another seed, another pixel: other numbers.
                let sequence = self::sequence(kind, 8, 64);
                let other = drawn(precision, &sequence, what, requests.into_iter());
                assert!(together.iter().zip(&other).filter(|(a, b)| a == b).count() < 20);
            }
        }
    }
}

/// Means over the samples of each pixel of f(number `column`).
fn pixel_means(drawn: &[[f64; 5]], n: u32, column: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    drawn
        .chunks(n as usize)
        .map(|pixel| pixel.iter().map(|x| f(x[column])).sum::<f64>() / f64::from(n))
        .collect()
}

/// 1 for numbers below an edge, and 0 for others.
fn below(edge: f64) -> impl Fn(f64) -> f64 {
    move |x| f64::from(u8::from(x < edge))
}

/// Truth for the kind of point set: independent, jittered or stratified in one dimension.
fn promised(kind: SamplerKind, names: [&str; 3]) -> &str {
    match kind {
        SamplerKind::Independent => names[0],
        SamplerKind::Stratified => names[1],
        SamplerKind::Sobol | SamplerKind::Center => names[2],
    }
}

/// Runs both truths over all kinds and sizes; `spoil` may change numbers and must be noticed.
fn variances(precision: Precision, spoil: impl Fn(u32, f64) -> f64) -> Vec<(String, f64)> {
    let edge = truth("edge_variance");
    let edge_at = edge.of("p");
    let ramp = truth("ramp_variance");
    let mut p_values = Vec::new();
    for kind in KINDS {
        for (edge_row, ramp_row) in edge.rows("rows").iter().zip(ramp.rows("rows")) {
            let n = number(&edge_row["N"]) as u32;
            assert_eq!(n, number(&ramp_row["N"]) as u32);
            let of = |row: &Value, names| number(&row[promised(kind, names)]);
            let names = ["var_independent", "var_jittered", "var_lhs"];
            let edge_variance = of(edge_row, names);
            let names = ["var_independent", "var_jittered", "var_stratified_1d"];
            let ramp_variance = of(ramp_row, names);
            for what in [Numbers::Camera, Numbers::Pair(Slot::Light, 2)] {
                let mut drawn = pixels_of(precision, sequence(kind, 31, n), what, 2_000, n);
                for (i, numbers) in drawn.iter_mut().enumerate() {
                    for x in numbers {
                        *x = spoil(i as u32 % n, *x);
                    }
                }
                for column in 0..2 {
                    let edge_means = pixel_means(&drawn, n, column, below(edge_at));
                    let ramp_means = pixel_means(&drawn, n, column, |x| x);
                    for (name, means, mean, variance) in [
                        ("edge", edge_means, edge_at, edge_variance),
                        ("ramp", ramp_means, 0.5, ramp_variance),
                    ] {
                        let what = format!("{name} {kind:?} {n} {what:?} {column}");
                        if let Some(p) = variance_p(&means, mean, variance) {
                            p_values.push((format!("variance, {what}"), p));
                        }
                        p_values.push((format!("mean, {what}"), t_test(&means, mean)));
                    }
                }
            }
        }
    }
    p_values
}

#[test]
fn point_sets_have_the_variance_they_promise() {
    for precision in PRECISIONS {
        for (what, p) in variances(precision, |_, x| x) {
            assert!(p > level(), "{precision:?} {what}: {p:e}");
        }
    }
}

#[test]
fn a_shifted_or_clumped_point_set_is_noticed() {
    // A fiftieth of the square missing at one side; every eighth sample taken twice.
    let last = std::cell::Cell::new(0.5);
    let clump = |i, x| match i % 8 {
        7 => last.get(),
        _ => {
            last.set(x);
            x
        }
    };
    for (what, p_values) in [
        ("shifted", variances(Precision::Single, |_, x| 0.98 * x)),
        ("clumped", variances(Precision::Single, clump)),
    ] {
        let caught = p_values.iter().filter(|(_, p)| *p < level()).count();
        let all = p_values.len();
        assert!(caught * 3 > all, "{what}: {caught} of {all}");
    }
}

/// Whether 2ᵐ points have one in each elementary interval of area 2⁻ᵐ.
fn is_net(points: &[[f64; 5]]) -> bool {
    let m = points.len().trailing_zeros();
    (0..=m).all(|a| {
        let (across, down) = (1u32 << a, 1u32 << (m - a));
        let mut seen = vec![false; points.len()];
        for [u, v, ..] in points {
            let (i, j) = ((u * f64::from(across)) as u32, (v * f64::from(down)) as u32);
            seen[(j * across + i) as usize] = true;
        }
        seen.into_iter().all(|s| s)
    })
}

#[test]
fn scrambled_sobol_points_are_nets_in_every_aligned_block() {
    let sequence = sequence(SamplerKind::Sobol, 3, 1024);
    for what in [
        Numbers::Camera,
        Numbers::Pair(Slot::Light, 0),
        Numbers::Pair(Slot::Bsdf, 5),
    ] {
        for pixel in pixels_of(Precision::Double, sequence, what, 24, 1024).chunks(1024) {
            for m in 0..=10 {
                for block in pixel.chunks(1 << m) {
                    assert!(is_net(block), "2^{m}, {what:?}");
                    // One coordinate of each dimension in every interval of length 2⁻ᵐ.
                    for column in 0..what.width() {
                        let cell = |x: &[f64; 5]| (x[column] * block.len() as f64) as usize;
                        let cells: BTreeSet<usize> = block.iter().map(cell).collect();
                        let all = cells.into_iter().eq(0..block.len());
                        assert!(all, "2^{m}, {what:?} {column}");
                    }
                }
            }
        }
    }
    // Planted: one point moved by a quarter.
    let mut points = pixels_of(Precision::Double, sequence, Numbers::Camera, 1, 64);
    points[10][0] = (points[10][0] + 0.25) % 1.0;
    assert!(!is_net(&points));
}

/// Squared L₂ star discrepancy (T. Warnock 1972).
fn discrepancy(points: &[[f64; 5]]) -> f64 {
    let n = points.len() as f64;
    let single = |p: &[f64; 5]| p.iter().map(|x| (1.0 - x * x) / 2.0).product::<f64>();
    let singles: f64 = points.iter().map(single).sum();
    let mut pairs = 0.0;
    for p in points {
        for q in points {
            let sides = p.iter().zip(q).map(|(a, b)| 1.0 - a.max(*b));
            pairs += sides.product::<f64>();
        }
    }
    libm::pow(1.0 / 3.0, 5.0) - 2.0 / n * singles + pairs / (n * n)
}

#[test]
fn prefixes_of_odd_length_are_better_than_random() {
    let mean = |kind| {
        let sequence = sequence(kind, 17, 1024);
        let drawn = pixels_of(Precision::Double, sequence, Numbers::Camera, 8, 1024);
        let each: Vec<f64> = drawn.chunks(1024).map(|p| discrepancy(&p[..700])).collect();
        moments(&each)
    };
    let (sobol, independent) = (mean(SamplerKind::Sobol), mean(SamplerKind::Independent));
    println!("squared discrepancy at 700: {sobol:?}, independent {independent:?}");
    // Expected of independent points: (2⁻⁵ − 3⁻⁵)/700 = 3.9e-5.
    let expected = (libm::pow(0.5, 5.0) - libm::pow(1.0 / 3.0, 5.0)) / 700.0;
    assert!((independent.0 / expected - 1.0).abs() < 0.5);
    assert!(sobol.0 < independent.0 / 5.0);
}

#[test]
fn different_slots_are_uncorrelated() {
    let n = 64;
    let pixels = 3_000;
    let whats = [
        Numbers::Camera,
        Numbers::Pair(Slot::Light, 0),
        Numbers::Pair(Slot::Bsdf, 0),
        Numbers::Single(Slot::Choice, 0),
        Numbers::Pair(Slot::Light, 1),
        Numbers::Single(Slot::Roulette, 1),
    ];
    for kind in KINDS {
        let drawn =
            whats.map(|what| pixels_of(Precision::Single, sequence(kind, 29, n), what, pixels, n));
        for i in 0..whats.len() {
            for j in 0..i {
                for column in 0..whats[j].width() {
                    // The covariance over the points of each pixel.
                    let pixels = |i: usize| drawn[i].chunks(n as usize);
                    let covariance = |(a, b): (&[[f64; 5]], &[[f64; 5]])| {
                        let pairs = a.iter().zip(b);
                        let products = pairs.map(|(a, b)| (a[0] - 0.5) * (b[column] - 0.5));
                        products.sum::<f64>() / f64::from(n)
                    };
                    let products: Vec<f64> = pixels(i).zip(pixels(j)).map(covariance).collect();
                    let what = format!("{kind:?} {:?} {:?} {column}", whats[i], whats[j]);
                    assert!(t_test(&products, 0.0) > level(), "{what}");
                    // As of points paired at random, 1/(144 n); a nested shuffle of the index
                    // flips the samples 2i and 2i + 1 together, so that the halves of both numbers
                    // are paired by n/2 coins only: up to twice as much.
                    let (_, variance) = moments(&products);
                    let relative = variance * 144.0 * f64::from(n);
                    let most = if kind == SamplerKind::Sobol { 2.2 } else { 1.2 };
                    assert!((0.8..most).contains(&relative), "{what}: {relative}");
                }
            }
        }
    }
}

/// Images of words, each with its seed, on the best instruction set.
fn image(shuffle: Shuffle, words: &[[u32; 2]]) -> Vec<u32> {
    shuffled(Instructions::best(), Precision::Single, shuffle, words)
}

#[test]
fn scrambling_is_nested_and_its_flips_are_balanced() {
    let mut rng = Pcg64Mcg::seed_from_u64(41);
    let rounds = 20_000;
    // Flips of bit k, and how often they differ between words that differ in a lower bit.
    let mut flips = [0u64; 32];
    let mut differ = [[0u64; 2]; 32];
    let mut words = Vec::new();
    for i in 0..rounds {
        let (x, seed): (u32, u32) = (rng.random(), rng.random());
        let bit = i % 32;
        words.extend([[x, seed], [x ^ 1 << bit, seed]]);
    }
    let scrambled = image(Shuffle::Scramble, &words);
    for (i, (pair, out)) in words.chunks(2).zip(scrambled.chunks(2)).enumerate() {
        let bit = i % 32;
        let changed = out[0] ^ out[1];
        // Lower bits stay, the bit itself changes.
        assert_eq!(changed & ((1u64 << (bit + 1)) - 1) as u32, 1 << bit);
        let flipped = [pair[0][0] ^ out[0], pair[1][0] ^ out[1]];
        for (k, count) in flips.iter_mut().enumerate() {
            *count += u64::from(flipped[0] >> k & 1);
        }
        for (k, counts) in differ.iter_mut().enumerate().skip(bit + 1) {
            counts[usize::from((flipped[0] ^ flipped[1]) >> k & 1 == 1)] += 1;
        }
    }
    for k in 0..32 {
        let z = (flips[k] as f64 - rounds as f64 / 2.0) / (rounds as f64 / 4.0).sqrt();
        assert!(normal_p(z) > level(), "bit {k}: {} of {rounds}", flips[k]);
        let [same, other] = differ[k];
        let total = (same + other) as f64;
        // An exact scramble has 1/2; the hash is a cheap one.
        if k > 0 {
            let share = other as f64 / total;
            println!("bit {k}: depends on lower bits in {share:.3}");
            let allowed = 0.06 + 5.0 * (0.25 / total).sqrt();
            assert!((share - 0.5).abs() < allowed, "bit {k}: {share}");
        }
    }
}

#[test]
fn permutations_are_bijections_and_even() {
    let mut rng = Pcg64Mcg::seed_from_u64(43);
    for count in (1..40).chain([49, 100, 257, 700, 1024, 4095, 4097]) {
        for _ in 0..10 {
            let seed = rng.random();
            let words: Vec<[u32; 2]> = (0..count).map(|i| [i, seed]).collect();
            let mut image = image(Shuffle::Permutation(count), &words);
            image.sort_unstable();
            assert!(image.into_iter().eq(0..count), "{count}");
        }
    }
    // Where the first two elements go.
    for count in [2u32, 3, 4, 5, 7, 8, 9, 16, 25, 49] {
        let seeds = 40_000;
        let mut pair = |_| {
            let seed = rng.random();
            [[0, seed], [1, seed]]
        };
        let words: Vec<[u32; 2]> = (0..seeds).flat_map(&mut pair).collect();
        let image = image(Shuffle::Permutation(count), &words);
        let mut first = vec![0; count as usize];
        let mut both = vec![0; (count * count) as usize];
        for pair in image.chunks(2) {
            first[pair[0] as usize] += 1;
            both[(pair[0] * count + pair[1]) as usize] += 1;
        }
        let each = f64::from(seeds) / f64::from(count);
        let p = chi_square(&first, &vec![each; count as usize]);
        assert!(p > level(), "{count}: first element {first:?}, {p:e}");
        // Equal images cannot be.
        let apart = |k: u32| f64::from(u8::from(k / count != k % count));
        let expected = (0..count * count).map(|k| apart(k) * each / f64::from(count - 1));
        let expected: Vec<f64> = expected.collect();
        let p = chi_square(&both, &expected);
        assert!(p > level(), "{count}: pairs {p:e}");
    }
}

#[test]
fn many_strata_stay_in_the_square() {
    // As many strata as f32 can count.
    for points in [1 << 22, 3000 * 2999, (1 << 24) - 1] {
        let sequence = sequence(SamplerKind::Stratified, 2, points);
        for what in [Numbers::Pair(Slot::Light, 0), Numbers::Camera] {
            let requests = (0..20_000).map(|i| [1, 2, 0, i * (points / 20_000)]);
            let drawn = |precision| drawn(precision, &sequence, what, requests.clone()).concat();
            let [single, double] = PRECISIONS.map(drawn);
            for (a, b) in single.iter().zip(&double) {
                let within = (0.0..1.0).contains(a) && (a - b).abs() < 1e-6;
                assert!(within, "{points}: {a} {b}");
            }
        }
    }
}

#[test]
fn replicates_share_out_all_samples() {
    let kinds = [1, 2, 3, 8].map(Replicates::Fixed);
    for replicates in kinds.into_iter().chain([Replicates::Growing]) {
        let most = 20_000;
        let mut seen: Vec<u32> = Vec::new();
        for i in 0..most {
            let (replicate, index) = replicates.place(i);
            if replicate as usize >= seen.len() {
                seen.resize(replicate as usize + 1, 0);
            }
            // Each replicate's indices come in order, none left out: a bijection.
            assert_eq!(seen[replicate as usize], index, "{replicates:?} at {i}");
            seen[replicate as usize] += 1;
            let samples = i + 1;
            let mut steps = [1u32, 2, 256, 512, 4096, 8192].iter();
            let near_a_step = steps.any(|s| samples.abs_diff(*s) < 20);
            if near_a_step || samples % 997 == 0 {
                let reached = seen.iter().filter(|&&n| n > 0).count();
                let what = format!("{replicates:?} {samples}");
                assert_eq!(replicates.count(samples) as usize, reached, "{what}");
                for (r, &own) in (0..).zip(&seen) {
                    assert_eq!(replicates.samples_of(r, samples), own, "{what} {r}");
                }
                assert_eq!(replicates.samples_of(seen.len() as u32 + 7, samples), 0);
            }
        }
    }
}

#[test]
fn standard_errors_are_honest() {
    // 16 samples in each of 8 jittered replicates across an edge.
    let edge = truth("edge_variance");
    let p = edge.of("p");
    let row = &edge.rows("rows")[1];
    let (replicates, spp, pixels) = (Replicates::Fixed(8), 128, 3_000);
    let sequence = Sequence::new(SamplerKind::Stratified, 3, spp, replicates);
    let request = |k: u32| {
        let (replicate, index) = replicates.place(k % spp);
        [k / spp, 0, replicate, index]
    };
    let requests = (0..pixels * spp).map(request);
    let drawn = drawn(Precision::Single, &sequence, Numbers::Camera, requests);
    let mut film = Pixels::new(pixels as usize, replicates, spp);
    for (k, numbers) in drawn.iter().enumerate() {
        let (pixel, i) = (k as u32 / spp, k as u32 % spp);
        let value = below(p)(numbers[0]);
        film.add(pixel as usize, i..i + 1, &[[value, 2.0 * value, 1.0]]);
    }
    let counts = replicates.counts(spp);
    let estimates = (0..pixels as usize).map(|i| film.estimate(i, &counts, |xyz| xyz));
    let estimates: Vec<_> = estimates.collect();
    let squares = estimates.iter().map(|e| e.standard_error[0].powi(2));
    let squares: Vec<f64> = squares.collect();
    let variance = number(&row["var_jittered"]) / 8.0;
    assert!(t_test(&squares, variance) > level());
    let means: Vec<f64> = estimates.iter().map(|e| e.mean[0]).collect();
    assert!(variance_p(&means, p, variance).unwrap() > level());
    for e in &estimates {
        assert!((e.standard_error[1] - 2.0 * e.standard_error[0]).abs() < 1e-12);
        assert!(e.standard_error[2] < 1e-12 && (e.mean[2] - 1.0).abs() < 1e-12);
    }
    // Planted: what s²/N of the single samples would say is 3.7 times too large.
    let naive = p * (1.0 - p) / f64::from(spp);
    assert!(t_test(&squares, naive) < level());
    // A single replicate has no standard error, and says so.
    let mut film = Pixels::new(1, Replicates::Fixed(1), u32::MAX);
    film.add(0, 0..1, &[[1.0; 3]]);
    assert!(film.estimate(0, &[1.0], |xyz| xyz).standard_error[0].is_nan());
}

#[test]
fn stopping_on_the_pilot_is_biased_and_fixed_counts_are_not() {
    let truth = truth("two_stage_bias");
    let p = truth.of("p");
    let n = truth.of("N");
    let count = n as u32;
    let sequence = sequence(SamplerKind::Independent, 6, count);
    let drawn = pixels_of(Precision::Single, sequence, Numbers::Camera, 4_000, count);
    let fixed = pixel_means(&drawn, count, 0, below(p));
    assert!(t_test(&fixed, p) > level());
    for row in truth.rows("rows") {
        let k = number(&row["k"]);
        // The mean of a pixel whose pilot has so many hits: all equal stop, the others go on to N.
        let ends = |pilot: f64, all: f64| match pilot {
            _ if pilot == 0.0 || pilot == k => pilot / k,
            _ => all / n,
        };
        // Σ over pilots with j hits.
        let mut expected = 0.0;
        let mut binomial = 1.0;
        for j in (0..=k as u32).map(f64::from) {
            let chance = binomial * libm::pow(p, j) * libm::pow(1.0 - p, k - j);
            expected += chance * ends(j, j + (n - k) * p);
            binomial *= (k - j) / (j + 1.0);
        }
        let off = (expected - number(&row["E_reuse"])).abs();
        assert!(off < 1e-12, "{expected}");
        let relative = number(&row["relative_bias"]);
        assert!((expected / p - 1.0 - relative).abs() < 1e-10);
        // The same happens to real samples.
        let mean = |pixel: &[[f64; 5]]| {
            let hits = |m: f64| pixel[..m as usize].iter().filter(|x| x[0] < p).count() as f64;
            ends(hits(k), hits(n))
        };
        let means: Vec<f64> = drawn.chunks(n as usize).map(mean).collect();
        assert!(t_test(&means, expected) > level());
        assert!(t_test(&means, p) < level());
    }
}

#[test]
fn weights_of_both_strategies_sum_to_one() {
    let power = |(i, j): (i32, i32)| [(1.3, i), (0.7, j)].map(|(x, e)| x * libm::exp10(e.into()));
    let pairs = (-25..=25).flat_map(|i| (-25..=25).map(move |j| (i, j)));
    // At last, no density of the other strategy: all the weight.
    let pairs = pairs.map(power).chain([[0.3, 0.0]]);
    let (ps, qs): (Vec<f64>, Vec<f64>) = pairs.map(|[p, q]| (p, q)).unzip();
    for precision in PRECISIONS {
        let [a, b] = everywhere(|set| power_weights(set, precision, [&ps, &qs]));
        for (i, (a, b)) in a.iter().zip(&b).enumerate() {
            let (p, q) = (ps[i], qs[i]);
            let off = (a + b - 1.0).abs();
            assert!(off <= 4.0 * precision.roundoff(), "{p} {q}");
            let ratio = q / p;
            let want = 1.0 / (1.0 + ratio * ratio);
            assert!((a - want).abs() <= 8.0 * precision.roundoff());
        }
        assert_eq!(a[a.len() - 1], 1.0);
    }
}

/// Counts over N × N bins of two numbers in [0, 1], against equal shares.
pub fn evenness<const N: usize>(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let mut counts = vec![0; N * N];
    let mut total = 0.0;
    for (a, b) in pairs {
        let cell = |x: f64| ((x * N as f64) as usize).min(N - 1);
        counts[cell(a) * N + cell(b)] += 1;
        total += 1.0;
    }
    chi_square(&counts, &vec![total / (N * N) as f64; N * N])
}

/// The angle of (x, y) from the negative x axis, in turns.
pub fn turn(x: f64, y: f64) -> f64 {
    libm::atan2(y, x) / TAU + 0.5
}

/// p-values of disk, hemisphere and sphere in coordinates in which each is uniform.
fn warps(precision: Precision, seed: u64, bend: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let count = 60_000;
    let u: Vec<f64> = (0..count).map(|_| bend(rng.random())).collect();
    let v: Vec<f64> = (0..count).map(|_| rng.random()).collect();
    let [x, y, hx, hy, hz, sx, sy, sz, pdf] =
        everywhere(|set| samplers::warps(set, precision, [&u, &v]));
    for i in 0..count {
        let u = precision.roundoff();
        let hemisphere = hx[i] * hx[i] + hy[i] * hy[i] + hz[i] * hz[i];
        let sphere = sx[i] * sx[i] + sy[i] * sy[i] + sz[i] * sz[i];
        assert!((hemisphere - 1.0).abs() < 16.0 * u && (sphere - 1.0).abs() < 16.0 * u);
        assert!(hz[i] > 0.0 && x[i] * x[i] + y[i] * y[i] <= 1.0 + 8.0 * u);
        assert!((pdf[i] - hz[i] / PI).abs() <= 2.0 * u);
    }
    [
        // r² is uniform on the disk, as is cos² for the cosine density (∫ cos/π dω = cos²), and z
        // on the sphere.
        evenness::<16>((0..count).map(|i| (x[i] * x[i] + y[i] * y[i], turn(x[i], y[i])))),
        evenness::<16>((0..count).map(|i| (hz[i] * hz[i], turn(hx[i], hy[i])))),
        evenness::<16>((0..count).map(|i| ((sz[i] + 1.0) / 2.0, turn(sx[i], sy[i])))),
    ]
}

#[test]
fn warps_follow_their_densities() {
    for precision in PRECISIONS {
        for (k, p) in warps(precision, 51, |u| u).into_iter().enumerate() {
            assert!(p > level(), "warp {k}, {precision:?}: {p:e}");
        }
    }
    // The cosine density integrates to 1: Simpson's rule is exact for its primitive's degree.
    let n = 1_000;
    let cosines = (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n));
    let integral: f64 = cosines.map(|c| c / PI * TAU / f64::from(n)).sum();
    assert!((integral - 1.0).abs() < 1e-12);
    // Planted: a variate bent by 2.5 %.
    let bent = warps(Precision::Double, 52, |u| u + 0.1 * u * (1.0 - u));
    assert!(bent.iter().all(|p| *p < level()), "{bent:?}");
}

/// Corners of the unit square, where formulas divide.
#[test]
fn warps_are_finite_at_the_corners() {
    let edge = [0.0, 0.25, 0.5, 0.75, 1.0 - f64::EPSILON, 1e-30];
    let corners = edge.into_iter().flat_map(|a| edge.map(|b| (a, b)));
    let (u, v): (Vec<f64>, Vec<f64>) = corners.unzip();
    for precision in PRECISIONS {
        for column in everywhere(|set| samplers::warps(set, precision, [&u, &v])) {
            assert!(column.iter().all(|x| x.abs() <= 1.0 + 1e-6));
        }
    }
}
