//! Implicit surfaces f(x, y, z) = 0.

pub mod along;
pub mod baseline;
pub mod certified;
pub mod clip;
pub mod enclosed;
pub mod placed;

use std::sync::Arc;

use glam::DVec3;

use crate::field::expression::Expression;

/// The zeros of a field within a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Implicit {
    /// The named surface it is, if it is one.
    pub name: Option<&'static str>,
    /// The field, negative inside, in object coordinates.
    pub field: Arc<Expression>,
    /// The clip box in object coordinates: lower and upper corner.
    pub inside: [DVec3; 2],
    /// Where the box cuts the inside of the surface, its faces belong to the surface.
    pub closed: bool,
    pub finder: FinderChoice,
    /// Steps along the clipped ray, for the finder that steps.
    pub steps: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FinderChoice {
    #[default]
    Auto,
    /// Equal steps, a change of sign, bisection: the report's method, which proves nothing.
    SignChange,
    /// Steps as long as a proved Lipschitz bound allows.
    SphereTrace,
    /// Interval enclosures, for any field.
    Interval,
    /// Isolation of the roots of a polynomial along the ray.
    Polynomial,
}

impl FinderChoice {
    /// All finders by the names they have in scene files.
    pub const NAMES: &'static [(&'static str, Self)] = &[
        ("auto", Self::Auto),
        ("sign-change", Self::SignChange),
        ("sphere-trace", Self::SphereTrace),
        ("interval", Self::Interval),
        ("polynomial", Self::Polynomial),
    ];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        let known = Self::NAMES.iter().find(|(_, finder)| *finder == self);
        known.map_or("auto", |(name, _)| name)
    }
}
