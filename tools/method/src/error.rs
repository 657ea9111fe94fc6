//! Why a command could not be carried out.

use std::io;
use std::path::PathBuf;

use etalon_method::finders::OracleError;

/// Why a command could not be carried out; `Display` is what the user sees.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// A table cannot be read, or a result not written: what, which file, why.
    #[error("error: cannot {} {}: {}", .0, .1.display(), .2)]
    File(&'static str, PathBuf, String),
    /// The rays or surfaces cannot be used.
    #[error("error: {0}")]
    Oracle(#[from] OracleError),
    /// There is no such surface to paint.
    #[error("error: --map: there is no surface \"{name}\"; there are {known}")]
    Surface { name: String, known: String },
    /// Standard output cannot be written to.
    #[error("error: cannot write the output: {0}")]
    Output(io::Error),
}
