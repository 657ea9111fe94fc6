//! Why a command could not be carried out.

use std::io;

use etalon::scene::SceneError;

use super::trace::RayError;

/// Why a command could not be carried out; `Display` is what the user sees.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// The scene cannot be had.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The rays cannot be had.
    #[error(transparent)]
    Rays(#[from] RayError),
    /// An object's matrix has no inverse.
    #[error("error: the object \"{name}\" has a transform that is not invertible")]
    Singular {
        /// The object.
        name: String,
    },
    /// The result could not be written.
    #[error("error: cannot write the output: {0}")]
    Output(io::Error),
    /// Not part of this build.
    #[error("error: {0} is not available yet")]
    NotAvailable(&'static str),
}
