//! `etalon-method finders`: the root finders of implicit surfaces, compared.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use etalon_method::failures;
use etalon_method::finders::chart::{csv, svg};
use etalon_method::finders::map::map;
use etalon_method::finders::{CONTESTANTS, Contestant, Oracle, Result as Outcome, run as run_one};

use super::args::Finders;
use super::error::CommandError;
use super::tell;

/// Charts all finders, or maps one surface; whether those that prove their answers were right.
pub fn run(arguments: &Finders) -> Result<bool, CommandError> {
    if arguments.failures {
        return failures(arguments);
    }
    let rays = arguments.rays.as_deref().map(read).transpose()?;
    let shapes = arguments.shapes.as_deref().map(read).transpose()?;
    let oracle = Oracle::new(rays.as_deref(), shapes.as_deref())?;
    match &arguments.map {
        Some(name) => paint(arguments, &oracle, name),
        None => chart(arguments, &oracle),
    }
}

/// Maps where each method fails.
fn failures(arguments: &Finders) -> Result<bool, CommandError> {
    let points = failures::run(arguments.count as usize, |subject, family| {
        if !arguments.quiet {
            tell(&format!("running {}, {}", subject.name(), family.name()));
        }
    });
    let table = failures::chart::csv(&points);
    write(&arguments.output.join("failures.csv"), table.as_bytes())?;
    let picture = arguments.output.join("failures.svg");
    let drawn = failures::chart::svg(&points).map_err(|error| CommandError::Result {
        path: picture.clone(),
        reason: error.to_string(),
    })?;
    write(&picture, drawn.as_bytes())?;
    say(&failures::summary(&points))?;
    Ok(points.iter().all(failures::Point::is_safe))
}

fn chart(arguments: &Finders, oracle: &Oracle) -> Result<bool, CommandError> {
    let mut results = Vec::new();
    for contestant in CONTESTANTS {
        if !arguments.quiet {
            tell(&format!("running {}", described(contestant)));
        }
        results.push(run_one(contestant, oracle));
    }
    let table = arguments.output.join("finders.csv");
    write(&table, csv(&results).as_bytes())?;
    let picture = arguments.output.join("finders.svg");
    let drawn = svg(&results).map_err(|error| CommandError::Result {
        path: picture.clone(),
        reason: error.to_string(),
    })?;
    write(&picture, drawn.as_bytes())?;
    say(&summary(&results))?;
    Ok(results.iter().all(|result| {
        !matches!(result.contestant, Contestant::Proved(_)) || result.all().wrong == 0
    }))
}

fn paint(arguments: &Finders, oracle: &Oracle, name: &str) -> Result<bool, CommandError> {
    let unknown = || CommandError::Surface {
        name: name.to_owned(),
        known: oracle
            .shapes
            .iter()
            .map(|shape| shape.name.as_str())
            .collect::<Vec<_>>()
            .join(", "),
    };
    let shape = oracle.shape(name).ok_or_else(unknown)?;
    let path = arguments.output.join(format!("finders-{name}.png"));
    let failed = |reason: String| CommandError::Result {
        path: path.clone(),
        reason,
    };
    let Some((picture, counts)) = map(shape, arguments.size) else {
        return Err(failed("the surface cannot be placed".to_owned()));
    };
    prepare(&path)?;
    picture.save(&path).map_err(|e| failed(e.to_string()))?;
    let mut text = String::from("finder,precision,steps,wrong,undecided\n");
    for count in &counts {
        let contestant = count.contestant;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{}",
            contestant.name(),
            contestant.precision(),
            contestant
                .steps()
                .map(|s| s.to_string())
                .unwrap_or_default(),
            count.wrong,
            count.undecided
        );
    }
    say(&text)?;
    Ok(counts
        .iter()
        .all(|count| !matches!(count.contestant, Contestant::Proved(_)) || count.wrong == 0))
}

fn described(contestant: Contestant) -> String {
    match contestant.steps() {
        Some(steps) => format!(
            "{} in {}, {steps} steps",
            contestant.name(),
            contestant.precision()
        ),
        None => contestant.name().to_owned(),
    }
}

/// The results over all classes as a table for people.
fn summary(results: &[Outcome]) -> String {
    let mut text = String::new();
    for result in results {
        let all = result.all();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:38} wrong {:5} undecided {:5} of {}, {:10.0} ns a ray",
            described(result.contestant),
            all.wrong,
            all.undecided,
            all.rays,
            all.nanoseconds_a_ray()
        );
    }
    text
}

fn say(text: &str) -> Result<(), CommandError> {
    let mut output = std::io::stdout().lock();
    output
        .write_all(text.as_bytes())
        .and_then(|()| output.flush())
        .map_err(CommandError::Output)
}

fn read(path: &Path) -> Result<String, CommandError> {
    std::fs::read_to_string(path).map_err(|error| CommandError::Table {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

/// Makes the directory of a file.
fn prepare(path: &Path) -> Result<(), CommandError> {
    let parent = path.parent().map(PathBuf::from).unwrap_or_default();
    if parent.as_os_str().is_empty() {
        return Ok(());
    }
    std::fs::create_dir_all(&parent).map_err(|error| CommandError::Result {
        path: parent,
        reason: error.to_string(),
    })
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), CommandError> {
    prepare(path)?;
    std::fs::write(path, bytes).map_err(|error| CommandError::Result {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}
