//! Radiance that is known on paper, through the whole renderer.
//!
//! `tests/data/truths.json` holds families of set-ups with their parameters and exact answers.
//! Every family is a function of its parameters: it builds the scenes, says which number of the
//! file each one must give, and works the closed form out once more where that is short. The
//! environment variable `ETALON_TRUTHS` names another file of the same form.

mod cameras;
mod furnaces;
mod glass;
mod harness;
mod lights;
mod robust;
mod scenes;
mod white;

use std::sync::OnceLock;

use harness::{CLOSE, Case, Measurement, Shown, judge, measure_all, show};
use rayon::prelude::*;

/// The file's numbers have at least nine digits.
#[track_caller]
fn agree(own: f64, exact: f64) {
    let error = (own - exact).abs();
    assert!(
        error <= 1e-8 * exact.abs().max(1e-3),
        "the closed form gives {own}, the file says {exact}"
    );
}

/// All numbers with what was measured for them, once for all tests.
fn measured() -> &'static [(Case, Measurement)] {
    static MEASURED: OnceLock<Vec<(Case, Measurement)>> = OnceLock::new();
    MEASURED.get_or_init(|| measure_all(cases()))
}

fn cases() -> Vec<Case> {
    let families = [
        furnaces::cases(),
        lights::cases(),
        glass::cases(),
        cameras::cases(),
        white::cases(),
    ];
    families.into_iter().flatten().collect()
}

#[test]
fn every_truth_is_met() {
    let measured = measured();
    println!(
        "{:<58} {:>14} {:>14} {:>10} {:>7}",
        "number", "truth", "estimate", "rel. SE", "z"
    );
    for (case, m) in measured {
        println!(
            "{:<58} {:>14.8} {:>14.8} {:>10.1e} {:>7.2} {:>9}",
            case.name,
            case.truth,
            m.estimate.value,
            m.estimate.standard_error / case.truth,
            m.estimate.score(case.truth),
            m.samples,
        );
    }
    let within = |share: f64| {
        let near = |(case, m): &&(Case, Measurement)| {
            (m.estimate.value - case.truth).abs() <= share * case.truth.abs()
        };
        measured.iter().filter(near).count()
    };
    println!(
        "{} numbers, {} of them within 0.02 % of the truth and {} within 0.1 %",
        measured.len(),
        within(2e-4),
        within(1e-3)
    );
    let wide: Vec<&str> = measured
        .iter()
        .filter(|(case, m)| m.estimate.standard_error > harness::LARGEST_ERROR * case.truth)
        .map(|(case, _)| case.name.as_str())
        .collect();
    assert!(wide.is_empty(), "not measured sharply enough: {wide:?}");
    let rejected = judge(measured.iter().map(|(case, m)| (case, m)), 1.0);
    assert!(rejected.is_empty(), "rejected: {rejected:#?}");
}

/// The 95 % confidence interval of each number lies within 0.02 % of the truth: where it does not, fresh
/// and more samples are drawn, up to three times. What is off by 0.02 % passes once in forty rounds; of all
/// together, none is rejected at the level of the usual run.
#[test]
#[ignore = "takes 25 minutes on two cores"]
fn every_truth_is_met_within_two_hundredths_of_a_per_cent() {
    let cases = cases();
    let count = cases.len();
    let numbers: Vec<(Case, Shown)> = cases
        .into_par_iter()
        .enumerate()
        .map(|(place, case)| {
            let shown = show(&case, place);
            let m = shown.measurement;
            println!(
                "{:<58} {:>+9.5} % ± {:.5} %, {} in round {} with {} paths",
                case.name,
                100.0 * (m.estimate.value / case.truth - 1.0),
                100.0 * m.estimate.standard_error / case.truth,
                if shown.close { "close" } else { "open" },
                shown.round,
                m.samples,
            );
            (case, shown)
        })
        .collect();
    let open: Vec<&str> = numbers
        .iter()
        .filter(|(_, shown)| !shown.close)
        .map(|(case, _)| case.name.as_str())
        .collect();
    println!(
        "{} of {count} numbers are within {} % of the truth, confidence intervals included",
        count - open.len(),
        100.0 * CLOSE,
    );
    let judged = numbers.iter().map(|(case, s)| (case, &s.measurement));
    let rejected = judge(judged, 1.0);
    assert!(rejected.is_empty(), "rejected: {rejected:#?}");
    assert!(open.is_empty(), "not shown to be within: {open:?}");
}

/// Half a per cent of bias in any one number is seen, in either direction.
#[test]
fn half_a_per_cent_is_not_met() {
    let measured = measured();
    for bias in [0.995, 1.005] {
        let rejected = judge(measured.iter().map(|(case, m)| (case, m)), bias);
        let missed: Vec<&str> = measured
            .iter()
            .map(|(case, _)| case.name.as_str())
            .filter(|name| !rejected.iter().any(|r| r.starts_with(name)))
            .collect();
        let seen = missed.is_empty();
        assert!(seen, "a factor of {bias} was not seen: {missed:?}");
    }
}
