//! One picture to render: what, how much of it, and where to.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use etalon::plan::Plan;
use etalon::render::bins::BinGrid;
use etalon::render::tile::Window;
use etalon::scene::{self, Scene};

use super::super::args::Render;
use super::super::error::CommandError;
use super::super::values::Crop;
use super::{is_stream, layers, memory, probe};

/// Samples a pixel at most where only the time is limited: as many as the samplers' points.
pub const MOST_SAMPLES: u32 = 1 << 24;

/// One picture to render.
pub struct Job {
    /// The scene.
    pub scene: Scene,
    /// What is done about it.
    pub plan: Plan,
    /// The pixels wanted.
    pub window: Window,
    /// The spectral bins wanted.
    pub bins: Option<BinGrid>,
    /// The OpenEXR file.
    pub output: PathBuf,
    /// The preview beside it; none beside a device or pipe.
    pub preview: Option<PathBuf>,
}

impl Job {
    /// Reads and plans.
    pub fn new(arguments: &Render, panel: Option<&str>) -> Result<Self, CommandError> {
        let mut scene = scene::load(&arguments.scene.scene, &arguments.overrides(panel))?;
        // With a wanted error pilots choose the samples, before the time counts.
        let open = arguments.time.is_some() && arguments.target_error.is_none();
        if open && !arguments.sets_spp() {
            if scene.image.sampler.needs_count() {
                return Err(CommandError::TimeForStrata);
            }
            scene.image.spp = MOST_SAMPLES;
        }
        let window = window(scene.image.size, arguments.crop)?;
        let bins = layers::bins(&arguments.layers)?;
        let plan = Plan::new(&scene, arguments.plan.is_full())?;
        let (output, preview) = paths(arguments, panel)?;
        let job = Self {
            scene,
            plan,
            window,
            bins,
            output,
            preview,
        };
        memory::check(arguments, &job)?;
        Ok(job)
    }

    /// Checks that both files can be written, before there is anything to lose.
    pub fn probe(&self) -> Result<(), CommandError> {
        probe(&self.output)?;
        self.preview.as_deref().map_or(Ok(()), probe)
    }
}

/// The whole image, or the crop if it is inside.
fn window(size: [u32; 2], crop: Option<Crop>) -> Result<Window, CommandError> {
    let [width, height] = size;
    let Crop { from, to } = crop.unwrap_or(Crop {
        from: [0, 0],
        to: size,
    });
    if to[0] > width || to[1] > height {
        return Err(CommandError::Crop { from, to, size });
    }
    Ok(Window {
        x0: from[0],
        y0: from[1],
        x1: to[0],
        y1: to[1],
    })
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
