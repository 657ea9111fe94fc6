//! One picture to render: what, how much of it, and where to.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use etalon::inside::film::whole;
use etalon::{MOST_SAMPLES, Overrides, Plan, Scene};

use super::super::args::Render;
use super::super::values::Layer;
use super::super::{Failure, scene_words};

pub struct Job {
    pub render: etalon::Render,
    /// The OpenEXR file.
    pub output: PathBuf,
    /// The preview beside it; none beside a device or pipe.
    pub preview: Option<PathBuf>,
}

impl Job {
    /// Reads the scene and plans it.
    pub fn new(arguments: &Render, panel: Option<&str>) -> Result<Self, Failure> {
        let overrides = Overrides {
            panel: panel.map(str::to_owned),
            ..arguments.scene.overrides(&arguments.image.keys())
        };
        let scene = Scene::load_with(&arguments.scene.scene, &overrides);
        let mut scene = scene.map_err(|error| scene_words(&error))?;
        // With a wanted error pilots choose the samples, before the time counts.
        let open = arguments.time.is_some() && arguments.target_error.is_none();
        if open && !overrides.set.iter().any(|(key, _)| key == "image.spp") {
            if scene.image.sampler.needs_count() {
                return Err(
                    "--time needs --spp with the sampler \"stratified\": its strata are \
                            cut for a planned number of samples (sobol and independent need none)"
                        .into(),
                );
            }
            scene.set_samples(MOST_SAMPLES);
        }
        let plan = Plan::new(&scene, arguments.plan == "full")?;
        let mut render = etalon::Render::planned(scene, plan);
        if let Some(crop) = arguments.crop {
            let cropped = render.cropped(crop);
            render = cropped.map_err(|error| format!("the crop {error}"))?;
        }
        render.time = arguments.time;
        render.instructions = arguments.instructions;
        for layer in &arguments.layers {
            match layer {
                Layer::FirstHit(layer) => render.layers.push(*layer),
                Layer::Spectral(bins) => render.spectral = Some(bins.clone()),
            }
        }
        let (output, preview) = paths(arguments, panel)?;
        let job = Self {
            render,
            output,
            preview,
        };
        job.check_memory()?;
        Ok(job)
    }

    pub fn check_memory(&self) -> Result<(), Failure> {
        let checked = self.render.check_memory();
        Ok(checked.map_err(|error| {
            format!("{error}: use a smaller --size, a --crop or fewer spectral bins")
        })?)
    }

    /// Checks that both files can be written, before there is anything to lose.
    pub fn probe(&self) -> Result<(), Failure> {
        whole::probe(&self.output)?;
        Ok(self.preview.as_deref().map_or(Ok(()), whole::probe)?)
    }
}

/// Paths of the OpenEXR file and of the preview.
fn paths(arguments: &Render, panel: Option<&str>) -> Result<(PathBuf, Option<PathBuf>), Failure> {
    let all = arguments.scene.panel.as_deref() == Some("all");
    let scene = &arguments.scene.scene;
    let output = match &arguments.output {
        None => {
            let stem = scene.file_stem().unwrap_or(OsStr::new("picture"));
            named(Path::new(""), stem, panel, Some(OsStr::new("exr")))
        }
        Some(output) if all => {
            let stem = output.file_stem().unwrap_or_default();
            named(output, stem, panel, output.extension())
        }
        Some(output) => output.clone(),
    };
    let ending = output.extension();
    if ending.is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
        return Err(format!(
            "cannot write the picture to {}: it is OpenEXR, and the preview beside it is the PNG; \
             name the output .exr",
            output.display()
        )
        .into());
    }
    let [picture, scene] = [&output, scene].map(|path| path.canonicalize().ok());
    if picture.is_some() && picture == scene {
        let output = output.display();
        return Err(format!("cannot write the picture to {output}: that is the scene file").into());
    }
    let preview = (!is_stream(&output)).then(|| output.with_extension("png"));
    Ok((output, preview))
}

/// `stem-panel.extension` in the place of `path`; the stem may hold dots, and a panel's name what a
/// file's may not.
fn named(path: &Path, stem: &OsStr, panel: Option<&str>, extension: Option<&OsStr>) -> PathBuf {
    let mut name = stem.to_owned();
    if let Some(panel) = panel {
        name.push("-");
        name.push(panel.replace(|c: char| "/\\:".contains(c) || c.is_control(), "_"));
    }
    if let Some(extension) = extension {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

/// Whether a path names a device or pipe, which has no place beside it.
fn is_stream(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Checks that no two pictures go to the same file.
pub fn distinct(jobs: &[Job]) -> Result<(), Failure> {
    for (index, Job { output, .. }) in jobs.iter().enumerate() {
        if jobs[..index].iter().any(|other| other.output == *output) && !is_stream(output) {
            let output = output.display();
            return Err(format!("two panels would be written to {output}").into());
        }
    }
    Ok(())
}
