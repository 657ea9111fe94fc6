//! Checks the intervals of etalon as built here, on every instruction set of this machine: the
//! arithmetic by exact numbers, the functions against 192 bits.

mod arithmetic;
mod exact;
mod functions;
mod random;
mod rays;

use std::process::ExitCode;

use arithmetic::Report;
use clap::Parser;
use etalon::Instructions;
use etalon_doors::intervals::{Function, Operation};
use rayon::prelude::*;

/// Intervals of one piece of work.
const PIECE: u64 = 1 << 14;

/// Exit codes: 0 sound, 1 not.
#[derive(Debug, Parser)]
struct Arguments {
    /// Random intervals for each of + − × ÷ √.
    #[arg(long, default_value_t = 100_000_000)]
    arithmetic: u64,
    /// Random intervals for each function.
    #[arg(long, default_value_t = 1_000_000)]
    functions: u64,
    /// Random rays for each of some general expressions.
    #[arg(long, default_value_t = 10_000)]
    rays: u64,
    /// Which random intervals and rays.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Leave out the rounding outward: the check must fail.
    #[arg(long)]
    unsound: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let names: Vec<&str> = Instructions::all().iter().map(|i| i.name()).collect();
    println!("instruction sets: {}", names.join(", "));
    let mut sound = true;
    for &operation in Operation::ALL {
        let unsound = arguments.unsound;
        let check = |seed, count| Some(arithmetic::check(operation, seed, count, unsound));
        let report = over(&arguments, arguments.arithmetic, check);
        sound &= told(&format!("{operation:?}"), &report);
    }
    for &function in Function::ALL {
        let check = |seed, count| functions::check(function, seed, count, arguments.unsound);
        let report = over(&arguments, arguments.functions, check);
        sound &= told(&format!("{function:?}"), &report);
    }
    if arguments.rays > 0 && !arguments.unsound {
        sound &= rays::check(arguments.rays, arguments.seed);
    }
    println!("{}", if sound { "sound" } else { "NOT SOUND" });
    ExitCode::from(u8::from(!sound))
}

/// All pieces of a check together; a piece that cannot be done counts as violated.
fn over(
    arguments: &Arguments,
    count: u64,
    check: impl Fn(u64, usize) -> Option<Report> + Sync,
) -> Report {
    let failed = || Report {
        violated: 1,
        example: Some("the reference could not be set up".to_owned()),
        ..Report::default()
    };
    (0..count.div_ceil(PIECE))
        .into_par_iter()
        .map(|piece| {
            let seed = arguments.seed << 40 | piece;
            check(seed, PIECE as usize).unwrap_or_else(failed)
        })
        .reduce(Report::default, Report::joined)
}

fn told(name: &str, report: &Report) -> bool {
    let example = report.example.as_ref().map(|e| format!("; {e}"));
    println!(
        "{name}: {} checked, {} violated, {} batches with different bits{}",
        report.checked,
        report.violated,
        report.different,
        example.unwrap_or_default()
    );
    report.is_good()
}
