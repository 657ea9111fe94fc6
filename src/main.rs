//! The command line of etalon: arguments in, exit code out.
//!
//! Exit codes: 0 the command did what it was asked to do, 1 the answer to a yes-or-no question is
//! no, 2 it could not be done (wrong arguments, unreadable files, invalid scenes); the reason is
//! on stderr.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run(std::env::args_os())
}
