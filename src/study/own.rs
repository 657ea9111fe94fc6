//! A reference that the study renders itself, and how many renders it needs.

use std::path::Path;

use super::reference::{Reference, pixels, planes};
use super::subject::Ready;
use crate::film::{Attribute, Picture, exr, hash, names};
use crate::render::Progress;

/// How many times the reference's error, as a root mean square, is to lie below the best point's.
pub const MARGIN: f64 = 3.0;

/// Renders that the reference begins with, each of as many samples as the largest point: with the
/// same method its error is then a quarter of that point's, known with 15 degrees of freedom.
pub const FIRST: u32 = 16;

/// Means and squared deviations over independent renders (B. P. Welford, Technometrics 4, 1962).
#[derive(Debug, Clone)]
pub struct Own {
    /// Number of renders.
    pub count: u32,
    mean: [Vec<f64>; 3],
    squares: [Vec<f64>; 3],
}

impl Own {
    pub fn new(pixels: usize) -> Self {
        let zeros = || std::array::from_fn(|_| vec![0.0; pixels]);
        Self {
            count: 0,
            mean: zeros(),
            squares: zeros(),
        }
    }

    /// Adds a render; `false` if it was stopped before its end, which changes nothing.
    pub fn add(&mut self, ready: &mut Ready, progress: &mut dyn Progress) -> bool {
        let rendered = ready.render(self.count, progress);
        if rendered.samples < ready.scene.image.spp {
            return false;
        }
        self.count += 1;
        let count = f64::from(self.count);
        for (c, values) in planes(&rendered.rgb()).iter().enumerate() {
            let sums = self.mean[c].iter_mut().zip(&mut self.squares[c]);
            for ((mean, squares), value) in sums.zip(values) {
                let before = value - *mean;
                *mean += before / count;
                *squares += before * (value - *mean);
            }
        }
        true
    }

    /// The mean with its variance, after at least two renders.
    pub fn reference(&self, size: [usize; 2]) -> Reference {
        let count = f64::from(self.count);
        let variance = |s: &Vec<f64>| s.iter().map(|s| s / (count - 1.0) / count).collect();
        Reference {
            name: "own".to_owned(),
            size,
            channels: self.mean.clone(),
            variances: self.squares.each_ref().map(variance),
        }
    }
}

/// Renders that a reference of `count` renders with this mean squared error needs to lie
/// [`MARGIN`] times below a point's.
pub fn needed(count: u32, mse: f64, best_point: f64) -> u32 {
    let times = MARGIN * MARGIN * mse / best_point;
    if times.is_finite() && times > 1.0 {
        (f64::from(count) * times).ceil().min(f64::from(u32::MAX)) as u32
    } else {
        count
    }
}

/// Writes a study's own reference in the form of all references: colours, variances, and attributes
/// that say what it shows.
///
/// # Errors
/// As [`exr::write`].
pub fn write(
    path: &Path,
    reference: &Reference,
    own: &Own,
    ready: &Ready,
    overrides: &str,
) -> Result<(), crate::film::Error> {
    let mut picture = Picture::new(reference.size[0], reference.size[1]);
    for (layer, channels) in [
        (names::BEAUTY, &reference.channels),
        (names::VARIANCE, &reference.variances),
    ] {
        picture.push_triple(layer, names::RGB, &pixels(channels));
    }
    let source = &ready.scene.source;
    let texts = [
        ("sceneFile", source.path.clone()),
        ("sceneHash", hash(&source.text)),
        ("panel", ready.scene.panel.clone().unwrap_or_default()),
        ("overrides", overrides.to_owned()),
        ("settings", ready.name.clone()),
    ];
    let texts = texts.into_iter().filter(|(_, text)| !text.is_empty());
    let texts = texts.map(|(name, text)| (name, Attribute::Text(text)));
    let counts = [("replicates", own.count), ("spp", ready.scene.image.spp)];
    let counts = counts.map(|(name, count)| (name, Attribute::whole_number(count.into())));
    let all = texts
        .chain(counts)
        .map(|(name, value)| (name.to_owned(), value));
    picture.attributes = all.collect();
    exr::write(path, &picture)
}
