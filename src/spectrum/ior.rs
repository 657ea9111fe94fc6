//! Refractive indices n(λ) and n + ik.

use super::Spectrum;

/// A refractive index as a function of wavelength.
#[derive(Debug, Clone, PartialEq)]
pub enum RefractiveIndex {
    /// The same n at every wavelength.
    Constant(f64),
    /// n = A + B/λ² + C/λ⁴ …, λ in µm (Cauchy 1830).
    Cauchy(Vec<f64>),
    /// n² = 1 + Σ Bᵢ λ²/(λ² − Cᵢ), λ in µm (Sellmeier 1871); C in µm².
    Sellmeier {
        /// Strengths.
        b: [f64; 3],
        /// Squared resonance wavelengths, µm².
        c: [f64; 3],
    },
    /// Measured n and k.
    Complex {
        /// Real part n.
        n: Spectrum,
        /// Extinction coefficient k.
        k: Spectrum,
    },
}
