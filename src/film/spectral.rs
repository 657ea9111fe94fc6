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
pub fn channel_name(nm: f64) -> String {
    let digits = format!("{nm:.6}").replace('.', ",");
    format!("S0.{digits}nm")
}

/// The wavelength in nm of a channel of unpolarised radiance; `None` for other channels.
pub fn wavelength(channel_name: &str) -> Option<f64> {
    let digits = channel_name.strip_prefix("S0.")?.strip_suffix("nm")?;
    let nm: f64 = digits.replace(',', ".").parse().ok()?;
    (nm.is_finite() && nm > 0.0).then_some(nm)
}

/// A bin of a spectral picture: the box between the midpoints to its neighbours.
#[derive(Debug, Clone, PartialEq)]
pub struct Bin {
    /// Nominal wavelength, nm.
    pub nm: f64,
    /// Spectral radiance, W·m⁻²·sr⁻¹·nm⁻¹, one value a pixel.
    pub values: Vec<f32>,
    /// Standard error of each value, where it is known.
    pub standard_errors: Option<Vec<f32>>,
}

impl Picture {
    /// Adds bins as channels, with the attributes of the spectral layout.
    pub fn push_spectral(&mut self, bins: impl IntoIterator<Item = Bin>) {
        let layout = [
            ("spectralLayoutVersion", "1.0"),
            ("emissiveUnits", EMISSIVE_UNITS),
        ];
        let text =
            |(name, value): (&str, &str)| (name.to_owned(), Attribute::Text(value.to_owned()));
        self.attributes.extend(layout.map(text));
        for bin in bins {
            let name = channel_name(bin.nm);
            if let Some(errors) = bin.standard_errors {
                let name = names::in_layer(names::STANDARD_ERROR, &name);
                self.channels.push(Channel::float(name, errors));
            }
            self.channels.push(Channel::float(name, bin.values));
        }
    }
}
