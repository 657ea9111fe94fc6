//! How far off a hit on an object may be.

use glam::DVec3;

use super::Site;

/// Roundings of the numbers that a hit comes from. Canonical coordinates of points are off by 6 of
/// them (`shape::lanes`), and the way back to the world by 4 (a rounded coefficient and three fused
/// operations). In world coordinates a plane's normal, height and foot take 9, a ball's centre,
/// radius and point 8. Directions of camera rays are off by 8 across the ray: 3 from the place on
/// the picture and the size of a pixel, 1 from the axes, 3 from the sums and 1 from the point.
const ROUNDINGS: f64 = 10.0;

/// Bounds on the error in each coordinate, as a number that does not depend on where the hit is, and
/// one that grows with the largest coordinate L of the ray's origin and of the hit.
///
/// Canonical coordinates are M⁻¹p + b, rounded from terms of at most |M⁻¹|L + |b|, and c more where
/// the shape is no set of planes, whose equations are about coordinates of size c, whichever of them
/// are small at the hit. Carried back by |M|, the error is ROUNDINGS · u · |M|(|M⁻¹|L + |b| + c).
/// Since |M||M⁻¹| ≥ 1 and |M||b| ≥ |t| for M's translation t, this holds for what is rounded in world
/// coordinates, too.
#[derive(Debug)]
pub struct Error {
    fixed: [f64; 3],
    growing: [f64; 3],
}

impl Error {
    /// On an object, in arithmetic of unit roundoff `roundoff`.
    pub fn new(site: &Site, roundoff: f64) -> Self {
        let flat = site.kind.is_some_and(|kind| kind.round().is_none());
        let size = match site.corners {
            Some([low, high]) if !flat => low.abs().max(high.abs()),
            _ => DVec3::ZERO,
        };
        let offset = site.inverse.translation().abs() + size;
        let rows = site.inverse.rows;
        let sums = DVec3::from_array(rows.map(|r| r[0].abs() + r[1].abs() + r[2].abs()));
        let back = |local: DVec3| {
            site.to_world
                .rows
                .map(|row| ROUNDINGS * roundoff * DVec3::from_slice(&row[..3]).abs().dot(local))
        };
        Self {
            fixed: back(offset),
            growing: back(sums),
        }
    }

    /// Where coordinates are no larger than `reach`.
    pub fn at(&self, reach: f64) -> f64 {
        let each = self.fixed.iter().zip(self.growing);
        each.map(|(fixed, growing)| fixed + growing * reach)
            .fold(0.0, f64::max)
    }

    /// As an angle from the camera, whose rays begin within `start` of it. At the end of a path of
    /// length L no coordinate is above start + L, and (fixed + growing (start + L))/L is largest where
    /// the path is shortest: the object's `nearest` point, seen directly.
    pub fn angle(&self, nearest: f64, start: f64) -> f64 {
        let each = self.fixed.iter().zip(self.growing);
        each.map(|(fixed, growing)| {
            let near = fixed + growing * start;
            let near = if near > 0.0 { near / nearest } else { 0.0 };
            near + growing
        })
        .fold(0.0, f64::max)
    }
}
