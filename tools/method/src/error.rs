//! Why a command could not be carried out.

use std::io;
use std::path::PathBuf;

use etalon_method::finders::OracleError;

/// Why a command could not be carried out; `Display` is what the user sees.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// A table cannot be read.
    #[error("error: cannot read {}: {reason}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A result cannot be written.
    #[error("error: cannot write {}: {reason}", path.display())]
    Result {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The rays or surfaces cannot be used.
    #[error("error: {0}")]
    Oracle(#[from] OracleError),
    /// There is no such surface to paint.
    #[error("error: --map: there is no surface \"{name}\"; there are {known}")]
    Surface {
        /// As it was asked for.
        name: String,
        /// All there are.
        known: String,
    },
    /// Standard output cannot be written to.
    #[error("error: cannot write the output: {0}")]
    Output(io::Error),
}
