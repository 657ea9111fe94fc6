//! Would the statistical suite notice? Plants each mistake in many runs with fresh seeds, runs it
//! honestly many times more, and prints what was caught.
//!
//!     cargo bench --bench mistakes -- --runs 100 --honest 1000

#[path = "../../tests/agreement/mod.rs"]
#[allow(dead_code, reason = "shared with the tests, which ask more of it")]
mod agreement;
mod planted;
mod scenes;
mod suite;

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use planted::MISTAKES;
use suite::{LEVEL, Run, Suite};

/// Exit codes: 0 all is as it should be, 1 not.
#[derive(Debug, Parser)]
struct Arguments {
    /// Runs with each mistake.
    #[arg(long, default_value_t = 100)]
    runs: u64,
    /// Runs without any.
    #[arg(long, default_value_t = 1000)]
    honest: u64,
    /// Which random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// What `cargo bench` says to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Alarms that honest runs may raise for each thousand: one is expected at most, and more than three
/// happen with a probability of 2 %.
const HONEST_ALARMS: u64 = 3;
/// Share of the runs in which a mistake must be caught.
const CAUGHT: f64 = 0.99;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let start = Instant::now();
    let suite = Suite::new();
    println!(
        "reduced suite, level {LEVEL}, planned in {:.1} s:",
        start.elapsed().as_secs_f64()
    );
    print!("{}", suite.text());
    let mut good = true;
    println!("\n| planted mistake | caught | standard errors, median | by |\n|---|---|---|---|");
    for (place, &(mistake, words)) in MISTAKES.iter().enumerate() {
        let seed = |run: u64| arguments.seed << 32 | (place as u64 + 1) << 20 | run;
        let runs: Vec<Run> = (0..arguments.runs)
            .map(|run| suite.run(Some(mistake), seed(run)))
            .collect();
        let caught = runs.iter().filter(|run| !run.alarms.is_empty()).count();
        let mut scores: Vec<f64> = runs.iter().map(|run| run.score).collect();
        scores.sort_by(f64::total_cmp);
        let by = runs.iter().max_by_key(|run| run.alarms.len());
        println!(
            "| {words} | {caught} of {} | {:.0} | {} |",
            arguments.runs,
            scores.get(scores.len() / 2).copied().unwrap_or(f64::NAN),
            by.map_or(String::new(), |run| run.alarms.join(", ")),
        );
        let planted = runs.iter().all(|run| run.planted > 0);
        good &= planted && caught as f64 >= CAUGHT * arguments.runs as f64;
    }
    let start = Instant::now();
    let (mut alarms, mut open) = (0, 0);
    for run in 0..arguments.honest {
        let run = suite.run(None, arguments.seed << 32 | run);
        if !run.alarms.is_empty() {
            alarms += 1;
            eprintln!("an honest run raised an alarm: {}", run.alarms.join(", "));
        }
        open += run.open;
    }
    println!(
        "\n{} honest runs, both sides drawn afresh: {alarms} alarms, {open} questions left open, {:.2} s a run",
        arguments.honest,
        start.elapsed().as_secs_f64() / arguments.honest.max(1) as f64
    );
    good &= alarms * 1000 <= HONEST_ALARMS * arguments.honest.max(1000);
    ExitCode::from(u8::from(!good))
}
