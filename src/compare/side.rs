//! One picture of a comparison.

use std::path::{Path, PathBuf};

use super::CompareError;
use crate::film::spectral::wavelength;
use crate::film::{Attribute, Picture, exr, names};
use crate::stats::Estimate;

/// One side of a comparison.
#[derive(Debug, Clone)]
pub struct Side {
    /// The file, for messages.
    pub path: PathBuf,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// R, G, B and spectral bands, as far as the picture has them.
    pub channels: Vec<Channel>,
    /// Degrees of freedom of each variance; `None` where no variances are known.
    pub freedom: Option<f64>,
    /// The attributes that say where the picture comes from.
    pub attributes: Vec<(String, Attribute)>,
}

/// A channel with the variances of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name in the file.
    pub name: String,
    /// Values, row by row.
    pub values: Vec<f64>,
    /// Variance of each value.
    pub variances: Option<Vec<f64>>,
}

impl Side {
    /// Reads a picture.
    ///
    /// # Errors
    /// [`CompareError`] for files that cannot be read, hold nothing to compare, or values that are
    /// not numbers.
    pub fn read(path: &Path) -> Result<Self, CompareError> {
        Self::of_picture(path, exr::read(path)?)
    }

    /// Takes a picture already read from `path`.
    ///
    /// # Errors
    /// [`CompareError`] for pictures that hold nothing to compare, or values that are not numbers.
    pub fn of_picture(path: &Path, picture: Picture) -> Result<Self, CompareError> {
        let places = picture.channels.iter();
        let mut places: Vec<(f64, &str)> = places
            .filter_map(|channel| Some((place(&channel.name)?, channel.name.as_str())))
            .collect();
        if places.is_empty() {
            return Err(CompareError::Channels(path.to_owned()));
        }
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let channels = places.into_iter();
        let channels = channels.map(|(_, name)| channel(path, &picture, name));
        let channels = channels.collect::<Result<Vec<_>, _>>()?;
        let freedom = match picture.attribute("replicates") {
            Some(Attribute::Int(count)) if *count > 1 => Some(f64::from(count - 1)),
            _ => None,
        };
        let known = channels.iter().any(|channel| channel.variances.is_some());
        Ok(Self {
            path: path.to_owned(),
            width: picture.width,
            height: picture.height,
            channels,
            freedom: freedom.filter(|_| known),
            attributes: picture.attributes,
        })
    }

    /// The pixels' linear R, G, B, if the side has these channels.
    #[must_use]
    pub fn rgb(&self) -> Option<Vec<[f64; 3]>> {
        let [r, g, b] = names::RGB.map(|name| self.channel(name));
        let pixels = r?.values.iter().zip(&g?.values).zip(&b?.values);
        Some(pixels.map(|((&r, &g), &b)| [r, g, b]).collect())
    }

    /// The channel of this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// An attribute of the file.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        let found = self.attributes.iter().find(|(other, _)| other == name);
        found.map(|(_, value)| value)
    }

    /// A text attribute.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.attribute(name)? {
            Attribute::Text(text) => Some(text),
            _ => None,
        }
    }
}

/// The mean of a channel over some pixels, or all; pixels are independent of each other.
pub fn mean_over(channel: &Channel, freedom: f64, pixels: Option<&[usize]>) -> Option<Estimate> {
    let variances = channel.variances.as_ref()?;
    let Some(pixels) = pixels else {
        return Some(Estimate::mean_of(&channel.values, variances, freedom));
    };
    let values: Vec<f64> = pixels.iter().map(|&i| channel.values[i]).collect();
    let variances: Vec<f64> = pixels.iter().map(|&i| variances[i]).collect();
    Some(Estimate::mean_of(&values, &variances, freedom))
}

/// The order of channels that are compared: R, G, B, then bands from short to long wavelengths.
fn place(name: &str) -> Option<f64> {
    let rgb = names::RGB.iter().position(|other| *other == name);
    rgb.map(|index| index as f64)
        .or_else(|| Some(wavelength(name)? + 3.0))
}

fn channel(path: &Path, picture: &Picture, name: &str) -> Result<Channel, CompareError> {
    let wide = |values: &[f32]| values.iter().map(|&v| f64::from(v)).collect::<Vec<_>>();
    let values = picture.floats(name).map(wide).unwrap_or_default();
    let wrong = |i: &usize| !values[*i].is_finite();
    let first = (0..values.len()).find(wrong);
    if let Some(first) = first {
        return Err(CompareError::NotFinite {
            path: path.to_owned(),
            channel: name.to_owned(),
            count: (0..values.len()).filter(wrong).count(),
            first: [first % picture.width, first / picture.width],
        });
    }
    let layer = |layer: &str| picture.floats(&names::in_layer(layer, name)).map(wide);
    let squared = |errors: Vec<f64>| errors.into_iter().map(|e| e * e).collect::<Vec<_>>();
    let variances = layer(names::VARIANCE).or_else(|| layer(names::STANDARD_ERROR).map(squared));
    // With a single replicate etalon writes NaN for every standard error.
    let variances = variances.filter(|v| !v.iter().all(|v| v.is_nan()));
    let sound = |v: &Vec<f64>| v.iter().all(|&v| v >= 0.0 && v.is_finite());
    if !variances.as_ref().is_none_or(sound) {
        return Err(CompareError::Variance(path.to_owned(), name.to_owned()));
    }
    Ok(Channel {
        name: name.to_owned(),
        values,
        variances,
    })
}
