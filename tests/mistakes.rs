//! The statistical suite notices mistakes: those that `cargo bench --bench mistakes` plants, in a few
//! runs each.

#[path = "../tools/mistakes/planted.rs"]
mod planted;
#[path = "../tools/mistakes/scenes.rs"]
mod scenes;
#[path = "../tools/mistakes/suite.rs"]
mod suite;

use planted::MISTAKES;
use suite::Suite;

/// Runs of each kind. A mistake that is missed once in a hundred runs would fail here 1.6 times in a
/// hundred; seeds are fixed.
const RUNS: u64 = 2;

#[test]
fn planted_mistakes_are_caught() {
    let suite = Suite::new();
    print!("{}", suite.text());
    for (place, &(mistake, words)) in MISTAKES.iter().enumerate() {
        for run in 0..RUNS {
            let run = suite.run(Some(mistake), (place as u64 + 1) << 20 | run);
            assert!(run.planted > 0, "there was no place for {words}");
            assert!(!run.alarms.is_empty(), "{words}: missed ({run:?})");
        }
    }
    for seed in 0..RUNS {
        let run = suite.run(None, seed);
        assert!(run.alarms.is_empty(), "a false alarm: {run:?}");
    }
}
