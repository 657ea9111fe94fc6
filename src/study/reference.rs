//! What the renders of a study are compared with, how well that is known itself, and the comparison.

use std::path::{Path, PathBuf};

use crate::film::hash;
use crate::film::names::{self, VARIANCE};
use crate::film::pixels::Estimate;
use crate::film::{Attribute, Picture, exr};
use crate::scene::{Overrides, Scene};
use crate::spectrum::Spectrum;
use crate::spectrum::observer::{spectrum_to_xyz, xyz_to_linear_srgb};
use crate::stats::metrics::{self, Metric, mean, mean_over_channels};

/// Linear R, G, B of every pixel with their variances.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// The path of its file, `truth` or `own`.
    pub name: String,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// R, G and B, row by row.
    pub channels: [Vec<f64>; 3],
    /// The variance of each, 0 for a truth.
    pub variances: [Vec<f64>; 3],
}

/// The errors of a render, means over R, G, B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Mean squared error, the reference's variance taken off; may be below 0.
    pub mse: f64,
    /// Relative mean squared error, the same.
    pub relmse: f64,
    /// Signed mean error over the reference's mean.
    pub bias: Metric,
    /// Mean of the squared standard errors that the render reports; NaN with one replicate.
    pub estimated_mse: f64,
}

/// Why a picture cannot be the reference of a scene.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    #[error(transparent)]
    File(#[from] crate::film::Error),
    #[error(
        "{}: it has no channels variance.R, variance.G, variance.B, so what of a measured error is its own \
         cannot be told; render it with replicates and write them", .0.display()
    )]
    NoVariance(PathBuf),
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
    /// It shows another panel of the scene, or the scene with other settings.
    #[error("{}: it shows {found}, but {wanted} is to be studied", path.display())]
    Variant {
        path: PathBuf,
        found: String,
        wanted: String,
    },
    #[error("{}: {reason}", path.display())]
    Unfit { path: PathBuf, reason: String },
}

/// Keys that choose the estimator, not what is estimated, and the size, which has a check of its own.
const OF_THE_ESTIMATOR: [&str; 7] = [
    "image.size",
    "image.spp",
    "image.sampler",
    "image.seed",
    "image.replicates",
    "image.precision",
    "image.wavelengths",
];

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

    /// Reads a reference of a scene; `set` are the settings that replace those of its file.
    ///
    /// # Errors
    /// [`ReferenceError`] where it cannot be a reference of that scene.
    pub fn read(
        path: &Path,
        scene: &Scene,
        set: &[(String, String)],
    ) -> Result<Self, ReferenceError> {
        let picture = exr::read(path)?;
        let text = |name: &str| match picture.attribute(name) {
            Some(Attribute::Text(text)) => Some(text.as_str()),
            _ => None,
        };
        let wanted = hash(&scene.source.text);
        let Some(found) = text("sceneHash") else {
            let missing =
                "it does not say which scene it shows (the attribute sceneHash is missing)";
            return Err(unfit(path, missing.to_owned()));
        };
        if found != wanted {
            let reason = format!(
                "it shows another scene: its sceneHash is {found}, that of {} is {wanted}; if the scene \
                 has changed, the reference must be made again",
                scene.source.path
            );
            return Err(unfit(path, reason));
        }
        let its_own = Overrides::pairs(text("overrides").unwrap_or_default());
        let found = variant(text("panel").unwrap_or_default(), &its_own);
        let wanted = variant(scene.panel.as_deref().unwrap_or_default(), set);
        if found != wanted {
            let path = path.to_owned();
            return Err(ReferenceError::Variant {
                path,
                found,
                wanted,
            });
        }
        Self::of_picture(path, &picture, scene.image.size.map(|n| n as usize))
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
        let found = [picture.width, picture.height];
        if found != wanted {
            let path = path.to_owned();
            return Err(ReferenceError::Size {
                path,
                found,
                wanted,
            });
        }
        let channels = checked(path, picture, names::BEAUTY)?
            .ok_or_else(|| unfit(path, "it has no channels R, G, B".to_owned()))?;
        let variances = checked(path, picture, VARIANCE)?
            .ok_or_else(|| ReferenceError::NoVariance(path.to_owned()))?;
        Ok(Self {
            name: path.display().to_string(),
            size: found,
            channels,
            variances,
        })
    }

    /// Compares a render of the same size with it.
    pub fn measure(&self, estimates: &[Estimate]) -> Measured {
        let mut mse = 0.0;
        let (mut relative, mut bias) = (Vec::new(), Vec::new());
        for (c, x) in planes(estimates).iter().enumerate() {
            let (r, variance) = (&self.channels[c], &self.variances[c]);
            mse += (metrics::mse(x, r).value - mean(variance)) / 3.0;
            relative.push(metrics::relmse(x, r, Some(variance)));
            bias.push(metrics::relative_mean_error(x, r));
        }
        let squares = estimates
            .iter()
            .map(|e| e.standard_error.iter().map(|s| s * s).sum::<f64>());
        Measured {
            mse,
            relmse: mean_over_channels(&relative).value,
            bias: mean_over_channels(&bias),
            estimated_mse: squares.sum::<f64>() / (3 * estimates.len()) as f64,
        }
    }

    /// Root mean squared standard error, the mean over channels under the root.
    pub fn rmse(&self) -> f64 {
        self.mse().sqrt()
    }

    /// Mean variance over pixels and channels.
    pub fn mse(&self) -> f64 {
        self.variances.iter().map(|v| mean(v)).sum::<f64>() / 3.0
    }

    /// Its relative variance: what its noise adds to a `relmse` on average.
    pub fn relmse(&self) -> f64 {
        let pairs = self.channels.iter().zip(&self.variances);
        let relmse = |(r, variance): (&Vec<f64>, &Vec<f64>)| {
            metrics::relmse(r, r, Some(variance)).value.abs()
        };
        pairs.map(relmse).sum::<f64>() / 3.0
    }
}

/// The means of R, G and B, one plane each.
pub fn planes(estimates: &[Estimate]) -> [Vec<f64>; 3] {
    std::array::from_fn(|c| estimates.iter().map(|e| e.mean[c]).collect())
}

/// Three planes as one triple a pixel.
pub fn pixels([r, g, b]: &[Vec<f64>; 3]) -> Vec<[f32; 3]> {
    let pixels = r.iter().zip(g).zip(b);
    pixels
        .map(|((r, g), b)| [*r as f32, *g as f32, *b as f32])
        .collect()
}

fn unfit(path: &Path, reason: String) -> ReferenceError {
    let path = path.to_owned();
    ReferenceError::Unfit { path, reason }
}

/// The three channels of a layer, without values that are not finite or variances below 0; `None`
/// where one is missing.
fn checked(
    path: &Path,
    picture: &Picture,
    layer: &str,
) -> Result<Option<[Vec<f64>; 3]>, ReferenceError> {
    let mut planes: [Vec<f64>; 3] = Default::default();
    for (plane, component) in planes.iter_mut().zip(names::RGB) {
        let channel = names::in_layer(layer, component);
        let Some(values) = picture.floats(&channel) else {
            return Ok(None);
        };
        let wrong = |v: &f32| !(v.is_finite() && (layer != VARIANCE || *v >= 0.0));
        if let Some(at) = values.iter().position(wrong) {
            let count = values.iter().filter(|v| wrong(v)).count();
            let (x, y) = (at % picture.width, at / picture.width);
            let reason = format!(
                "the channel {channel} has {count} pixels that are no numbers or, for a variance, below 0; the \
                 first is at {x},{y}: make the reference again"
            );
            return Err(unfit(path, reason));
        }
        *plane = values.iter().map(|v| f64::from(*v)).collect();
    }
    Ok(Some(planes))
}

/// The panel and what else changes what is estimated, in words.
fn variant(panel: &str, set: &[(String, String)]) -> String {
    let mut said: Vec<String> = set
        .iter()
        .filter(|(key, _)| !OF_THE_ESTIMATOR.contains(&key.as_str()))
        .map(|(key, value)| format!("{key}={}", value.replace(' ', "")))
        .collect();
    said.sort();
    let mut words = match panel {
        "" => "the scene without a panel".to_owned(),
        panel => format!("the panel \"{panel}\""),
    };
    if !said.is_empty() {
        words = format!("{words} with {}", said.join(" "));
    }
    words
}
