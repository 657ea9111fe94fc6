//! `etalon-method finders`: the root finders of implicit surfaces, compared.

use std::io::{Error, Write as _};
use std::path::{Path, PathBuf};

use etalon_method::failures;
use etalon_method::finders::chart::{ChartError, csv, svg};
use etalon_method::finders::map::map;
use etalon_method::finders::{
    CONTESTANTS, Contestant, Oracle, OracleError, Result as Outcome, run as run_one,
};

use super::args::Finders;
use super::tell;

/// Why a command could not be carried out; `Display` is what the user sees.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// A table cannot be read, or a result not written: what, which file, why.
    #[error("error: cannot {} {}: {}", .0, .1.display(), .2)]
    File(&'static str, PathBuf, String),
    #[error("error: {0}")]
    Oracle(#[from] OracleError),
    #[error("error: --map: there is no surface \"{name}\"; there are {known}")]
    Surface { name: String, known: String },
    #[error("error: cannot write the output: {0}")]
    Output(Error),
}

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
    write_chart(&picture, failures::chart::svg(&points))?;
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
    write_chart(&picture, svg(&results))?;
    say(&summary(&results))?;
    let right = |result: &Outcome| !result.contestant.is_proved() || result.all().wrong == 0;
    Ok(results.iter().all(right))
}

fn paint(arguments: &Finders, oracle: &Oracle, name: &str) -> Result<bool, CommandError> {
    let unknown = || {
        let known = oracle.shapes.iter().map(|shape| shape.name.as_str());
        CommandError::Surface {
            name: name.to_owned(),
            known: known.collect::<Vec<_>>().join(", "),
        }
    };
    let shape = oracle.shape(name).ok_or_else(unknown)?;
    let path = arguments.output.join(format!("finders-{name}.png"));
    let Some((picture, counts)) = map(shape, arguments.size) else {
        return Err(failed("write", &path)("the surface cannot be placed"));
    };
    prepare(&path)?;
    picture.save(&path).map_err(failed("write", &path))?;
    let mut text = String::from("finder,precision,steps,wrong,undecided\n");
    for (contestant, count) in &counts {
        let (name, precision) = (contestant.name(), contestant.precision().name());
        let (steps, wrong, undecided) = (contestant.steps(), count.wrong, count.undecided);
        text += &format!("{name},{precision},{steps},{wrong},{undecided}\n");
    }
    say(&text)?;
    let mut counts = counts.iter();
    Ok(counts.all(|(contestant, count)| !contestant.is_proved() || count.wrong == 0))
}

fn described(contestant: Contestant) -> String {
    let name = contestant.name();
    match contestant {
        Contestant::SignChange(precision, steps) => {
            format!("{name} in {}, {steps} steps", precision.name())
        }
        Contestant::Proved(_) => name.to_owned(),
    }
}

fn summary(results: &[Outcome]) -> String {
    let mut text = String::new();
    for result in results {
        let all = result.all();
        text += &format!(
            "{:38} wrong {:5} undecided {:5} of {}, {:10.0} ns a ray\n",
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

/// The error of what was to be done to a file.
fn failed<E: ToString>(what: &'static str, path: &Path) -> impl FnOnce(E) -> CommandError {
    move |error| CommandError::File(what, path.to_owned(), error.to_string())
}

fn read(path: &Path) -> Result<String, CommandError> {
    std::fs::read_to_string(path).map_err(failed("read", path))
}

/// Makes the directory of a file.
fn prepare(path: &Path) -> Result<(), CommandError> {
    let parent = path.parent().map(PathBuf::from).unwrap_or_default();
    if parent.as_os_str().is_empty() {
        return Ok(());
    }
    std::fs::create_dir_all(&parent).map_err(failed("write", &parent))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), CommandError> {
    prepare(path)?;
    std::fs::write(path, bytes).map_err(failed("write", path))
}

fn write_chart(path: &Path, drawn: Result<String, ChartError>) -> Result<(), CommandError> {
    write(path, drawn.map_err(failed("write", path))?.as_bytes())
}
