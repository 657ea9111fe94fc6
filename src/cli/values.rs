//! Values of options, as they are written.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use etalon::Window;
use etalon::inside::render::Instructions;
use etalon::inside::study::axis::{Axis, AxisError};

/// What is wrong with a value.
#[derive(Debug, thiserror::Error)]
#[error("expected {0}")]
pub struct Expected(&'static str);

/// `key=value` as a pair; what the two may be is the scene's to say.
pub fn setting(text: &str) -> Result<(String, String), Expected> {
    let (key, value) = text.split_once('=').ok_or(Expected("KEY=VALUE"))?;
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

/// One panel, or each of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Panels {
    /// All panels of the file.
    All,
    /// The one with this name.
    Named(String),
}

impl FromStr for Panels {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "all" => Self::All,
            name => Self::Named(name.to_owned()),
        })
    }
}

/// Width and height, shown as a TOML array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size([u64; 2]);

impl FromStr for Size {
    type Err = Expected;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        numbers(text, 'x')
            .map(Self)
            .ok_or(Expected("width and height in pixels, such as 640x480"))
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}]", self.0[0], self.0[1])
    }
}

/// A rectangle of pixels that is not empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop(pub Window);

impl FromStr for Crop {
    type Err = Expected;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = Expected("X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1");
        match numbers(text, ',') {
            Some([x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Self(Window { x0, y0, x1, y1 })),
            _ => Err(expected),
        }
    }
}

/// Column and row of a pixel, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pixel(pub [u32; 2]);

impl FromStr for Pixel {
    type Err = Expected;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        numbers(text, ',')
            .map(Self)
            .ok_or(Expected("X,Y: column and row, counted from 0"))
    }
}

/// A stretch of time above zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seconds(pub Duration);

impl FromStr for Seconds {
    type Err = Expected;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.parse()
            .ok()
            .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
            .filter(|duration| !duration.is_zero())
            .map(Self)
            .ok_or(Expected("a number of seconds above 0"))
    }
}

/// A further layer of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Layer {
    /// About the first visible surface.
    FirstHit(etalon::Layer),
    /// Spectral radiance in bins.
    Spectral(Option<SpectralRange>),
}

/// Centres of spectral bins, nm: from, from + step … up to `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralRange {
    /// First wavelength.
    pub from: f64,
    /// Last wavelength, at most.
    pub to: f64,
    /// Distance of neighbours.
    pub step: f64,
}

impl FromStr for Layer {
    type Err = Expected;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let first = etalon::Layer::ALL
            .into_iter()
            .find(|(name, _)| *name == text);
        if let Some((_, layer)) = first {
            return Ok(Self::FirstHit(layer));
        }
        match (text, text.strip_prefix("spectral:")) {
            ("spectral", _) => Ok(Self::Spectral(None)),
            (_, Some(range)) => range.parse().map(|range| Self::Spectral(Some(range))),
            _ => Err(Expected(
                "depth, normal, object, material or spectral[:from-to:step]",
            )),
        }
    }
}

impl FromStr for SpectralRange {
    type Err = Expected;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let read = || {
            let (range, step) = text.split_once(':')?;
            let [from, to] = numbers::<f64, 2>(range, '-')?;
            let step: f64 = step.trim().parse().ok()?;
            let proper = from > 0.0 && to >= from && to.is_finite() && step > 0.0;
            (proper && step.is_finite()).then_some(Self { from, to, step })
        };
        read().ok_or(Expected(
            "spectral:from-to:step in nm, such as spectral:400-700:10",
        ))
    }
}

/// What the plan leaves out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum PlanChoice {
    /// What the scene does not need.
    #[default]
    Auto,
    /// Nothing.
    Full,
}

impl PlanChoice {
    /// Whether nothing is left out.
    pub fn is_full(self) -> bool {
        self == Self::Full
    }
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
pub fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("not a finite number".to_owned()),
    }
}

/// An axis of a study.
pub fn axis(text: &str) -> Result<Axis, String> {
    text.parse().map_err(|error| match error {
        AxisError::Key(_) => format!("{error}; anything else is set with --set"),
        other => other.to_string(),
    })
}

/// What a wanted error is an error of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GoalTarget {
    /// The mean of the image.
    Image,
    /// The mean of its worst block.
    Block,
}

/// A share above 0 and below 1.
pub fn share(text: &str) -> Result<f64, Expected> {
    let share = text.parse().ok().filter(|s: &f64| *s > 0.0 && *s < 1.0);
    share.ok_or(Expected("a share above 0 and below 1, such as 0.01"))
}
