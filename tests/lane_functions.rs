//! Elementary functions and vectors in lanes: errors in units in the last place against f64 or
//! double-double, and the same bits on every instruction set.

use std::f64::consts::TAU;

use etalon_doors::{functions, words};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::lanes_support::{PRECISIONS, Precision, axes, everywhere, on_each};
use crate::shape_ladder::cubed;

/// A unit in the last place of numbers in [1, 2).
fn ulp_of_one(precision: Precision) -> f64 {
    2.0 * precision.roundoff()
}

/// Distance of neighbouring numbers at |x|, normal range.
fn ulp(precision: Precision, x: f64) -> f64 {
    libm::exp2(libm::log2(x.abs()).floor()) * ulp_of_one(precision)
}

/// sin 2πu and cos 2πu to about 1e-16 relative: reduced exactly to an eighth of a turn, and 2π in
/// two parts.
fn sin_cos_truth(u: f64) -> (f64, f64) {
    const TAU_LOW: f64 = 2.449_293_598_294_706_4e-16;
    let quarter = (4.0 * u).round_ties_even();
    let r = u - 0.25 * quarter;
    let x = TAU * r;
    let low = r.mul_add(TAU, -x) + r * TAU_LOW;
    let (s, c) = (libm::sin(x), libm::cos(x));
    let (s, c) = (s + low * c, c - low * s);
    match (quarter as i64).rem_euclid(4) {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// A dense grid of [-2, 2], and numbers close to every eighth.
fn turns(precision: Precision) -> Vec<f64> {
    let steps = 1 << 17;
    let mut all: Vec<f64> = (-2 * steps..=2 * steps)
        .map(|i| f64::from(i) / f64::from(steps) + 1e-7 * f64::from(i % 17))
        .collect();
    for i in -16..=16 {
        let eighth = f64::from(i) / 8.0;
        all.push(eighth);
        for k in 1..40 {
            let away = libm::exp2(-f64::from(k) - 4.0);
            all.extend([eighth - away, eighth + away]);
        }
    }
    all.extend([0.0, -0.0, 5e-324, 1e-300, 1e-38]);
    all.retain(|u| u.abs() <= 2.0);
    all.into_iter().map(|u| precision.rounded(u)).collect()
}

#[test]
fn sine_and_cosine_are_within_their_bounds() {
    for precision in PRECISIONS {
        let u = turns(precision);
        let [s, c] = everywhere(|set| functions::sine_and_cosine(set, precision, [&u]));
        let (mut worst, mut worst_absolute) = (0.0_f64, 0.0_f64);
        for ((&u, &s), &c) in u.iter().zip(&s).zip(&c) {
            let (sine, cosine) = sin_cos_truth(u);
            for (value, truth) in [(s, sine), (c, cosine)] {
                let error = (value - truth).abs();
                worst_absolute = worst_absolute.max(error / ulp_of_one(precision));
                if truth.abs() > 1e-30 {
                    worst = worst.max(error / ulp(precision, truth));
                }
                assert!(value.abs() <= 1.0, "{value} at {u}");
            }
        }
        println!("{precision:?}: sin, cos {worst} ulp; {worst_absolute} ulp of 1");
        assert!(worst <= 2.5 && worst_absolute <= 1.0);
    }
}

#[test]
fn the_logarithm_is_within_its_bound() {
    for (precision, highest) in [(Precision::Single, 127), (Precision::Double, 1023)] {
        let grid = (0..200_000).map(|i| 0.5 + f64::from(i) / 80_000.0);
        let mut x: Vec<f64> = grid.collect();
        for e in 1 - highest..=highest {
            let power = libm::exp2(f64::from(e));
            x.extend([1.0, 1.0 + 1e-7, 1.2, 1.414, 1.415, 1.7, 1.999_999].map(|m| m * power));
        }
        for k in 1..50 {
            let away = libm::exp2(-f64::from(k));
            x.extend([1.0 - away, 1.0 + away]);
        }
        let x: Vec<f64> = x.into_iter().map(|x| precision.rounded(x)).collect();
        let [y] = everywhere(|set| functions::logarithm(set, precision, [&x]));
        let mut worst = 0.0_f64;
        for (&x, &y) in x.iter().zip(&y) {
            match libm::log(x) {
                0.0 => assert_eq!(y, 0.0),
                truth => worst = worst.max((y - truth).abs() / ulp(precision, truth)),
            }
        }
        println!("{precision:?}: ln {worst} ulp");
        // libm's own half unit is in the figure for f64.
        assert!(worst <= 3.5, "{worst}");
    }
}

#[test]
fn the_angle_is_within_its_bound() {
    // Truth in f64 and its division by 2π are half a unit of ½ off by themselves.
    for (precision, bound) in [(Precision::Single, 0.3), (Precision::Double, 0.6)] {
        let (mut ys, mut xs) = (Vec::new(), Vec::new());
        let mut add = |y: f64, x: f64| {
            ys.push(precision.rounded(y));
            xs.push(precision.rounded(x));
        };
        for i in 0..60_000 {
            let angle = TAU * (f64::from(i) + 0.3) / 60_000.0;
            let scale = [1.0, 1e-9, 1e9, 3.7][i as usize % 4];
            add(scale * libm::sin(angle), scale * libm::cos(angle));
        }
        let special = [0.0, -0.0, 1.0, -1.0, 1e-12, -1e-12, 1e12, -1e12];
        for y in special {
            special.iter().for_each(|x| add(y, *x));
        }
        let [turns] = everywhere(|set| functions::angle(set, precision, [&ys, &xs]));
        let mut worst = 0.0_f64;
        for ((&y, &x), &turns) in ys.iter().zip(&xs).zip(&turns) {
            if (x, y) == (0.0, 0.0) {
                // (0, −0) is no direction: any finite angle will do.
                assert!(turns.is_finite());
                continue;
            }
            // The sign of zero: −½ and ½ are the same angle.
            let truth = libm::atan2(y, x) / TAU;
            let error = (turns - truth).abs();
            worst = worst.max(error / ulp_of_one(precision));
            assert!(turns.abs() <= 0.5);
        }
        println!("{precision:?}: atan2 {worst} ulp of 1, in turns");
        // Absolute: small angles are differences from an eighth of a turn.
        assert!(worst <= bound, "{worst}");
    }
}

#[test]
fn frames_are_orthonormal_and_right_handed() {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let mut vectors = Vec::new();
    for (axis, sign) in [0, 1, 2]
        .into_iter()
        .flat_map(|axis| [(axis, 1.0), (axis, -1.0)])
    {
        let mut v = DVec3::new(0.0, -0.0, 0.0);
        v[axis] = sign;
        vectors.push(v);
    }
    // Near the pole where the formula divides by 1 + z.
    vectors.extend([DVec3::new(1e-9, -1e-9, -1.0), DVec3::new(1e-4, 1e-5, -1.0)]);
    vectors.extend((0..20_000).map(|_| cubed(&mut rng)));
    let [x, y, z] = &axes(&vectors);
    for precision in PRECISIONS {
        let out = everywhere(|set| functions::frame(set, precision, [x, y, z]));
        let vector = |k: usize, i: usize| DVec3::from_array([0, 1, 2].map(|j| out[3 * k + j][i]));
        let mut worst = 0.0_f64;
        for i in 0..out[0].len() {
            let [n, s, t, across] = [0, 1, 2, 3].map(|k| vector(k, i));
            let lengths = [n, s, t].map(|v| v.length() - 1.0);
            let right = [n.dot(s), n.dot(t), s.dot(t), (across - n).length()];
            for error in lengths.into_iter().chain(right) {
                worst = worst.max(error.abs() / precision.roundoff());
            }
        }
        println!("{precision:?}: frames within {worst} u");
        assert!(worst <= 8.0, "{worst}");
    }
}

/// Integer and conversion operations on nasty words and on random ones.
#[test]
fn words_wrap_alike_in_every_kind_of_lane() {
    const SPECIAL: [u32; 6] = [0, 1, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0x00ff_ffff];
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut words = |special: fn(usize) -> usize| -> Vec<u32> {
        let pairs = (0..36).map(|i| SPECIAL[special(i)]);
        pairs.chain((36..6400).map(|_| rng.random())).collect()
    };
    let (a, b) = (words(|i| i % 6), words(|i| i / 6));
    for (precision, bits) in [(Precision::Single, 24), (Precision::Double, 32)] {
        let all = on_each(|set| words::operations(set, precision, &a, &b));
        for (name, results) in &all {
            check_words(&a, &b, bits, results);
            assert!(results.same.iter().all(|same| *same));
            for (column, first) in results.words.iter().zip(&all[0].1.words) {
                assert_eq!(column, first, "{precision:?} on {name}");
            }
            assert_eq!(results.uniform, all[0].1.uniform, "{precision:?} on {name}");
        }
    }
}

/// Results against those of plain integers; uniform variates keep so many bits.
fn check_words(a: &[u32], b: &[u32], bits: i32, results: &words::Results) {
    type Word = fn(u32, u32) -> u32;
    let operations: [Word; 9] = [
        u32::wrapping_add,
        u32::wrapping_sub,
        u32::wrapping_mul,
        |a, _| a << 7,
        |a, _| a >> 9,
        |a, b| a ^ b,
        |a, b| a & b,
        |a, b| a | b,
        |a, _| a.reverse_bits(),
    ];
    for (i, (&a, &b)) in a.iter().zip(b).enumerate() {
        for (k, (column, want)) in results.words.iter().zip(operations).enumerate() {
            assert_eq!(column[i], want(a, b), "operation {k}");
        }
        assert_eq!(results.below[i], a < b);
        let u = results.uniform[i];
        assert!((0.0..1.0).contains(&u));
        // Rounded down, by less than the last bit kept.
        let exact = f64::from(a) / 4_294_967_296.0;
        assert!(u <= exact && exact - u < libm::exp2(-f64::from(bits)));
        assert_eq!(results.reals[i], f64::from(a >> 8));
        assert_eq!(results.truncated[i], a >> 8);
    }
}

/// Comparison, min, max, rounding with NaN, infinities and signed zeros.
#[test]
fn odd_numbers_are_treated_alike() {
    let infinite = [f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    let odd = [&infinite[..], &[0.0, -0.0, 1.0, -1.5, 2.5, 1e-40, 1e30]].concat();
    let pairs = odd.iter().flat_map(|x| odd.iter().map(move |y| (x, y)));
    let (a, b): (Vec<f64>, Vec<f64>) = pairs.unzip();
    for precision in PRECISIONS {
        let [min, max, floor, round, ..] =
            everywhere(|set| functions::operations(set, precision, [&a, &b]));
        for (i, (&a, &b)) in a.iter().zip(&b).enumerate() {
            let (a, b) = (precision.rounded(a), precision.rounded(b));
            let expect =
                |got: f64, want: f64| assert!(got == want || (got.is_nan() && want.is_nan()));
            expect(min[i], if a < b { a } else { b });
            expect(max[i], if a > b { a } else { b });
            expect(floor[i], a.floor());
            expect(round[i], a.round_ties_even());
        }
    }
}
