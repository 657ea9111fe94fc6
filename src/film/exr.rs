//! OpenEXR files: single-part scan lines, 32-bit channels, compressed without loss (ZIP, blocks
//! of 16 lines).
//!
//! R, G, B are linear light with Rec. ITU-R BT.709-6 primaries and white point, and the file
//! says so. The same picture gives the same bytes, always.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use ::exr::error::Error as Failure;
use ::exr::image::write::WritableImage;
use ::exr::image::{AnyChannel, AnyChannels, Encoding, FlatImage, FlatSamples, Image, Layer};
use ::exr::image::{Blocks, Layers};
use ::exr::math::Vec2;
use ::exr::meta::attribute::{AttributeValue, Chromaticities, Compression, LineOrder, Text};
use ::exr::meta::header::LayerAttributes;
use ::exr::prelude::ReadChannels as _;
use ::exr::prelude::ReadLayers as _;

use super::{Attribute, Channel, Error, Picture, Values, attribute_order, whole};

/// Rec. ITU-R BT.709-6, table 1, items 1.3 and 1.4: primaries and D65, CIE 1931 x, y.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// Writes a picture, whole or not at all (see [`whole::write()`]).
///
/// Channels and attributes are sorted by name, as the format asks for and repeatable bytes need.
///
/// # Errors
/// [`Error::Write`], of the kind `InvalidInput` when [`Picture::check`] finds a fault or an
/// attribute has a name that OpenEXR keeps for itself; otherwise as [`whole::write()`].
pub fn write(path: &Path, picture: &Picture) -> Result<(), Error> {
    let contradiction = |reason: String| io::Error::new(io::ErrorKind::InvalidInput, reason);
    whole::write(path, |file| {
        picture.check().map_err(contradiction)?;
        let written = to_image(picture).write().to_unbuffered(&mut *file);
        written.map_err(|failure| match failure {
            Failure::Io(source) => source,
            other => contradiction(other.to_string()),
        })?;
        attribute_order::sort(file)
    })
}

/// Reads a single-part picture back, whoever wrote it. Half-precision channels become single
/// precision, which holds them exactly; attributes of other types than [`Attribute`] has, and
/// those with a meaning in OpenEXR itself, are left out. Channels and attributes come sorted by
/// name.
///
/// # Errors
/// [`Error::Read`] when the file cannot be read, of the kind `InvalidData` when it is not OpenEXR, is
/// damaged, has several parts or subsampled channels, or is cropped (its data window is not its
/// display window).
pub fn read(path: &Path) -> Result<Picture, Error> {
    let content = |reason: String| io::Error::new(io::ErrorKind::InvalidData, reason);
    let read = File::open(path).and_then(|file| {
        let image = ::exr::image::read::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .from_buffered(BufReader::new(file))
            .map_err(|failure| match failure {
                Failure::Io(source) => source,
                Failure::Invalid(reason) => {
                    content(format!("it is no sound OpenEXR file ({reason})"))
                }
                other => content(other.to_string()),
            })?;
        from_image(image).map_err(content)
    });
    read.map_err(|source| Error::Read {
        path: path.to_owned(),
        source,
    })
}

impl Picture {
    /// Writes an OpenEXR file, whole or not at all.
    ///
    /// # Errors
    /// As [`write()`].
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        write(path.as_ref(), self)
    }

    /// Reads an OpenEXR file.
    ///
    /// # Errors
    /// As [`read()`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        read(path.as_ref())
    }
}

fn to_image(picture: &Picture) -> Image<Layer<AnyChannels<FlatSamples>>> {
    let channels = picture.channels.iter().map(|channel| {
        let samples = match &channel.values {
            Values::F32(values) => FlatSamples::F32(values.clone()),
            Values::U32(values) => FlatSamples::U32(values.clone()),
        };
        AnyChannel::new(text(&channel.name), samples)
    });
    let size = Vec2(picture.width, picture.height);
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let mut attributes = LayerAttributes::default();
    for (name, value) in &picture.attributes {
        attributes.other.insert(text(name), to_value(value));
    }
    let channels = AnyChannels::sort(channels.collect());
    let mut image = Image::from_layer(Layer::new(size, attributes, encoding, channels));
    if picture.channel("R").is_some() {
        image.attributes.chromaticities = Some(REC_709);
    }
    image
}

fn from_image(image: FlatImage) -> Result<Picture, String> {
    let display = image.attributes.display_window;
    let mut layers: Layers<AnyChannels<FlatSamples>> = image.layer_data;
    let count = layers.len();
    let (Some(layer), 1) = (layers.pop(), count) else {
        return Err(format!("it has {count} parts where one is expected"));
    };
    if layer.absolute_bounds() != display {
        return Err("it is cropped: its data window is not its display window".to_owned());
    }
    let mut picture = Picture::new(layer.size.width(), layer.size.height());
    for channel in layer.channel_data.list {
        if channel.sampling != Vec2(1, 1) {
            return Err(format!("channel {} is subsampled", channel.name));
        }
        picture.channels.push(Channel {
            name: string(&channel.name),
            values: match channel.sample_data {
                FlatSamples::F16(values) => {
                    Values::F32(values.iter().map(|half| half.to_f32()).collect())
                }
                FlatSamples::F32(values) => Values::F32(values),
                FlatSamples::U32(values) => Values::U32(values),
            },
        });
    }
    let (own, shared) = (layer.attributes.other, image.attributes.other);
    let custom = own.iter().chain(&shared);
    picture.attributes = custom
        .filter_map(|(name, value)| Some((string(name), from_value(value)?)))
        .collect();
    picture.attributes.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(picture)
}

fn to_value(attribute: &Attribute) -> AttributeValue {
    match attribute {
        Attribute::Text(value) => AttributeValue::Text(text(value)),
        Attribute::Int(value) => AttributeValue::I32(*value),
        Attribute::Float(value) => AttributeValue::F32(*value),
        Attribute::Double(value) => AttributeValue::F64(*value),
    }
}

/// An attribute from the file, if it is of a type that [`Attribute`] has.
fn from_value(value: &AttributeValue) -> Option<Attribute> {
    match value {
        AttributeValue::Text(value) => Some(Attribute::Text(string(value))),
        AttributeValue::I32(value) => Some(Attribute::Int(*value)),
        AttributeValue::F32(value) => Some(Attribute::Float(*value)),
        AttributeValue::F64(value) => Some(Attribute::Double(*value)),
        _ => None,
    }
}

/// The bytes of a string as they are: OpenEXR's texts have no encoding of their own, and UTF-8
/// is what its programs expect.
fn text(value: &str) -> Text {
    Text::from_slice_unchecked(value.as_bytes())
}

/// A string from bytes that ought to be UTF-8; what is not becomes U+FFFD.
fn string(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}
