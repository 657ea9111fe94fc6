//! A material's parameters.

use super::MaterialKind;

/// Most spectra of a material.
pub const SPECTRA: usize = 2;
/// Most numbers of a material.
pub const NUMBERS: usize = 3;

/// A material's parameters as the loop reads them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record<T> {
    /// How it scatters.
    pub kind: MaterialKind,
    /// The material that chooses among the spectra by the place, if one does.
    pub texture: Option<MaterialKind>,
    /// Where its spectra stand in the bank.
    pub spectra: [u32; SPECTRA],
    /// Its numbers.
    pub numbers: [T; NUMBERS],
    /// Refraction disperses.
    pub disperses: bool,
}
