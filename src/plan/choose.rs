//! From a scene and the user's wishes to decisions, in one table.

use super::PlanError;
use super::bounds::Blur;
use super::contents::is_implicit;
pub use crate::math::instructions::Precision;
use crate::math::lanes::Scalar;
use crate::sample::replicates::Replicates;
use crate::scene::{PrecisionChoice, Scene};

/// Wavelengths per path where the scene does not say.
pub const DEFAULT_WAVELENGTHS: u32 = 8;

/// Why a precision was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PrecisionReason {
    /// The user said so.
    Asked {
        /// What speaks against it.
        doubt: Option<Doubt>,
    },
    /// Hits on implicit surfaces are certified in double.
    Implicit,
    /// What single precision may blur decides.
    Measured(Blur),
}

/// Why single precision would not have been taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Doubt {
    /// What it may blur is not small enough.
    Blur(Blur),
    /// Hits on implicit surfaces are rounded to it, and nobody knows how close their sheets are.
    Implicit(Blur),
}

/// What is built for a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choices {
    /// Whether the loop keeps what the scene does not need.
    pub full: bool,
    /// Arithmetic of the loop.
    pub precision: Precision,
    /// Why.
    pub precision_reason: PrecisionReason,
    /// Wavelengths per path.
    pub wavelengths: u32,
    /// Independent scrambles.
    pub replicates: Replicates,
}

/// Decides.
///
/// # Errors
/// [`PlanError::Wavelengths`] for a count that the loop is not compiled for.
pub fn choose(scene: &Scene, full: bool) -> Result<Choices, PlanError> {
    let blur = Blur::new(scene, f32::ROUNDOFF);
    let (precision, precision_reason) = match scene.image.precision {
        PrecisionChoice::F32 => {
            let doubt = if is_implicit(scene) {
                Some(Doubt::Implicit(blur))
            } else {
                (!blur.is_small()).then_some(Doubt::Blur(blur))
            };
            (Precision::Single, PrecisionReason::Asked { doubt })
        }
        PrecisionChoice::F64 => (Precision::Double, PrecisionReason::Asked { doubt: None }),
        PrecisionChoice::Auto if is_implicit(scene) => {
            (Precision::Double, PrecisionReason::Implicit)
        }
        PrecisionChoice::Auto => (
            if blur.is_small() {
                Precision::Single
            } else {
                Precision::Double
            },
            PrecisionReason::Measured(blur),
        ),
    };
    let wavelengths = scene.image.wavelengths.unwrap_or(DEFAULT_WAVELENGTHS);
    if !matches!(wavelengths, 4 | 8) {
        return Err(PlanError::Wavelengths { count: wavelengths });
    }
    let replicates = match scene.image.replicates {
        Some(count) => Replicates::Fixed(count),
        // Points that are cut for a known number of samples need a known number of replicates.
        None if scene.image.sampler.needs_count() => {
            Replicates::Fixed(Replicates::Growing.count(scene.image.spp))
        }
        None => Replicates::Growing,
    };
    Ok(Choices {
        full,
        precision,
        precision_reason,
        wavelengths,
        replicates,
    })
}
