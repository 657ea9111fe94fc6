//! One picture to render: what, how much of it, and where to.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use etalon::{BinGrid, Instructions, MOST_SAMPLES, Plan, Scene};

use super::super::args::Render;
use super::super::error::CommandError;
use super::super::values::{Layer, SpectralRange};
use super::{is_stream, probe};

/// The bins of plain `--layers spectral`: the visible range as most tables have it.
const USUAL_BINS: SpectralRange = SpectralRange {
    from: 400.0,
    to: 700.0,
    step: 10.0,
};

/// One picture to render.
pub struct Job {
    /// What it is made of.
    pub render: etalon::Render,
    /// The OpenEXR file.
    pub output: PathBuf,
    /// The preview beside it; none beside a device or pipe.
    pub preview: Option<PathBuf>,
}

impl Job {
    /// Reads and plans.
    pub fn new(
        arguments: &Render,
        panel: Option<&str>,
        instructions: Instructions,
    ) -> Result<Self, CommandError> {
        let mut scene = Scene::load_with(&arguments.scene.scene, &arguments.overrides(panel))?;
        // With a wanted error pilots choose the samples, before the time counts.
        let open = arguments.time.is_some() && arguments.target_error.is_none();
        if open && !arguments.sets_spp() {
            if scene.image.sampler.needs_count() {
                return Err(CommandError::TimeForStrata);
            }
            scene.set_samples(MOST_SAMPLES);
        }
        let plan = Plan::new(&scene, arguments.plan.is_full())?;
        let mut render = etalon::Render::planned(scene, plan).with_layers(first(&arguments.layers));
        if let Some(crop) = arguments.crop {
            render = render.cropped(crop.0)?;
        }
        render.time = arguments.time.map(|time| time.0);
        render.instructions = instructions;
        render.spectral = bins(&arguments.layers)?;
        render.check_memory()?;
        let (output, preview) = paths(arguments, panel)?;
        Ok(Self {
            render,
            output,
            preview,
        })
    }

    /// Checks that both files can be written, before there is anything to lose.
    pub fn probe(&self) -> Result<(), CommandError> {
        probe(&self.output)?;
        self.preview.as_deref().map_or(Ok(()), probe)
    }
}

/// The layers about the first visible surface that are asked for.
fn first(layers: &[Layer]) -> impl Iterator<Item = etalon::Layer> {
    layers.iter().filter_map(|layer| match layer {
        Layer::FirstHit(layer) => Some(*layer),
        Layer::Spectral(_) => None,
    })
}

/// The spectral bins asked for; where several are, the last counts.
fn bins(layers: &[Layer]) -> Result<Option<BinGrid>, CommandError> {
    let asked = layers.iter().rev().find_map(|layer| match layer {
        Layer::Spectral(range) => Some(range.unwrap_or(USUAL_BINS)),
        Layer::FirstHit(_) => None,
    });
    asked
        .map(|range| Ok(BinGrid::new(range.from, range.to, range.step)?))
        .transpose()
}

/// The OpenEXR file and the preview.
fn paths(
    arguments: &Render,
    panel: Option<&str>,
) -> Result<(PathBuf, Option<PathBuf>), CommandError> {
    let output = match (&arguments.output, panel) {
        (None, panel) => {
            let stem = arguments.scene.scene.file_stem();
            let stem = stem.map_or_else(|| OsString::from("picture"), OsString::from);
            PathBuf::from(with_extension(with_panel(stem, panel), "exr"))
        }
        (Some(output), Some(panel)) if arguments.panel_is_all() => before_extension(output, panel),
        (Some(output), _) => output.clone(),
    };
    if output
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("png"))
    {
        return Err(CommandError::NotPng(output));
    }
    if is_same_file(&output, &arguments.scene.scene) {
        return Err(CommandError::OverScene(output));
    }
    let preview = (!is_stream(&output)).then(|| output.with_extension("png"));
    Ok((output, preview))
}

/// `stem` or `stem-panel`; a panel's name may hold what a file's may not.
fn with_panel(mut stem: OsString, panel: Option<&str>) -> OsString {
    if let Some(panel) = panel {
        stem.push("-");
        stem.push(panel.replace(|c: char| "/\\:".contains(c) || c.is_control(), "_"));
    }
    stem
}

/// `stem.extension`; the stem may hold dots of its own.
fn with_extension(mut stem: OsString, extension: impl AsRef<OsStr>) -> OsString {
    stem.push(".");
    stem.push(extension);
    stem
}

/// `directory/stem-panel.extension`.
fn before_extension(output: &Path, panel: &str) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_owned();
    let name = with_panel(stem, Some(panel));
    let name = match output.extension() {
        Some(extension) => with_extension(name, extension),
        None => name,
    };
    output.with_file_name(name)
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Checks that no two pictures go to the same file.
pub fn distinct(jobs: &[Job]) -> Result<(), CommandError> {
    for (index, job) in jobs.iter().enumerate() {
        if jobs[..index].iter().any(|other| other.output == job.output) && !is_stream(&job.output) {
            return Err(CommandError::SameOutput(job.output.clone()));
        }
    }
    Ok(())
}
