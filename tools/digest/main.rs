//! Are the bits of every picture, and what the plan chooses, as they were? Renders every panel of
//! every scene small, in each precision with each instruction set of the machine, hashes the
//! pixels, and compares with the tables beside this file.
//!
//! Errors are sentences, with what etalon said.
//!
//!     cargo bench --bench digest
//!     cargo bench --bench digest -- --binary another/etalon --only fig7

mod binary;
mod pictures;
mod plan;
mod scenes;
mod table;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use binary::Binary;
use clap::Parser;
use pictures::Hashes;
use rayon::prelude::*;
use table::Table;

/// Exit codes: 0 the same as in the tables, 1 not, 2 a picture could not be made.
#[derive(Debug, Parser)]
struct Arguments {
    /// The etalon that renders.
    #[arg(long, default_value = env!("CARGO_BIN_EXE_etalon"))]
    binary: PathBuf,
    /// Only scenes that contain one of these in their path or, after a space, their panel.
    #[arg(long, num_args = 1.., conflicts_with = "write")]
    only: Vec<String>,
    /// Write the tables instead of comparing with them.
    #[arg(long)]
    write: bool,
    /// What `cargo bench` says to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::from(2)
        }
    }
}

/// Whether everything is as the tables say.
fn run(arguments: &Arguments) -> Result<bool, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let wanted = |key: &[String]| {
        let name = key.join(" ");
        arguments.only.is_empty() || arguments.only.iter().any(|part| name.contains(part))
    };
    let variants = scenes::variants(root, wanted)?;
    let binary = Binary::new(&arguments.binary, root)?;
    let start = Instant::now();
    let plans = variants
        .par_iter()
        .map(|variant| plan::row(&binary, variant));
    let plans: Vec<_> = plans.collect::<Result<_, _>>()?;
    let jobs: Vec<_> = variants.iter().flat_map(pictures::jobs).collect();
    let hashes = jobs.par_iter().map(|job| job.hashes(&binary));
    let hashes: Vec<_> = hashes.collect::<Result<_, _>>()?;
    println!(
        "{} plans and {} pictures in {:.0} s; instruction sets: {}",
        plans.len(),
        jobs.len(),
        start.elapsed().as_secs_f64(),
        binary.sets.join(", ")
    );
    if arguments.write
        && let Some((job, torn)) = jobs.iter().zip(&hashes).find(|(_, h)| !h.agree())
    {
        return Err(format!("{job:?}: instruction sets differ: {torn}"));
    }
    let pixels = jobs.iter().zip(&hashes);
    let pixels = pixels.map(|(job, hashes)| job.row(hashes)).collect();
    let mut same = hashes.iter().all(Hashes::agree);
    for (kind, rows) in [(&pictures::TABLE, pixels), (&plan::TABLE, plans)] {
        let made = Table::new(kind, rows);
        let path = root.join("tools/digest").join(kind.file);
        if arguments.write {
            made.write(&path)?;
            continue;
        }
        for difference in made.differences(&Table::read(kind, &path, wanted)?) {
            println!("{}: {difference}", kind.file);
            same = false;
        }
    }
    Ok(same)
}
