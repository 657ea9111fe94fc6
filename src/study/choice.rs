//! Which reference a study takes: the one given, a committed one, a known answer, or its own.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::StudyError;
use super::reference::{Reference, ReferenceError};
use super::run::Request;
use super::subject::{Ready, Subject};
use crate::scene::{SamplerKind, Scene};
use crate::spectrum::Spectrum;

/// The reference that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub enum Choice {
    /// The first there is of a committed reference, the scene's known answer, and the study's own.
    Auto,
    /// A picture with its variance.
    File(PathBuf),
    /// This radiance, the same at all wavelengths and in all pixels, W·m⁻²·sr⁻¹·nm⁻¹.
    Radiance(f64),
    /// This linear R, G, B in all pixels.
    Colour([f64; 3]),
}

impl FromStr for Choice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers: Option<Vec<f64>> = text
            .split(',')
            .map(|part| part.trim().parse().ok().filter(|n: &f64| n.is_finite()))
            .collect();
        Ok(match (text, numbers.as_deref()) {
            ("auto", _) => Self::Auto,
            (_, Some([radiance])) => Self::Radiance(*radiance),
            (_, Some([r, g, b])) => Self::Colour([*r, *g, *b]),
            _ => Self::File(PathBuf::from(text)),
        })
    }
}

#[derive(Debug)]
pub struct Found {
    /// The reference; `None` is the study's own, which is still to be rendered.
    pub reference: Option<Reference>,
    /// Where it comes from, in words.
    pub about: String,
    /// Why committed references were passed over.
    pub notes: Vec<String>,
}

/// A file's name without directory and extension.
pub fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// Finds the reference that is asked for.
///
/// # Errors
/// [`StudyError::Reference`] where the file asked for is no reference of this scene. With `auto`, a
/// committed reference that does not fit is passed over, and the notes say why.
pub fn find(request: &Request, scene: &Scene) -> Result<Found, StudyError> {
    let size = scene.image.size.map(|n| n as usize);
    let mut notes = Vec::new();
    let (reference, about) = match &request.reference {
        Choice::File(path) => {
            let reference = Reference::read(path, scene, &request.subject.overrides.set)?;
            (Some(reference), format!("the file {}", path.display()))
        }
        Choice::Radiance(value) => {
            let truth = Reference::truth(size, &Spectrum::Constant(*value));
            let about = format!("the radiance {value} at all wavelengths, known in closed form");
            (Some(truth), about)
        }
        Choice::Colour(rgb) => {
            let about = format!("the linear R, G, B {rgb:?}, known in closed form");
            (Some(Reference::uniform(size, *rgb)), about)
        }
        Choice::Auto => {
            if let Some((path, reference)) = first_committed(request, scene, &mut notes) {
                let about = format!("the committed reference {}", path.display());
                (Some(reference), about)
            } else if let Some(radiance) = &scene.truth {
                let about = "the truth that the scene file names".to_owned();
                (Some(Reference::truth(size, radiance)), about)
            } else {
                (None, String::new())
            }
        }
    };
    Ok(Found {
        reference,
        about,
        notes,
    })
}

/// The first committed reference that fits the scene, and its path.
fn first_committed(
    request: &Request,
    scene: &Scene,
    notes: &mut Vec<String>,
) -> Option<(PathBuf, Reference)> {
    for path in committed(&request.subject.path) {
        match Reference::read(&path, scene, &request.subject.overrides.set) {
            Ok(reference) => return Some((path, reference)),
            // Of another panel: not meant for this study.
            Err(ReferenceError::Variant { .. }) => {}
            Err(reason) => notes.push(format!("not used as reference: {reason}")),
        }
    }
    None
}

/// Where committed references of a scene may lie: pictures whose name begins with the scene's in
/// a directory `reference`, beside the scene's directory or in the current one.
fn committed(scene: &Path) -> Vec<PathBuf> {
    let name = stem(scene);
    let beside = scene.parent().map(|directory| directory.join(".."));
    let mut paths: Vec<PathBuf> = Vec::new();
    for root in [Some(PathBuf::new()), beside].into_iter().flatten() {
        let entries = std::fs::read_dir(root.join("reference"));
        let found = entries.into_iter().flatten().flatten().map(|e| e.path());
        let fits = |path: &PathBuf| {
            stem(path).starts_with(&name) && path.extension().is_some_and(|e| e == "exr")
        };
        for path in found.filter(fits) {
            let same = |other: &PathBuf| other.canonicalize().ok() == path.canonicalize().ok();
            if !paths.iter().any(same) {
                paths.push(path);
            }
        }
    }
    paths.sort();
    paths
}

/// The scene as the study's own reference renders it: with the best unbiased sampler, finders that
/// prove their hits, a precision that the plan answers for, and the most samples and the longest
/// paths that the points have.
///
/// # Errors
/// [`StudyError`] where the scene is not valid with these settings.
pub fn own<'a>(
    subject: &Subject,
    points: impl Iterator<Item = &'a Ready> + Clone,
) -> Result<Ready, StudyError> {
    let mut images = points.map(|ready| &ready.scene.image);
    let samples = images.clone().map(|image| image.spp).max().unwrap_or(1);
    let depths = images.clone().map(|image| image.max_depth);
    let sampler = match images.next().map(|image| image.sampler) {
        // Paths through the pixels' centres make another picture.
        Some(centred) if centred.is_centred() => centred.name(),
        _ => SamplerKind::Sobol.name(),
    };
    let image = |key: &str, value: String| (format!("image.{key}"), value);
    let mut overrides = subject.overrides.clone();
    overrides.finder = Some("auto".to_owned());
    overrides.set.extend([
        image("sampler", sampler.to_owned()),
        image("precision", "auto".to_owned()),
        image("replicates", "1".to_owned()),
        image("spp", samples.to_string()),
    ]);
    // Where a point has no limit, the reference has none.
    let depths: Option<Vec<u32>> = depths.collect();
    if let Some(depth) = depths.and_then(|depths| depths.into_iter().max()) {
        overrides.set.push(image("max_depth", depth.to_string()));
    }
    let name = format!("{sampler}, precision and finder auto");
    subject.ready(&overrides, name)
}
