//! Implicit surfaces f(x, y, z) = 0.

pub mod along;
pub mod baseline;
pub mod certified;
pub mod clip;
pub mod enclosed;
pub mod finder;
pub mod placed;

use std::sync::Arc;

use glam::DVec3;

use crate::field::expression::Expression;

pub use finder::FinderChoice;

/// The zeros of a field within a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Implicit {
    /// Its name in scene files, where it is a named surface.
    pub name: Option<&'static str>,
    /// The field, negative inside, in object coordinates.
    pub field: Arc<Expression>,
    /// The clip box in object coordinates: lower and upper corner.
    pub inside: [DVec3; 2],
    /// Where the box cuts the inside of the surface, its faces belong to the surface.
    pub closed: bool,
    pub finder: FinderChoice,
    /// Steps along the clipped ray, for [`FinderChoice::SignChange`].
    pub steps: u32,
}
