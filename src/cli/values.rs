//! Values of options, as they are written.

use std::str::FromStr;
use std::time::Duration;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use etalon::inside::study::axis::{Axis, AxisError};
use etalon::{BinGrid, Instructions, Window};

/// `key=value` as a pair; which keys and values there are is the scene's to say.
pub fn setting(text: &str) -> Result<(String, String), &'static str> {
    let (key, value) = text.split_once('=').ok_or("expected KEY=VALUE")?;
    Ok((key.to_owned(), value.to_owned()))
}

/// `N` numbers between separators, and no more.
fn numbers<T: FromStr, const N: usize>(text: &str, separator: char) -> Option<[T; N]> {
    let numbers: Option<Vec<T>> = text
        .split(separator)
        .map(|part| part.trim().parse().ok())
        .collect();
    numbers?.try_into().ok()
}

/// Width and height as a TOML array, for the scene to check.
pub fn size(text: &str) -> Result<String, &'static str> {
    let [width, height] = numbers::<u64, 2>(text, 'x')
        .ok_or("expected width and height in pixels, such as 640x480")?;
    Ok(format!("[{width}, {height}]"))
}

/// A rectangle of pixels that is not empty.
pub fn crop(text: &str) -> Result<Window, &'static str> {
    match numbers(text, ',') {
        Some([x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Window { x0, y0, x1, y1 }),
        _ => Err("expected X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1"),
    }
}

/// Column and row of a pixel, from 0.
pub fn pixel(text: &str) -> Result<[u32; 2], &'static str> {
    numbers(text, ',').ok_or("expected X,Y: column and row, counted from 0")
}

/// A length of time above zero.
pub fn seconds(text: &str) -> Result<Duration, &'static str> {
    text.parse()
        .ok()
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .filter(|duration| !duration.is_zero())
        .ok_or("expected a number of seconds above 0")
}

/// A further layer of the picture.
#[derive(Debug, Clone)]
pub enum Layer {
    /// About the first visible surface.
    FirstHit(etalon::Layer),
    /// Spectral radiance in bins.
    Spectral(BinGrid),
}

/// The name of a layer; spectral bins may have a range and a width in nm.
pub fn layer(text: &str) -> Result<Layer, String> {
    let mut first = etalon::Layer::ALL.into_iter();
    if let Some((_, layer)) = first.find(|(name, _)| *name == text) {
        return Ok(Layer::FirstHit(layer));
    }
    let read = |text: &str| {
        let (range, step) = text.strip_prefix(':')?.split_once(':')?;
        let [from, to]: [f64; 2] = numbers(range, '-')?;
        (from <= to).then_some([from, to, step.trim().parse().ok()?])
    };
    let [from, to, step] = match text.strip_prefix("spectral") {
        // The visible range as most tables have it.
        Some("") => [400.0, 700.0, 10.0],
        Some(range) => read(range)
            .ok_or("expected spectral:from-to:step in nm, such as spectral:400-700:10")?,
        None => {
            return Err(
                "expected depth, normal, object, material or spectral[:from-to:step]".to_owned(),
            );
        }
    };
    let bins = BinGrid::new(from, to, step).map_err(|error| error.to_string())?;
    Ok(Layer::Spectral(bins))
}

/// Instruction sets by name, `auto` for the best one.
pub fn instructions() -> impl TypedValueParser<Value = Instructions> {
    let names = ["auto"].iter().chain(Instructions::NAMES);
    PossibleValuesParser::new(names).try_map(|name| match name.as_str() {
        "auto" => Ok(Instructions::best()),
        name => Instructions::named(name)
            .ok_or_else(|| format!("this machine has no {name} instructions")),
    })
}

/// A finite number.
pub fn finite(text: &str) -> Result<f64, &'static str> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or("not a finite number")
}

/// An axis of a study.
pub fn axis(text: &str) -> Result<Axis, String> {
    text.parse().map_err(|error| match error {
        AxisError::Key(_) => format!("{error}; anything else is set with --set"),
        other => other.to_string(),
    })
}

/// A share above 0 and below 1.
pub fn share(text: &str) -> Result<f64, &'static str> {
    let share = text.parse().ok().filter(|s: &f64| *s > 0.0 && *s < 1.0);
    share.ok_or("expected a share above 0 and below 1, such as 0.01")
}
