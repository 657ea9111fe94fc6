//! Spectra: values over wavelength (nm), their data and their sources.
//!
//! The visible range of this crate is 360–830 nm ([`NM_MIN`], [`NM_MAX`]), the range of the CIE
//! colour-matching functions. A [`Spectrum`] describes; the render loop reads it resampled to the
//! uniform cells of [`cells`], and the film turns wavelengths into XYZ with [`observer`].

pub mod blackbody;
pub mod cells;
pub mod glass;
pub mod grid;
pub mod illuminant;
pub mod ior;
pub mod metal;
pub mod observer;
mod quadrature;
pub mod rgb;
pub mod table;

pub use rgb::RgbError;
pub use table::{Table, TableError};

/// Lower end of the visible range, nm.
pub const NM_MIN: f64 = 360.0;
/// Upper end of the visible range, nm.
pub const NM_MAX: f64 = 830.0;

/// A function of wavelength.
#[derive(Debug, Clone, PartialEq)]
pub enum Spectrum {
    /// The same value at every wavelength: the equal-energy spectrum E, whose luminance Y it is (see
    /// [`observer`]).
    Constant(f64),
    /// Linear between samples, zero outside.
    Table(Table),
    /// Planck's law times `scale`, W·m⁻²·sr⁻¹·nm⁻¹.
    Blackbody {
        /// Temperature in kelvin.
        kelvin: f64,
        /// Factor on the radiance; 1 is physical.
        scale: f64,
    },
    /// `scale` times the sigmoid of a quadratic polynomial (Jakob & Hanika 2019), see [`rgb`].
    Sigmoid {
        /// The polynomial's coefficients of 1, t, t² with t = (λ − 595 nm)/235 nm.
        coefficients: [f64; 3],
        /// Factor; a reflectance has 1.
        scale: f64,
        /// Times D65 of luminance 1, as an emission is.
        d65: bool,
    },
}

/// Names that [`Spectrum::named`] knows.
pub const SPECTRUM_NAMES: [&str; 2] = ["D65", "E"];

impl Spectrum {
    /// CIE standard illuminant D65 with luminance Y = `scale` (see [`observer`]).
    pub fn d65(scale: f64) -> Self {
        Self::Table(illuminant::d65().clone()).scaled(scale)
    }

    /// A named illuminant with luminance Y = 1: one of [`SPECTRUM_NAMES`], in any letter case.
    pub fn named(name: &str) -> Option<Self> {
        match name.to_ascii_uppercase().as_str() {
            "D65" => Some(Self::d65(1.0)),
            "E" => Some(Self::Constant(1.0)),
            _ => None,
        }
    }

    /// The smooth reflectance of a linear sRGB colour under D65, see [`rgb`].
    ///
    /// # Errors
    /// If a component is not a number in 0…1.
    pub fn rgb_reflectance(rgb: [f64; 3]) -> Result<Self, RgbError> {
        rgb::fit_reflectance(rgb).map(|fit| fit.spectrum)
    }

    /// A smooth emission that displays as this linear sRGB colour, see [`rgb`].
    ///
    /// # Errors
    /// If a component is negative or not finite.
    pub fn rgb_emission(rgb: [f64; 3]) -> Result<Self, RgbError> {
        rgb::fit_emission(rgb).map(|fit| fit.spectrum)
    }

    /// This spectrum times `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value * factor),
            Self::Table(table) => Self::Table(Table {
                values: table.values.iter().map(|value| value * factor).collect(),
                nm: table.nm,
            }),
            Self::Blackbody { kelvin, scale } => Self::Blackbody {
                kelvin,
                scale: scale * factor,
            },
            Self::Sigmoid {
                coefficients,
                scale,
                d65,
            } => Self::Sigmoid {
                coefficients,
                scale: scale * factor,
                d65,
            },
        }
    }

    /// The value at wavelength `nm`.
    pub fn value(&self, nm: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Table(table) => table.value(nm),
            Self::Blackbody { kelvin, scale } => scale * blackbody::radiance(*kelvin, nm),
            Self::Sigmoid {
                coefficients,
                scale,
                d65,
            } => {
                let light = if *d65 {
                    illuminant::d65().value(nm)
                } else {
                    1.0
                };
                scale * rgb::sigmoid(coefficients, nm) * light
            }
        }
    }

    /// A number that no value over 360–830 nm exceeds.
    ///
    /// It is attained up to rounding, except for a [`Spectrum::Sigmoid`] times D65, where it is the
    /// product of the two factors' maxima.
    pub fn max_value(&self) -> f64 {
        self.range()[1]
    }

    /// A number that no value over 360–830 nm falls below, attained as [`Self::max_value`] is.
    pub fn min_value(&self) -> f64 {
        self.range()[0]
    }

    fn range(&self) -> [f64; 2] {
        match self {
            Self::Constant(value) => [*value; 2],
            Self::Table(table) => table.range(NM_MIN, NM_MAX),
            Self::Blackbody { kelvin, scale } => {
                sorted(blackbody::range(*kelvin).map(|value| value * scale))
            }
            Self::Sigmoid {
                coefficients,
                scale,
                d65,
            } => {
                let [s_min, s_max] = rgb::sigmoid_range(coefficients);
                let [d_min, d_max] = if *d65 {
                    illuminant::d65().range(NM_MIN, NM_MAX)
                } else {
                    [1.0; 2]
                };
                // Multiplied in the order of `value`, so that rounding, which is monotone, keeps
                // the bound a bound.
                sorted([scale * s_min * d_min, scale * s_max * d_max])
            }
        }
    }

    /// Whether the value is the same at every wavelength of 360–830 nm.
    pub fn is_constant(&self) -> bool {
        match self {
            Self::Constant(_) => true,
            Self::Table(table) => {
                let [low, high] = table.range(NM_MIN, NM_MAX);
                low == high
            }
            Self::Blackbody { scale, .. } => *scale == 0.0,
            Self::Sigmoid {
                coefficients: [_, linear, quadratic],
                scale,
                d65,
            } => *scale == 0.0 || (!d65 && *linear == 0.0 && *quadratic == 0.0),
        }
    }

    /// Intervals over which the spectrum goes linearly from one value to another, nm: a single
    /// wavelength where it jumps. Smooth spectra have none.
    pub fn rises(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Table(table) => table.rises(),
            Self::Constant(_) | Self::Blackbody { .. } | Self::Sigmoid { .. } => Vec::new(),
        }
    }

    /// Wavelengths strictly between `low` and `high` where the spectrum has a kink or a jump.
    fn kinks_between(&self, low: f64, high: f64) -> &[f64] {
        match self {
            Self::Table(table) => table.nodes_between(low, high),
            Self::Sigmoid { d65: true, .. } => illuminant::d65().nodes_between(low, high),
            Self::Constant(_) | Self::Blackbody { .. } | Self::Sigmoid { .. } => &[],
        }
    }
}

fn sorted([a, b]: [f64; 2]) -> [f64; 2] {
    [a.min(b), a.max(b)]
}
