//! How surfaces scatter light.

pub mod fresnel;

/// The materials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum MaterialKind {
    /// Nothing is reflected.
    Black = 0,
    /// Lambertian.
    Diffuse = 1,
    /// Lambertian, of two albedos.
    Checkerboard = 2,
    /// Smooth conductor, Fresnel.
    Conductor = 3,
    /// Mirror of constant reflectance.
    Mirror = 4,
    /// Smooth dielectric.
    Glass = 5,
}

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
