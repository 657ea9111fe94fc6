//! What is built for a scene: precision, wavelengths, replicates.

use super::PlanError;
use super::bounds::Blur;
use super::contents::is_implicit;
pub use crate::math::instructions::Precision;
use crate::math::lanes::Scalar;
use crate::sample::replicates::Replicates;
use crate::scene::{PrecisionChoice, Scene};

/// Wavelengths per path where the scene does not say.
pub const DEFAULT_WAVELENGTHS: u32 = 8;

/// What is built for a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choices {
    /// Whether the loop keeps what the scene does not need.
    pub full: bool,
    /// Arithmetic of the loop.
    pub precision: Precision,
    /// Whether the scene names it.
    pub asked: bool,
    /// Whether there are implicit surfaces: hits on them are certified in double, and nobody knows how
    /// close their sheets are.
    pub implicit: bool,
    /// What single precision may blur.
    pub blur: Blur,
    /// Wavelengths per path.
    pub wavelengths: u32,
    /// Independent scrambles.
    pub replicates: Replicates,
}

impl Choices {
    /// Whether the loop may run in single precision.
    pub fn single_suffices(&self) -> bool {
        !self.implicit && self.blur.is_small()
    }
}

/// Decides what is built for a scene; `full` keeps what it does not need.
///
/// # Errors
/// [`PlanError::Wavelengths`] for a count that the loop is not compiled for.
pub fn choose(scene: &Scene, full: bool) -> Result<Choices, PlanError> {
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
    let mut choices = Choices {
        full,
        precision: Precision::Single,
        asked: scene.image.precision != PrecisionChoice::Auto,
        implicit: is_implicit(scene),
        blur: Blur::new(scene, f32::ROUNDOFF),
        wavelengths,
        replicates,
    };
    let single = match scene.image.precision {
        PrecisionChoice::Auto => choices.single_suffices(),
        asked => asked == PrecisionChoice::F32,
    };
    if !single {
        choices.precision = Precision::Double;
    }
    Ok(choices)
}
