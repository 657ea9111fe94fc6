//! From needs and wishes to decisions, in one table.

use super::PlanError;
use super::extent::{self, smallest_gap, worst_error};
use super::needs::{everything, needs};
use crate::integrate::model::Needs;
use crate::math::affine::Affine;
use crate::math::lanes::Scalar;
use crate::sample::replicates::Replicates;
use crate::scene::{PrecisionChoice, Scene};
use crate::shape::{Placed, ShapeKind};

/// Arithmetic of the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// f32 × 16.
    Single,
    /// f64 × 8.
    Double,
}

/// Wavelengths per path where the scene does not say.
pub const DEFAULT_WAVELENGTHS: u32 = 8;
/// Share of a pixel's width that single precision may blur.
pub const PIXEL_SHARE: f64 = 1e-2;
/// Share of the smallest gap between objects that it may blur. A half would keep every point on
/// its side of the gap; an eighth of that keeps what is seen through it, too, as errors have
/// either sign and hardly ever their worst size.
pub const GAP_SHARE: f64 = 1.0 / 16.0;

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
    /// The numbers decide.
    Measured {
        /// The bound in single precision beside the pixel.
        error: extent::Error,
        /// Smallest gap between objects, if any.
        gap: Option<f64>,
    },
}

/// Why single precision would not have been taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Doubt {
    /// The bound of its error is not small enough.
    Bound {
        /// It, beside the pixel.
        error: extent::Error,
        /// Smallest gap between objects, if any.
        gap: Option<f64>,
    },
    /// Hits on implicit surfaces are rounded to it, and nobody knows how close their sheets are.
    Implicit {
        /// The bound of its error.
        error: extent::Error,
    },
}

/// What is built for a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choices {
    /// What can happen.
    pub needs: Needs,
    /// Whether everything was switched on.
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
    let error = worst_error(scene, f32::ROUNDOFF, inverse);
    let gap = smallest_gap(scene);
    let suffices = error.position <= PIXEL_SHARE * error.pixel
        && gap.is_none_or(|gap| error.position <= GAP_SHARE * gap);
    let (precision, precision_reason) = match scene.image.precision {
        PrecisionChoice::F32 => {
            let doubt = if needs(scene).implicit {
                Some(Doubt::Implicit { error })
            } else {
                (!suffices).then_some(Doubt::Bound { error, gap })
            };
            (Precision::Single, PrecisionReason::Asked { doubt })
        }
        PrecisionChoice::F64 => (Precision::Double, PrecisionReason::Asked { doubt: None }),
        PrecisionChoice::Auto if needs(scene).implicit => {
            (Precision::Double, PrecisionReason::Implicit)
        }
        PrecisionChoice::Auto => (
            if suffices {
                Precision::Single
            } else {
                Precision::Double
            },
            PrecisionReason::Measured { error, gap },
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
        needs: if full { everything() } else { needs(scene) },
        full,
        precision,
        precision_reason,
        wavelengths,
        replicates,
    })
}

/// The inverse of a map, rounded from double-double.
fn inverse(to_world: &Affine) -> Option<Affine> {
    Some(Placed::new(ShapeKind::Plane, to_world).ok()?.inverse())
}
