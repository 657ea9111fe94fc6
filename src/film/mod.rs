//! Pictures and the files they are kept in: OpenEXR with everything, PNG to look at.
//!
//! A [`Picture`] is named channels over one grid of pixels, and attributes that say where they
//! come from. [`exr`] writes and reads it without loss, [`png`] shows its R, G, B, [`whole`] makes
//! sure that a file appears complete or not at all.

pub mod attribute_order;
pub mod exr;
pub mod names;
pub mod pixels;
pub mod png;
pub mod spectral;
pub mod whole;

use std::collections::HashSet;
use std::io;
use std::path::PathBuf;

use sha2::{Digest, Sha256};

/// Named channels over `width` × `height` pixels, with attributes.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Channels of different names.
    pub channels: Vec<Channel>,
    /// Names and values of the custom attributes; no name occurs twice.
    pub attributes: Vec<(String, Attribute)>,
}

/// One number per pixel, with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name in the file; a dot separates layer and component.
    pub name: String,
    /// `width` × `height` values, rows from the top, each from the left.
    pub values: Values,
}

/// The values of a channel.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Measured quantities.
    F32(Vec<f32>),
    /// Identities and counts.
    U32(Vec<u32>),
}

/// The value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    /// UTF-8 text of any length.
    Text(String),
    /// 32-bit signed integer.
    Int(i32),
    /// Single precision number.
    Float(f32),
    /// Double precision number.
    Double(f64),
}

/// Why a file could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Nothing has been written. The kind of the source is `InvalidInput` where the picture contradicts
    /// itself or breaks a rule of the file format.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// What the operating system or the file format objects to.
        source: io::Error,
    },
    /// The kind of the source is `InvalidData` where the file is no OpenEXR file, or one that is
    /// damaged or holds what a [`Picture`] cannot.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file that was to be read.
        path: PathBuf,
        /// What the operating system says, or what is wrong with the file.
        source: io::Error,
    },
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::U32(values) => values.len(),
        }
    }
}

impl Channel {
    /// A channel of measured quantities.
    pub fn float(name: impl Into<String>, values: Vec<f32>) -> Self {
        Self {
            name: name.into(),
            values: Values::F32(values),
        }
    }

    /// A channel of identities or counts.
    pub fn integer(name: impl Into<String>, values: Vec<u32>) -> Self {
        Self {
            name: name.into(),
            values: Values::U32(values),
        }
    }
}

impl Attribute {
    /// A whole number: [`Attribute::Int`] where 32 bits hold it, decimal digits as
    /// [`Attribute::Text`] where they do not (OpenEXR has no wider integer).
    #[must_use]
    pub fn whole_number(value: u64) -> Self {
        i32::try_from(value).map_or_else(|_| Self::Text(value.to_string()), Self::Int)
    }
}

/// SHA-256 (FIPS 180-4) of a text's UTF-8 bytes, 64 hexadecimal digits: the hash of scenes.
pub fn hash(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Picture {
    /// A picture without channels and attributes.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            channels: Vec::new(),
            attributes: Vec::new(),
        }
    }

    /// Adds a floating-point channel for each component of a value: `("", RGB)` gives R, G, B and
    /// `("N", XYZ)` gives N.X, N.Y, N.Z.
    pub fn push_triple(&mut self, layer: &str, components: [&str; 3], values: &[[f32; 3]]) {
        for (index, component) in components.into_iter().enumerate() {
            let plane = values.iter().map(|value| value[index]).collect();
            self.channels
                .push(Channel::float(names::in_layer(layer, component), plane));
        }
    }

    /// The channel of this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// The floating-point values of the channel of this name.
    #[must_use]
    pub fn floats(&self, name: &str) -> Option<&[f32]> {
        match &self.channel(name)?.values {
            Values::F32(values) => Some(values),
            Values::U32(_) => None,
        }
    }

    /// The attribute of this name.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        let found = self.attributes.iter().find(|(other, _)| other == name);
        found.map(|(_, value)| value)
    }

    /// The pixels' linear R, G, B, if the picture has these channels.
    #[must_use]
    pub fn rgb(&self) -> Option<Vec<[f32; 3]>> {
        let [red, green, blue] = [self.floats("R")?, self.floats("G")?, self.floats("B")?];
        let pixels = red.iter().zip(green).zip(blue);
        Some(pixels.map(|((&r, &g), &b)| [r, g, b]).collect())
    }

    /// Checks that the picture is consistent and that its names fit the file format.
    ///
    /// # Errors
    /// A description of the first fault: no pixels or channels, a channel of another length, a
    /// name that is empty, too long, not plain ASCII or used twice.
    pub fn check(&self) -> Result<(), String> {
        let Some(pixels) = self.width.checked_mul(self.height).filter(|&n| n > 0) else {
            let (width, height) = (self.width, self.height);
            return Err(format!("{width} × {height} pixels are no picture"));
        };
        if self.channels.is_empty() {
            return Err("the picture has no channels".to_owned());
        }
        let wrong = self.channels.iter().find(|c| c.values.len() != pixels);
        if let Some(Channel { name, values }) = wrong {
            let count = values.len();
            return Err(format!(
                "channel {name:?} has {count} values for {pixels} pixels"
            ));
        }
        distinct("channel", self.channels.iter().map(|c| c.name.as_str()))?;
        distinct("attribute", self.attributes.iter().map(|(n, _)| n.as_str()))
    }
}

/// Longest name that every version of OpenEXR reads, in bytes (Kainz, Bogart et al., *OpenEXR
/// File Layout*: names above 31 bytes need the long-name flag of version 2).
const LONGEST_NAME: usize = 31;

/// Checks that names fit the file format and differ.
fn distinct<'a>(kind: &str, names: impl Iterator<Item = &'a str>) -> Result<(), String> {
    let mut seen = HashSet::new();
    for name in names {
        if name.is_empty() || !name.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err(format!("{kind} name {name:?} is empty or not plain ASCII"));
        }
        if name.len() > LONGEST_NAME {
            return Err(format!(
                "{kind} name {name:?} is longer than {LONGEST_NAME} bytes"
            ));
        }
        if !seen.insert(name) {
            return Err(format!("{kind} name {name:?} is used twice"));
        }
    }
    Ok(())
}
