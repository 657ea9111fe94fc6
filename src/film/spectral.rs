//! The spectral layout of OpenEXR: one channel a wavelength.
//!
//! A. Fichet, R. Pacanowski, A. Wilkie, "An OpenEXR Layout for Spectral Images", Journal of
//! Computer Graphics Techniques 10(3), 2021: emissive spectra are channels `S0.<λ>nm` with a
//! *comma* as decimal sign (the dot separates layers); string attributes name the version of
//! the layout and the unit.

use super::{Attribute, Channel, Picture, names};

/// The unit as the layout's own library and pbrt-v4 write it. The values are spectral radiance,
/// a mean over the bin's wavelengths; "per nm" is implied by the channel names.
const EMISSIVE_UNITS: &str = "W.m^-2.sr^-1";

/// The name of the channel of unpolarised radiance at `nm` nanometres: `S0.550,000000nm`.
#[must_use]
pub fn channel_name(nm: f64) -> String {
    let digits = format!("{nm:.6}").replace('.', ",");
    format!("S0.{digits}nm")
}

/// The wavelength in nm of a channel of unpolarised radiance; `None` for other channels.
#[must_use]
pub fn wavelength(channel_name: &str) -> Option<f64> {
    let digits = channel_name.strip_prefix("S0.")?.strip_suffix("nm")?;
    let nm: f64 = digits.replace(',', ".").parse().ok()?;
    (nm.is_finite() && nm > 0.0).then_some(nm)
}

/// A bin of a spectral picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Bin {
    /// Nominal wavelength, nm.
    pub nm: f64,
    /// Relative sensitivity: wavelengths in nm and values, linear between them. Left empty, the
    /// bin is the box between the midpoints to its neighbours.
    pub sensitivity: Vec<(f64, f64)>,
    /// Spectral radiance, W·m⁻²·sr⁻¹·nm⁻¹, one value a pixel.
    pub values: Vec<f32>,
    /// Standard error of each value; left empty where it is not known.
    pub standard_errors: Vec<f32>,
}

impl Picture {
    /// Adds bins as channels, with the attributes of the spectral layout.
    pub fn push_spectral(&mut self, bins: Vec<Bin>) {
        self.attributes.push(text("spectralLayoutVersion", "1.0"));
        self.attributes.push(text("emissiveUnits", EMISSIVE_UNITS));
        for bin in bins {
            let name = channel_name(bin.nm);
            if !bin.sensitivity.is_empty() {
                self.attributes
                    .push(text(&name, &sensitivity(&bin.sensitivity)));
            }
            if !bin.standard_errors.is_empty() {
                let name = names::in_layer(names::STANDARD_ERROR, &name);
                self.channels
                    .push(Channel::float(name, bin.standard_errors));
            }
            self.channels.push(Channel::float(name, bin.values));
        }
    }
}

/// A text attribute.
fn text(name: &str, value: &str) -> (String, Attribute) {
    (name.to_owned(), Attribute::Text(value.to_owned()))
}

/// A sensitivity as the layout writes it, with decimal dots: `380nm:0.5;390nm:0.6;`.
fn sensitivity(samples: &[(f64, f64)]) -> String {
    samples
        .iter()
        .map(|(nm, value)| format!("{nm}nm:{value};"))
        .collect()
}
