//! The command line of the instruments about methods: arguments in, exit code out.
//!
//! Exit codes: 0 the command did what it was asked to do, 1 a finder that proves its answers was wrong,
//! 2 it could not be done; the reason is on stderr.

mod args;
mod command;

use std::io::{ErrorKind, Write as _};
use std::process::ExitCode;

use clap::Parser as _;

use args::{Arguments, Command};
use command::CommandError;

/// Exit code of a command that could not be carried out.
const COULD_NOT: u8 = 2;

fn main() -> ExitCode {
    let Arguments {
        command: Command::Finders(finders),
    } = Arguments::parse();
    match command::run(&finders) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        // Whoever reads the output has seen enough.
        Err(CommandError::Output(reason)) if reason.kind() == ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(error) => {
            tell(&error.to_string());
            ExitCode::from(COULD_NOT)
        }
    }
}

/// A line on stderr; a closed stderr is no reason to stop.
fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
