//! Commands: one file each, their arguments in [`args`].

mod args;
mod chart;
mod compare;
mod coverage;
mod info;
mod progress;
mod render;
mod replay;
mod study;
mod trace;
mod values;

use std::error::Error;
use std::ffi::OsString;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use etalon::inside::film::whole;
use etalon::{Origin, SceneError};
use rayon::ThreadPool;

use args::{Arguments, Command};

/// The result of a command that could be carried out.
enum Answer {
    /// Done, or yes.
    Good,
    No,
}

/// Why a command could not be carried out, in words for its user. What stdout refuses is an
/// [`io::Error`], and nothing else is.
type Failure = Box<dyn Error + Send + Sync>;

/// Exit code of a command that could not be carried out.
const COULD_NOT: u8 = 2;

pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(message) => return show(&message),
    };
    let answer = match &arguments.command {
        Command::Render(render) => render::run(render),
        Command::Info(info) => info::run(info),
        Command::Trace(trace) => trace::run(trace),
        Command::Replay(replay) => replay::run(replay),
        Command::Compare(compare) => compare::run(compare),
        Command::Study(study) => study::run(study),
        Command::Coverage(coverage) => coverage::run(coverage),
        Command::Chart(chart) => chart::run(chart),
    };
    let failure = match answer {
        Ok(Answer::Good) => return ExitCode::SUCCESS,
        Ok(Answer::No) => return ExitCode::FAILURE,
        Err(failure) => failure,
    };
    match failure.downcast_ref::<io::Error>() {
        // Whoever reads the output has seen enough.
        Some(reason) if reason.kind() == io::ErrorKind::BrokenPipe => return ExitCode::SUCCESS,
        Some(reason) => tell(&format!("error: cannot write the output: {reason}")),
        None => tell(&format!("error: {failure}")),
    }
    ExitCode::from(COULD_NOT)
}

/// Help and version go to stdout and are good, complaints about arguments to stderr.
fn show(message: &clap::Error) -> ExitCode {
    // Without a terminal or pipe to write to there is nobody to tell.
    let _ = message.print();
    if message.use_stderr() {
        ExitCode::from(COULD_NOT)
    } else {
        ExitCode::SUCCESS
    }
}

/// What is wrong with a scene; arguments are named as they are typed.
fn scene_words(error: &SceneError) -> String {
    let Some(diagnostic) = error.diagnostic() else {
        return error.to_string();
    };
    let mut diagnostic = diagnostic.clone();
    if !matches!(diagnostic.origin, Origin::File(_)) {
        diagnostic.origin = Origin::File(format!("--{}", diagnostic.origin));
    }
    diagnostic.to_string()
}

fn threads(count: Option<NonZeroUsize>) -> Result<ThreadPool, Failure> {
    // 0 stands for one a thread of the machine.
    let count = count.map_or(0, NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
    Ok(pool.map_err(|reason| format!("cannot start the threads: {reason}"))?)
}

/// A word quoted for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// Prints lines to stdout.
fn say(text: &str) -> Result<(), Failure> {
    let mut output = io::stdout().lock();
    writeln!(output, "{text}")?;
    Ok(output.flush()?)
}

/// Prints a line to stderr; a closed stderr is no reason to stop.
fn tell(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Writes a file, whole or not at all.
fn write(path: &Path, content: &str) -> Result<(), Failure> {
    Ok(whole::write(path, |file| {
        file.write_all(content.as_bytes())
    })?)
}
