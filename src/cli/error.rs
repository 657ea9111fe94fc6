//! Why a command could not be carried out.

use std::io;
use std::path::PathBuf;

use etalon::compare::CompareError;
use etalon::film;
use etalon::plan::PlanError;
use etalon::render::bins::BinError;
use etalon::render::target::Singular;
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
    #[error("error: {0}")]
    Compare(#[from] CompareError),
    /// Pictures of different scenes: how they differ, and which of them is stale.
    #[error("error: {0}{sep}{1}", sep = if .1.is_empty() { "" } else { "; " })]
    Scenes(String, String),
    /// No verdict on two pictures.
    #[error("error: no verdict: {0}")]
    NoVerdict(String),
    /// A picture cannot be written.
    #[error("error: {0}")]
    Film(#[from] film::Error),
    /// The spectral bins cannot be had.
    #[error("error: --layers spectral: {0}")]
    Bins(#[from] BinError),
    /// The crop reaches out of the picture.
    #[error(
        "error: the crop {},{},{},{} is not inside the picture of {}x{} pixels",
        from[0], from[1], to[0], to[1], size[0], size[1]
    )]
    Crop {
        /// Its upper left corner.
        from: [u32; 2],
        /// The pixel after its lower right corner.
        to: [u32; 2],
        /// The picture.
        size: [u32; 2],
    },
    /// The picture does not fit into memory.
    #[error(
        "error: the picture needs about {} MiB of memory, and {} MiB are available: use a smaller \
         --size, a --crop or fewer spectral bins",
        needed >> 20, available >> 20
    )]
    Memory {
        /// Bytes of the render.
        needed: u64,
        /// Bytes of the machine.
        available: u64,
    },
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
    /// The machine does not have these instructions.
    #[error("error: this machine has no {0} instructions")]
    Instructions(&'static str),
    /// The threads cannot be had.
    #[error("error: cannot start the threads: {0}")]
    Threads(String),
    /// The result could not be written.
    #[error("error: cannot write the output: {0}")]
    Output(io::Error),
    /// A study cannot be carried out or shown.
    #[error("error: {}", .0.trim_start_matches("error: "))]
    Study(String),
    /// An argument that does not fit the scene.
    #[error("error: {0}")]
    Arguments(String),
}
