//! Rays of f64, as single questions ask them.

use glam::DVec3;

/// The line origin + t direction, with exactly these numbers. The direction need not be of unit
/// length; t is in units of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where t is 0, world coordinates.
    pub origin: DVec3,
    /// Not zero.
    pub direction: DVec3,
}

impl Ray {
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// Whether all numbers are finite and the direction is not zero: only such a ray hits.
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite() && self.direction.is_finite() && self.direction != DVec3::ZERO
    }
}
