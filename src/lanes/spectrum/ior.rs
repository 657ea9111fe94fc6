//! Refractive indices n(λ) and n + ik.
//!
//! Wavelengths are in nm; dispersion formulas follow their catalogues and count in µm. Measured
//! media are found by name: [`named_glass`] and [`named_metal`].

use thiserror::Error;

use super::{NM_MAX, NM_MIN, Spectrum};

pub use super::glass::{glass_names, named_glass};
pub use super::metal::{metal_names, named_metal};

/// A refractive index as a function of wavelength.
#[derive(Debug, Clone, PartialEq)]
pub enum RefractiveIndex {
    /// The same n at every wavelength.
    Constant(f64),
    /// n = A + B/λ² + C/λ⁴ …, λ in µm (Cauchy 1830).
    Cauchy(Vec<f64>),
    /// n² = 1 + Σ Bᵢ λ²/(λ² − Cᵢ), λ in µm (Sellmeier 1871).
    Sellmeier {
        b: [f64; 4],
        /// Squared resonance wavelengths, µm².
        c: [f64; 4],
    },
    /// Measured: real part n and extinction coefficient k.
    Complex { n: Spectrum, k: Spectrum },
}

/// A refractive index that no medium can have.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum IorError {
    /// The real part is zero, negative, infinite or no number.
    #[error("the refractive index must be positive, but at {nm} nm it is {n}")]
    Index { nm: f64, n: f64 },
    /// The extinction coefficient is negative, infinite or no number.
    #[error("the extinction coefficient must not be negative, but at {nm} nm it is {k}")]
    Extinction { nm: f64, k: f64 },
}

impl RefractiveIndex {
    /// Sellmeier's formula with three terms, as glasses have it; C in µm².
    pub const fn sellmeier([b1, b2, b3]: [f64; 3], [c1, c2, c3]: [f64; 3]) -> Self {
        Self::Sellmeier {
            b: [b1, b2, b3, 0.0],
            c: [c1, c2, c3, 0.0],
        }
    }

    /// The real part n at wavelength `nm`.
    pub fn n(&self, nm: f64) -> f64 {
        let squared = (nm * 1e-3) * (nm * 1e-3);
        match self {
            Self::Constant(n) => *n,
            Self::Cauchy(coefficients) => coefficients
                .iter()
                .rev()
                .fold(0.0, |sum, coefficient| sum / squared + coefficient),
            Self::Sellmeier { b, c } => {
                let terms = b.iter().zip(c).map(|(b, c)| b * squared / (squared - c));
                (1.0 + terms.sum::<f64>()).sqrt()
            }
            Self::Complex { n, .. } => n.value(nm),
        }
    }

    /// n and the extinction coefficient k ≥ 0 at wavelength `nm`.
    pub fn n_k(&self, nm: f64) -> (f64, f64) {
        match self {
            Self::Complex { n, k } => (n.value(nm), k.value(nm)),
            other => (other.n(nm), 0.0),
        }
    }

    /// Whether n changes with wavelength, so that refracted paths part.
    pub fn disperses(&self) -> bool {
        match self {
            Self::Constant(_) => false,
            Self::Cauchy(coefficients) => coefficients.iter().skip(1).any(|&c| c != 0.0),
            // A term without resonance (C = 0) is a constant.
            Self::Sellmeier { b, c } => b.iter().zip(c).any(|(&b, &c)| b != 0.0 && c != 0.0),
            Self::Complex { n, .. } => !n.is_constant(),
        }
    }

    /// Checks that n > 0 and k ≥ 0 at every whole nm of 360–830 nm.
    ///
    /// # Errors
    /// The first wavelength at which that is not so.
    pub fn check(&self) -> Result<(), IorError> {
        for whole in NM_MIN as u32..=NM_MAX as u32 {
            let nm = f64::from(whole);
            let (n, k) = self.n_k(nm);
            if !(n.is_finite() && n > 0.0) {
                return Err(IorError::Index { nm, n });
            }
            if !(k.is_finite() && k >= 0.0) {
                return Err(IorError::Extinction { nm, k });
            }
        }
        Ok(())
    }
}
