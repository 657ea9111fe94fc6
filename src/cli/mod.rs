//! Commands: one file each, their arguments in [`args`].

mod args;
mod chart;
mod compare;
mod coverage;
mod error;
mod info;
mod render;
mod replay;
mod study;
mod trace;
mod values;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};
use error::CommandError;

/// What a command that could be carried out has to say.
enum Answer {
    /// Done, or yes.
    Good,
    /// The answer is no.
    No,
}

/// Exit code of a command that could not be carried out.
const COULD_NOT: u8 = 2;

/// Runs the command that the arguments ask for.
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
    match answer {
        Ok(Answer::Good) => ExitCode::SUCCESS,
        Ok(Answer::No) => ExitCode::FAILURE,
        Err(CommandError::Output(reason)) if reason.kind() == std::io::ErrorKind::BrokenPipe => {
            // Whoever reads the output has seen enough.
            ExitCode::SUCCESS
        }
        Err(error) => {
            tell(&error.to_string());
            ExitCode::from(COULD_NOT)
        }
    }
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

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// A line on stderr; a closed stderr is no reason to stop.
fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
