//! What the renders of a study are compared with, and how well that is known itself.

use std::path::{Path, PathBuf};

use crate::film::hash;
use crate::film::names::{self, VARIANCE};
use crate::film::{Attribute, Picture, exr};
use crate::scene::{Overrides, Scene};
use crate::spectrum::Spectrum;
use crate::spectrum::observer::{spectrum_to_xyz, xyz_to_linear_srgb};
use crate::stats::metrics::{RELMSE_EPSILON, mean};

/// Linear R, G, B of every pixel with their variances.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// What it is: a file, `truth` or `own`.
    pub name: String,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// R, G and B, row by row.
    pub channels: [Vec<f64>; 3],
    /// The variance of each, 0 for a truth.
    pub variances: [Vec<f64>; 3],
}

/// Why a picture cannot be the reference of a scene.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// It cannot be read.
    #[error(transparent)]
    File(#[from] crate::film::Error),
    /// It has no R, G, B.
    #[error("{}: it has no channels R, G, B", .0.display())]
    NoColour(PathBuf),
    /// It does not say how well it is known.
    #[error(
        "{}: it has no channels variance.R, variance.G, variance.B, so what of a measured error is its own \
         cannot be told; render it with replicates and write them", .0.display()
    )]
    NoVariance(PathBuf),
    /// Another size.
    #[error(
        "{}: it has {}x{} pixels, the scene {}x{}",
        path.display(), found[0], found[1], wanted[0], wanted[1]
    )]
    Size {
        path: PathBuf,
        found: [usize; 2],
        /// The scene's.
        wanted: [usize; 2],
    },
    /// It holds what is no number, or a negative variance.
    #[error(
        "{}: the channel {channel} has {count} pixels that are no numbers or, for a variance, below 0; the \
         first is at {},{}: make the reference again", path.display(), first[0], first[1]
    )]
    NotANumber {
        path: PathBuf,
        /// The first channel that has them.
        channel: String,
        count: usize,
        /// Column and row of the first.
        first: [usize; 2],
    },
    /// It does not say which scene it shows.
    #[error(
        "{}: it does not say which scene it shows (the attribute sceneHash is missing)", .0.display()
    )]
    NoHash(PathBuf),
    /// It shows another scene.
    #[error(
        "{}: it shows another scene: its sceneHash is {found}, that of {scene} is {wanted}; if the scene \
         has changed, the reference must be made again", path.display()
    )]
    Hash {
        path: PathBuf,
        /// The hash in it.
        found: String,
        /// The scene file.
        scene: String,
        wanted: String,
    },
    /// It shows the scene with something else laid over it.
    #[error("{}: it shows {found}, but {wanted} is to be studied", path.display())]
    Variant {
        path: PathBuf,
        /// What it shows.
        found: String,
        /// What is wanted.
        wanted: String,
    },
}

/// Keys that choose the estimator, not what is estimated; and the size, which is compared itself.
const OF_THE_ESTIMATOR: [&str; 7] = [
    "image.size",
    "image.spp",
    "image.sampler",
    "image.seed",
    "image.replicates",
    "image.precision",
    "image.wavelengths",
];

/// What is studied: the scene and what was laid over it.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    pub scene: &'a Scene,
    /// `--set` and the options that stand for it.
    pub set: &'a [(String, String)],
}

impl Reference {
    /// A picture that has the same spectrum everywhere.
    pub fn truth(size: [usize; 2], radiance: &Spectrum) -> Self {
        Self::uniform(size, xyz_to_linear_srgb(spectrum_to_xyz(radiance)))
    }

    /// A picture that has the same linear R, G, B everywhere.
    pub fn uniform(size: [usize; 2], rgb: [f64; 3]) -> Self {
        let pixels = size[0] * size[1];
        Self {
            name: "truth".to_owned(),
            size,
            channels: rgb.map(|value| vec![value; pixels]),
            variances: rgb.map(|_| vec![0.0; pixels]),
        }
    }

    /// Reads a reference of a scene.
    ///
    /// # Errors
    /// [`ReferenceError`]: what is wrong with it as a reference of that scene.
    pub fn read(path: &Path, subject: Subject<'_>) -> Result<Self, ReferenceError> {
        let picture = exr::read(path)?;
        let size = subject.scene.image.size.map(|n| n as usize);
        check_subject(path, &picture, subject)?;
        Self::of_picture(path, &picture, size)
    }

    /// The reference in a picture of this size.
    ///
    /// # Errors
    /// [`ReferenceError`] about its size, channels and values.
    pub fn of_picture(
        path: &Path,
        picture: &Picture,
        wanted: [usize; 2],
    ) -> Result<Self, ReferenceError> {
        let path = path.to_owned();
        let found = [picture.width, picture.height];
        if found != wanted {
            return Err(ReferenceError::Size {
                path,
                found,
                wanted,
            });
        }
        let channels =
            planes(picture, names::BEAUTY).ok_or_else(|| ReferenceError::NoColour(path.clone()))?;
        let variances =
            planes(picture, VARIANCE).ok_or_else(|| ReferenceError::NoVariance(path.clone()))?;
        let named = |layer: &'static str| {
            names::RGB
                .into_iter()
                .map(move |c| names::in_layer(layer, c))
        };
        let all = named(names::BEAUTY).chain(named(VARIANCE));
        for (channel, values) in all.zip(channels.iter().chain(&variances)) {
            let signed = !channel.starts_with(VARIANCE);
            let wrong = |v: &f64| !(v.is_finite() && (signed || *v >= 0.0));
            if let Some(at) = values.iter().position(wrong) {
                return Err(ReferenceError::NotANumber {
                    path,
                    channel,
                    count: values.iter().filter(|v| wrong(v)).count(),
                    first: [at % found[0], at / found[0]],
                });
            }
        }
        Ok(Self {
            name: path.display().to_string(),
            size: found,
            channels,
            variances,
        })
    }

    /// Root mean squared standard error, the mean over channels under the root.
    pub fn rmse(&self) -> f64 {
        self.mse().sqrt()
    }

    /// Mean variance over pixels and channels.
    pub fn mse(&self) -> f64 {
        self.variances.iter().map(|v| mean(v)).sum::<f64>() / 3.0
    }

    /// Its variance in the sense of `relmse`.
    pub fn relmse(&self) -> f64 {
        let channel = |(values, variances): (&Vec<f64>, &Vec<f64>)| {
            let epsilon = RELMSE_EPSILON * mean(values) * mean(values);
            let terms = values.iter().zip(variances);
            let sum: f64 = terms.map(|(r, v)| v / (r * r + epsilon)).sum();
            sum / values.len() as f64
        };
        let pairs = self.channels.iter().zip(&self.variances);
        pairs.map(channel).sum::<f64>() / 3.0
    }

    /// Colours for looking at.
    pub fn rgb(&self) -> Vec<[f32; 3]> {
        let [r, g, b] = &self.channels;
        let pixels = r.iter().zip(g).zip(b);
        pixels
            .map(|((r, g), b)| [*r as f32, *g as f32, *b as f32])
            .collect()
    }
}

/// The three channels of a layer.
fn planes(picture: &Picture, layer: &str) -> Option<[Vec<f64>; 3]> {
    let mut planes: [Vec<f64>; 3] = Default::default();
    for (plane, component) in planes.iter_mut().zip(names::RGB) {
        let values = picture.floats(&names::in_layer(layer, component))?;
        *plane = values.iter().map(|v| f64::from(*v)).collect();
    }
    Some(planes)
}

/// Checks that the picture shows this scene with these things laid over it.
fn check_subject(
    path: &Path,
    picture: &Picture,
    subject: Subject<'_>,
) -> Result<(), ReferenceError> {
    let text = |name: &str| match picture.attribute(name) {
        Some(Attribute::Text(text)) => Some(text.clone()),
        _ => None,
    };
    let scene = subject.scene;
    let wanted = hash(&scene.source.text);
    match text("sceneHash") {
        None => return Err(ReferenceError::NoHash(path.to_owned())),
        Some(found) if found != wanted => {
            return Err(ReferenceError::Hash {
                path: path.to_owned(),
                found,
                scene: scene.source.path.clone(),
                wanted,
            });
        }
        Some(_) => {}
    }
    let found = variant(
        &text("panel").unwrap_or_default(),
        &Overrides::pairs(&text("overrides").unwrap_or_default()),
    );
    let wanted = variant(scene.panel.as_deref().unwrap_or_default(), subject.set);
    if found == wanted {
        Ok(())
    } else {
        Err(ReferenceError::Variant {
            path: path.to_owned(),
            found,
            wanted,
        })
    }
}

/// The panel and what else changes what is estimated, in words.
fn variant(panel: &str, set: &[(String, String)]) -> String {
    let mut said: Vec<String> = set
        .iter()
        .filter(|(key, _)| !OF_THE_ESTIMATOR.contains(&key.as_str()))
        .map(|(key, value)| format!("{key}={}", value.replace(' ', "")))
        .collect();
    said.sort();
    let panel = if panel.is_empty() {
        "the scene without a panel".to_owned()
    } else {
        format!("the panel \"{panel}\"")
    };
    if said.is_empty() {
        panel
    } else {
        format!("{panel} with {}", said.join(" "))
    }
}
