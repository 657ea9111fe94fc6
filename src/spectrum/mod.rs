//! Spectra: values over wavelength (nm), their data and their sources.

pub mod ior;

/// A function of wavelength.
#[derive(Debug, Clone, PartialEq)]
pub enum Spectrum {
    /// The same value at every wavelength.
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
}

/// Samples of a spectrum at increasing wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Wavelengths in nm, strictly increasing.
    pub nm: Vec<f64>,
    /// Values at those wavelengths.
    pub values: Vec<f64>,
}
