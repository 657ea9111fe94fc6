//! The parameters of a material: as a scene file gives them, and as the loop reads them.

use glam::DVec3;

use super::MaterialKind;
use crate::declare::Value;
use crate::math::lanes::Scalar;
use crate::spectrum::Spectrum;

/// Most spectra of a material.
pub const SPECTRA: usize = 2;
/// Most numbers of a material.
pub const NUMBERS: usize = 3;

/// How a surface scatters: a material, and its parameters in the order of its
/// [`Declaration`](crate::declare::Declaration).
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    pub kind: MaterialKind,
    pub values: Vec<Value>,
}

/// A [`Surface`] as the loop reads it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record<T> {
    /// The material that scatters.
    pub kind: MaterialKind,
    /// The material that chooses among the spectra by the place, if one does.
    pub texture: Option<MaterialKind>,
    /// Where its spectra stand in the bank.
    pub spectra: [u32; SPECTRA],
    pub numbers: [T; NUMBERS],
    /// Refraction disperses.
    pub disperses: bool,
}

impl Surface {
    /// The surface in the words of `info`.
    pub fn words(&self) -> String {
        let name = self.kind.words();
        if self.disperses() {
            format!("dispersive {name}")
        } else {
            name.to_owned()
        }
    }

    /// Whether wavelengths part where it refracts them.
    pub fn disperses(&self) -> bool {
        let disperses = |value: &Value| matches!(value, Value::Index(index) if index.disperses());
        self.kind.refracts() && self.values.iter().any(disperses)
    }

    /// Its spectra, other than refractive indices.
    pub fn spectra(&self) -> impl Iterator<Item = &Spectrum> {
        self.values.iter().filter_map(Value::spectrum)
    }

    /// Its record, on an object of this size over its canonical shape. `place` puts a value's spectra
    /// (n and k of an index) into the bank and says where they stand.
    pub fn record<T: Scalar>(
        &self,
        size: DVec3,
        place: impl FnMut(&Value) -> Vec<u32>,
    ) -> Record<T> {
        let mut spectra = [0; SPECTRA];
        let starts = self.values.iter().flat_map(place);
        for (spectrum, start) in spectra.iter_mut().zip(starts) {
            *spectrum = start;
        }
        let numbers: Vec<f64> = self.values.iter().filter_map(Value::number).collect();
        let texture_of = self.kind.texture_of();
        Record {
            kind: texture_of.unwrap_or(self.kind),
            texture: texture_of.map(|_| self.kind),
            spectra,
            numbers: self.kind.numbers(&numbers, size).map(T::from_f64),
            disperses: self.disperses(),
        }
    }
}
