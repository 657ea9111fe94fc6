//! The first rung: every shape in lanes, answering hit, miss or undecided.
//!
//! A ray is taken to canonical coordinates by the rounded inverse matrix. With unit roundoff u,
//! row sums Rᵢ = Σⱼ|mᵢⱼ| and s = max|o|, component i of the computed local origin is within
//! Eᵢ = 6u (Rᵢ s + |bᵢ| + 1) and that of the local direction within Dᵢ = 6u Rᵢ of the exact one
//! (four rounded coefficients and three fused operations each; the 1 pays for the shape's own
//! constants). What follows from E and D is bounded shape by shape; a lane that a bound cannot
//! decide is left to the certified ladder.

use glam::DVec3;

use crate::math::affine::Affine;
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::{Rows, Vec3};
use crate::shape::ShapeKind;
use crate::shape::flat;
use crate::shape::sphere::Ball;
use part::Part;

pub mod balls;
pub mod implicit;
pub mod part;

/// Rays of a packet; directions are unit up to rounding.
#[derive(Clone, Copy)]
pub struct LaneRay<L: Lanes> {
    /// Origins, scene units about the camera.
    pub origin: Vec3<L::Real>,
    pub direction: Vec3<L::Real>,
    /// Largest magnitude of an origin's coordinates.
    pub extent: L::Real,
    /// 1/|direction|².
    pub inverse_square: L::Real,
}

impl<L: Lanes> LaneRay<L> {
    #[inline(always)]
    pub fn new(l: L, origin: Vec3<L::Real>, direction: Vec3<L::Real>) -> Self {
        Self {
            origin,
            direction,
            extent: origin.max_abs(),
            inverse_square: l.real(1.0) / direction.length_squared(),
        }
    }
}

#[derive(Clone, Copy)]
pub struct Enclosure<L: Lanes> {
    pub low: L::Real,
    pub high: L::Real,
}

impl<L: Lanes> Enclosure<L> {
    /// x within `error`.
    #[inline(always)]
    pub fn about(x: L::Real, error: L::Real) -> Self {
        Self {
            low: x - error,
            high: x + error,
        }
    }

    #[inline(always)]
    pub fn later(self, other: Self) -> Self {
        Self {
            low: self.low.max(other.low),
            high: self.high.max(other.high),
        }
    }

    #[inline(always)]
    pub fn earlier(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.min(other.high),
        }
    }

    /// With x itself in the lanes of a mask.
    #[inline(always)]
    pub fn replaced(self, l: L, mask: L::Mask, x: L::Real) -> Self {
        Self {
            low: l.select(mask, x, self.low),
            high: l.select(mask, x, self.high),
        }
    }
}

/// Where a line enters and leaves a convex shape, with bounds.
#[derive(Clone, Copy)]
pub struct LaneSpan<L: Lanes> {
    /// Entry, where the line meets the shape.
    pub near: Enclosure<L>,
    /// Exit; that of flat shapes is the entry.
    pub far: Enclosure<L>,
    /// The line certainly meets the shape.
    pub hit: L::Mask,
    /// The line certainly misses it, or meets it only behind the origin or beyond the limit.
    pub miss: L::Mask,
    /// Which of the shape's parts it enters and leaves by, if it meets it.
    pub parts: [L::Int; 2],
}

impl<L: Lanes> LaneSpan<L> {
    /// That of a line which certainly misses.
    #[inline(always)]
    pub fn missed(l: L) -> Self {
        let nowhere = Enclosure::about(l.real(0.0), l.real(0.0));
        Self {
            near: nowhere,
            far: nowhere,
            hit: l.mask(false),
            miss: l.mask(true),
            parts: [l.int(0); 2],
        }
    }
}

#[derive(Debug, Clone, Copy)]
pub struct LaneShape<T> {
    /// Which shape; implicit surfaces are intersected elsewhere and place nothing here.
    pub kind: Option<ShapeKind>,
    /// World (about the camera) → canonical coordinates.
    pub inverse: Rows<T>,
    pub forward: Rows<T>,
    /// The faces x = ±1 of each canonical coordinate.
    pub faces: [Part<T>; 3],
    /// 6u Rᵢ.
    pub direction_error: [T; 3],
    /// 6u (|bᵢ| + 1).
    pub offset_error: [T; 3],
    /// Bounds of a flat shape's plane test, see [`flat::margins`].
    pub margins: [T; 2],
    /// A sphere that is one in the world too.
    pub ball: Option<Ball<T>>,
}

impl<T: Scalar> LaneShape<T> {
    /// Rounds a placement whose inverse is given; `reach` is the largest magnitude of a coordinate
    /// among the points that rays usually start from.
    pub fn new(kind: Option<ShapeKind>, forward: &Affine, inverse: &Affine, reach: f64) -> Self {
        // One more half unit roundoff in the bounds pays for rounding the bounds themselves.
        let unit = 6.5 * T::ROUNDOFF;
        Self {
            kind,
            inverse: Rows::from_f64(&inverse.rows),
            forward: Rows::from_f64(&forward.rows),
            faces: inverse.rows.each_ref().map(Part::faces),
            direction_error: (unit * inverse.abs().vector(DVec3::ONE))
                .to_array()
                .map(T::from_f64),
            offset_error: inverse.rows.map(|r| T::from_f64(unit * (r[3].abs() + 1.0))),
            margins: flat::margins::<T>(inverse).map(T::from_f64),
            ball: Ball::new(forward, reach),
        }
    }

    /// Eᵢ for a packet of rays.
    #[inline(always)]
    pub fn origin_error<L: Lanes<Scalar = T>>(&self, l: L, ray: &LaneRay<L>, i: usize) -> L::Real {
        ray.extent.mul_add(
            l.splat(self.direction_error[i]),
            l.splat(self.offset_error[i]),
        )
    }

    /// The largest Eᵢ and Dᵢ of the first `count` components.
    #[inline(always)]
    pub fn largest_errors<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        ray: &LaneRay<L>,
        count: usize,
    ) -> (L::Real, L::Real) {
        let mut direction = self.direction_error[0];
        let mut offset = self.offset_error[0];
        for i in 1..count {
            direction = direction.larger(self.direction_error[i]);
            offset = offset.larger(self.offset_error[i]);
        }
        let direction = l.splat(direction);
        (ray.extent.mul_add(direction, l.splat(offset)), direction)
    }

    pub fn ball(&self) -> Option<&Ball<T>> {
        match self.kind {
            Some(ShapeKind::Sphere) => self.ball.as_ref(),
            _ => None,
        }
    }
}

/// A point moved onto a surface, and the unit outward normal there (+z of flat shapes).
#[derive(Clone, Copy)]
pub struct LaneSurface<L: Lanes> {
    /// The point, scene units about the camera.
    pub point: Vec3<L::Real>,
    pub normal: Vec3<L::Real>,
}
