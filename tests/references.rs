//! Every scene with a committed reference, rendered and judged.
//!
//! Each question about a picture (image mean of each channel and band, mean of each material's
//! pixels) is passed only where the difference is *shown* to be within its tolerance, which is
//! computed beforehand from a pilot and printed; see [`crate::agreement`]. The whole family
//! raises a false alarm with probability below [`LEVEL`]. `ETALON_REFERENCE_SEED` draws other
//! samples.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::agreement::case::Case;
use crate::agreement::outcome::{Levels, Outcome, decide};
use crate::agreement::planned::{Paths, Planned, SHARP, plan};
use etalon::Side;
use etalon::inside::compare::stale::{Freshness, freshness};
use etalon::inside::film::names;
use etalon::inside::stats::estimate::POWER;
use statrs::distribution::{Binomial, DiscreteCDF};

/// Probability of a false alarm of all references together.
const LEVEL: f64 = 1e-3;
/// Camera paths per pixel of the pilots: enough to see the rare paths of `materials`, whose error would else
/// be underrated, and questions asked again with many more.
const PILOT: u32 = 1024;
/// Camera paths of the first round of a case at most: two minutes are shared by all.
const MOST: Paths = Paths {
    to_show: 24_000_000,
    to_sharpen: 240_000_000,
};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The committed references, by name.
fn references() -> Vec<(String, PathBuf)> {
    let entries = std::fs::read_dir(root().join("reference"));
    let paths = entries.into_iter().flatten().map(|e| e.unwrap().path());
    let name = |path: PathBuf| {
        let stem = path.file_stem().unwrap().to_string_lossy();
        (stem.into_owned(), path)
    };
    let pictures = paths.filter(|path| path.extension().is_some_and(|e| e == "exr"));
    let references: BTreeMap<String, PathBuf> = pictures.map(name).collect();
    references.into_iter().collect()
}

fn seed() -> u64 {
    let seed = std::env::var("ETALON_REFERENCE_SEED").ok();
    seed.map_or(1, |seed| seed.parse().unwrap())
}

#[test]
fn references_are_of_the_scenes_as_they_are() {
    let fresh = |path: &Path| freshness(&Side::read(path).unwrap(), root()) == Freshness::Fresh;
    let mut stale = references();
    stale.retain(|(_, path)| !fresh(path));
    let advice = "stale references, to be made again with tools/reference.py";
    assert!(stale.is_empty(), "{advice}: {stale:?}");
}

#[test]
fn every_reference_is_met() {
    let references = references();
    let cases = references.iter().map(|(name, path)| case(name, path));
    let cases: Vec<(Case, Side)> = cases.collect();
    // At most: what is black or unknown on one side is not asked.
    let most: usize = cases
        .iter()
        .map(|(case, reference)| reference.channels.len() + 3 * case.regions.len())
        .sum();
    let levels = Levels::shared(LEVEL, cases.len(), most);
    let plan = |(case, reference): (Case, Side)| {
        let pilot = case.render(PILOT, 1 << 32 | seed()).unwrap();
        let planned = plan(&case, (&pilot, PILOT), &reference, MOST, levels.question);
        (case, reference, planned)
    };
    let subjects: Vec<(Case, Side, Planned)> = cases.into_iter().map(plan).collect();
    let questions = subjects
        .iter()
        .map(|(_, _, planned)| planned.questions.len());
    let questions: usize = questions.sum();
    let mut wrong = Vec::new();
    let (mut open, mut blurred) = (0, Vec::new());
    for (index, (case, reference, planned)) in subjects.iter().enumerate() {
        let seed = |round: u32| seed() << 20 | (index as u64) << 4 | u64::from(round);
        let render = |spp, round| case.render(spp, seed(round));
        let outcome = decide(case, planned, reference, levels, render);
        let outcome = outcome.unwrap_or_else(|e| panic!("{e}"));
        println!(
            "{}: {:?} paths a pixel of {}x{}",
            case.name, outcome.samples, reference.width, reference.height
        );
        print!("{}", outcome.text(case));
        open += outcome.open();
        blurred.extend(blurred_means(&case.name, &outcome));
        if outcome.alarms() {
            wrong.push(case.name.clone());
        }
    }
    println!("{questions} questions, {open} stay open");
    assert!(blurred.is_empty(), "errors above {SHARP}: {blurred:?}");
    assert!(wrong.is_empty(), "shown to be off: {wrong:?}");
    let most = most_open(questions);
    assert!(open <= most, "{open} of {questions} stay open");
}

/// Image means of R, G, B whose difference has a larger standard error than is to be had.
fn blurred_means(name: &str, outcome: &Outcome) -> Vec<String> {
    let means = outcome.answers.iter().filter(|answer| {
        answer.question.region.is_none() && names::RGB.contains(&answer.question.channel.as_str())
    });
    means
        .map(|answer| (answer.difference.standard_error, &answer.question.channel))
        .filter(|(error, _)| *error > SHARP)
        .map(|(error, channel)| format!("{name} {channel}: {error:.1e}"))
        .collect()
}

/// Questions that may stay open. Each has a chance of at most 1 - [`POWER`]; three channels over
/// one place share their noise and count as one; more than this number have [`LEVEL`].
fn most_open(questions: usize) -> usize {
    let places = Binomial::new(1.0 - POWER, questions.div_ceil(3) as u64).unwrap();
    3 * places.inverse_cdf(1.0 - LEVEL) as usize
}

fn case(name: &str, path: &Path) -> (Case, Side) {
    let reference = Side::read(path).unwrap();
    let case =
        Case::of_reference(name, &reference, root()).unwrap_or_else(|e| panic!("{name}: {e}"));
    (case, reference)
}
