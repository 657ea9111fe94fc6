//! The statistics that judge pictures, on numbers whose law is known.

use etalon::Estimate;
use etalon::inside::stats::estimate::POWER;
use etalon::inside::stats::family::sidak;
use etalon::inside::stats::student;
use etalon::inside::stats::uniformity::anderson_darling;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::agreement::verdict::{Verdict, judge};
use crate::statistics_support::holm;

fn generator(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed)
}

fn normal(random: &mut Pcg64Mcg) -> f64 {
    // Never 0, whose quantile is infinite.
    Normal::standard().inverse_cdf(1.0 - random.random::<f64>())
}

/// Abramowitz and Stegun, table 26.10, and the normal table.
#[test]
fn quantiles_are_those_of_the_tables() {
    for (level, freedom, t) in [
        (0.05, 1.0, 12.706),
        (0.05, 7.0, 2.365),
        (0.01, 10.0, 3.169),
        (0.001, 30.0, 3.646),
        (0.001, f64::INFINITY, 3.291),
        (1e-6, f64::INFINITY, 4.892),
    ] {
        let found = student::critical(level, freedom);
        assert!((found - t).abs() < 5e-4, "{found} instead of {t}");
    }
}

/// Also far out and for fractional degrees of freedom, as Welch has them.
#[test]
fn quantiles_invert_the_tail() {
    for freedom in [1.0, 1.7, 4.0, 63.2, 1e4, 1e7] {
        for level in [0.5, 0.05, 1e-3, 1e-6, 1e-9] {
            let back = student::two_sided(student::critical(level, freedom), freedom);
            let off = (back / level - 1.0).abs();
            assert!(off < 1e-6, "level {level}, freedom {freedom}: {back}");
        }
    }
}

/// p-values of means whose variances have one degree of freedom each are uniform, whatever the
/// variances: that is what Satterthwaite's degrees of freedom are for. Without them (with z in
/// place of t) small p-values are too frequent.
#[test]
fn welch_intervals_are_honest() {
    let mut random = generator(1);
    let (runs, pixels) = (20_000, 12);
    let (mut by_student, mut by_normal) = (0, 0);
    for _ in 0..runs {
        let mut side = |scale: f64| {
            let mut pixel = |_| {
                let [a, b] = [0, 1].map(|_| scale * normal(&mut random));
                ((a + b) / 2.0, (a - b) * (a - b) / 4.0)
            };
            let (means, variances): (Vec<f64>, Vec<f64>) = (0..pixels).map(&mut pixel).unzip();
            Estimate::mean_of(&means, &variances, 1.0)
        };
        let difference = side(1.0).minus(&side(0.3));
        by_student += usize::from(difference.p_value(0.0, 0.0) < 0.01);
        by_normal += usize::from(student::two_sided(difference.score(0.0), f64::INFINITY) < 0.01);
    }
    let expected = 0.01 * f64::from(runs);
    // The approximation is good to a quarter at this level; the noise is 14.
    let most = 1.25 * expected + 4.0 * expected.sqrt();
    let by_student = by_student as f64;
    assert!(by_student < most, "{by_student} of {runs} below 1 %");
    assert!(by_normal as f64 > 1.5 * expected, "{by_normal}");
}

#[test]
fn holm_goes_on_while_it_rejects() {
    // 0.01/3, 0.01/2, 0.01/1: the third would not be rejected on its own level of 0.01/3.
    assert_eq!(holm(&[0.004, 0.001, 0.5], 0.01), [1, 0]);
    assert_eq!(holm(&[0.004, 0.005, 0.5], 0.01), [0; 0]);
    let level = sidak(1e-3, 100);
    assert!((1.0 - (1.0 - level).powi(100) - 1e-3).abs() < 1e-12);
}

/// Lewis's table (1961): A² = 2.492 has p = 0.05, 3.857 has 0.01; simulation agrees further out.
#[test]
fn anderson_darling_has_its_level() {
    let mut random = generator(2);
    let runs = 40_000;
    let p_values = (0..runs).map(|_| anderson_darling(&random.random::<[f64; 40]>()));
    let p_values: Vec<f64> = p_values.collect();
    for level in [0.5, 0.05, 0.01, 1e-3] {
        let below = p_values.iter().filter(|p| **p < level).count() as f64;
        let expected = level * f64::from(runs);
        let deviation = (expected * (1.0 - level)).sqrt();
        let (off, most) = ((below - expected).abs(), 4.0 * deviation + 0.06 * expected);
        assert!(off < most, "{below} of {runs} below {level}");
    }
}

/// Error bars 10 % too small, a shift of a tenth of a standard error, and a value that is none.
#[test]
fn anderson_darling_sees_dishonest_scores() {
    let mut random = generator(5);
    let scores: Vec<f64> = (0..4000).map(|_| normal(&mut random)).collect();
    let p = |map: &dyn Fn(f64) -> f64| {
        let numbers = scores
            .iter()
            .map(|z| student::cumulative(map(*z), f64::INFINITY));
        anderson_darling(&numbers.collect::<Vec<f64>>())
    };
    assert!(p(&|z| z) > 0.01);
    assert!(p(&|z| 1.1 * z) < 1e-3);
    assert!(p(&|z| z + 0.1) < 1e-3);
    assert!(p(&|z| 60.0 * z) < 1e-12);
}

#[test]
fn verdicts_are_three() {
    for (value, standard_error, tolerance, level, verdict) in [
        // t = 3.29 at 1e-3.
        (1e-4, 1e-4, 1e-3, 1e-3, Verdict::Pass),
        (8e-4, 1e-4, 1e-3, 1e-3, Verdict::Fail),
        (8e-4, 5e-4, 1e-3, 1e-3, Verdict::Inconclusive),
        // Surely there, and too small to matter.
        (4.9e-4, 1.6e-4, 1e-3, 0.01, Verdict::Pass),
        (4.9e-4, 1e-4, 5.5e-4, 0.01, Verdict::Fail),
    ] {
        let difference = Estimate {
            value,
            standard_error,
            freedom: f64::INFINITY,
        };
        let found = judge(&difference, tolerance, level);
        assert_eq!(found, verdict, "{difference}");
    }
}

/// A bias of the size that is said to be caught is caught that often.
#[test]
fn the_power_is_as_stated() {
    let mut random = generator(3);
    let (runs, level) = (20_000, 1e-3);
    let honest = Estimate {
        value: 0.0,
        standard_error: 1.0,
        freedom: f64::INFINITY,
    };
    let bias = honest.smallest_caught(level);
    let mut is_caught = || {
        let estimate = Estimate {
            value: bias + normal(&mut random),
            ..honest
        };
        judge(&estimate, bias, level) == Verdict::Fail
    };
    let caught = (0..runs).filter(|_| is_caught()).count();
    let share = caught as f64 / f64::from(runs);
    assert!((share - POWER).abs() < 0.005, "{share}");
}
