//! Why a command could not be carried out.

use std::io;
use std::path::PathBuf;

use etalon::{
    BinError, CompareError, Origin, Outside, PictureError, PlanError, SceneError, Singular,
    TooLarge,
};

use super::trace::RayError;

/// Why a command could not be carried out; `Display` is what the user sees.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// The scene cannot be had.
    #[error("error: {}", scene_words(.0))]
    Scene(#[from] SceneError),
    /// The rays cannot be had.
    #[error(transparent)]
    Rays(#[from] RayError),
    /// An object's matrix has no inverse.
    #[error("error: {0}")]
    Singular(#[from] Singular),
    /// A table cannot be read.
    #[error("error: cannot read {}: {reason}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The scene cannot be carried out.
    #[error("error: {0}")]
    Plan(#[from] PlanError),
    /// Pictures cannot be compared.
    #[error("error: {}", compare_words(.0))]
    Compare(#[from] CompareError),
    /// Pictures of different scenes: how they differ, and which of them is stale.
    #[error("error: {0}{sep}{1}", sep = if .1.is_empty() { "" } else { "; " })]
    Scenes(String, String),
    /// No verdict on two pictures.
    #[error("error: no verdict: {0}")]
    NoVerdict(String),
    /// A picture cannot be written.
    #[error("error: {0}")]
    Film(#[from] PictureError),
    /// The spectral bins cannot be had.
    #[error("error: --layers spectral: {0}")]
    Bins(#[from] BinError),
    /// The crop reaches out of the picture.
    #[error("error: the crop {0}")]
    Crop(#[from] Outside),
    /// The picture does not fit into memory.
    #[error("error: {0}: use a smaller --size, a --crop or fewer spectral bins")]
    Memory(#[from] TooLarge),
    /// `--panel all` without panels.
    #[error("error: {} has no panels", .0.display())]
    NoPanels(PathBuf),
    /// Two pictures for one file.
    #[error("error: two panels would be written to {}", .0.display())]
    SameOutput(PathBuf),
    /// The preview would replace the picture.
    #[error(
        "error: cannot write the picture to {}: it is OpenEXR, and the preview beside it is the \
         PNG; name the output .exr", .0.display()
    )]
    NotPng(PathBuf),
    /// The picture would replace the scene.
    #[error("error: cannot write the picture to {}: that is the scene file", .0.display())]
    OverScene(PathBuf),
    /// Strata need a planned number of samples.
    #[error(
        "error: --time needs --spp with the sampler \"stratified\": its strata are cut for a planned \
         number of samples (sobol and independent need none)"
    )]
    TimeForStrata,
    /// The threads cannot be had.
    #[error("error: cannot start the threads: {0}")]
    Threads(String),
    /// The result could not be written.
    #[error("error: cannot write the output: {0}")]
    Output(io::Error),
    /// A study cannot be carried out or shown.
    #[error("error: {0}")]
    Study(String),
    /// An argument that does not fit the scene.
    #[error("error: {0}")]
    Arguments(String),
}

/// What a scene complains of; arguments are called as they are typed.
pub fn scene_words(error: &SceneError) -> String {
    let Some(diagnostic) = error.diagnostic() else {
        return error.to_string();
    };
    let mut diagnostic = diagnostic.clone();
    if !matches!(diagnostic.origin, Origin::File(_)) {
        diagnostic.origin = Origin::File(format!("--{}", diagnostic.origin));
    }
    diagnostic.to_string()
}

/// Why pictures cannot be compared, and what to type.
fn compare_words(error: &CompareError) -> String {
    match error {
        CompareError::NotFinite { .. } => {
            format!("{error}: render it again, or find out with etalon replay where they come from")
        }
        CompareError::Sizes { .. } => format!("{error} (etalon render --size)"),
        other => other.to_string(),
    }
}
