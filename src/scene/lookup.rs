//! Spectra and refractive indices that go by a name.

use crate::spectrum::ior::RefractiveIndex;
use crate::spectrum::{Spectrum, Table};

/// Names of the spectra that need no definition.
pub(super) const SPECTRA: &[&str] = &["D65", "E"];

/// A spectrum by its standard name.
pub(super) fn spectrum(name: &str, scale: f64) -> Option<Spectrum> {
    match name {
        "E" => Some(Spectrum::Constant(scale)),
        _ => None,
    }
}

/// A glass by its catalogue name.
pub(super) fn glass(name: &str) -> Option<RefractiveIndex> {
    (name == "N-BK7").then_some(RefractiveIndex::Sellmeier {
        b: [1.039_612_12, 0.231_792_344, 1.010_469_45],
        c: [0.006_000_698_67, 0.020_017_914_4, 103.560_653],
    })
}

/// The names [`glass`] knows.
pub(super) fn glass_names() -> &'static [&'static str] {
    &["N-BK7"]
}

/// A metal by its symbol.
pub(super) fn metal(_name: &str) -> Option<RefractiveIndex> {
    None
}

/// The names [`metal`] knows.
pub(super) fn metal_names() -> &'static [&'static str] {
    &[]
}

/// A reflectance with this colour (linear Rec. 709).
pub(super) fn rgb_reflectance(rgb: [f64; 3]) -> Spectrum {
    Spectrum::Constant(0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2])
}

/// An emission with this colour (linear Rec. 709).
pub(super) fn rgb_emission(rgb: [f64; 3]) -> Spectrum {
    rgb_reflectance(rgb)
}

/// Smallest and largest value.
pub(super) fn spectrum_bounds(spectrum: &Spectrum) -> (f64, f64) {
    match spectrum {
        Spectrum::Constant(value) => (*value, *value),
        Spectrum::Table(Table { values, .. }) => values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(*v), high.max(*v))
            }),
        Spectrum::Blackbody { scale, .. } => (scale.min(0.0), scale.max(0.0) * f64::INFINITY),
    }
}
