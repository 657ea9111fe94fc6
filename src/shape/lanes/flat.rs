//! Rectangle, disk and plane in lanes: z = 0 and a test of where.

use super::{LaneRay, LaneShape, Span};
use crate::math::lanes::{Lanes, Real, Scalar};

/// The part of z = 0 that a flat shape covers.
pub trait Outline {
    /// Whether (x, y), each within `error`, is certainly inside and certainly outside.
    fn contains<L: Lanes>(l: L, x: L::Real, y: L::Real, error: L::Real) -> (L::Mask, L::Mask);
}

/// |x| ≤ 1, |y| ≤ 1.
pub struct Rectangle;

impl Outline for Rectangle {
    #[inline(always)]
    fn contains<L: Lanes>(l: L, x: L::Real, y: L::Real, error: L::Real) -> (L::Mask, L::Mask) {
        let one = l.real(1.0);
        let farther = x.abs().max(y.abs());
        ((farther + error).lt(one), (farther - error).gt(one))
    }
}

/// x² + y² ≤ 1.
pub struct Disk;

impl Outline for Disk {
    #[inline(always)]
    fn contains<L: Lanes>(l: L, x: L::Real, y: L::Real, e: L::Real) -> (L::Mask, L::Mask) {
        let one = l.real(1.0);
        let squared = x.mul_add(x, y * y);
        // |(x+δ)² − x²| ≤ (2|x| + e) e, twice, and 4u for the arithmetic.
        let two = l.real(2.0);
        let error = ((x.abs() + y.abs() + e) * e * two
            + squared * l.real(4.0 * <L::Scalar as Scalar>::ROUNDOFF))
            * l.real(1.0 + 1e-6);
        ((squared + error).lt(one), (squared - error).gt(one))
    }
}

/// Everything.
pub struct Plane;

impl Outline for Plane {
    #[inline(always)]
    fn contains<L: Lanes>(l: L, _x: L::Real, _y: L::Real, _error: L::Real) -> (L::Mask, L::Mask) {
        (l.mask(true), l.mask(false))
    }
}

/// t = −o_z/d_z within 2 (E_z + |t| D_z)/|d_z| + 4u|t| (first order, doubled for the rest while
/// D_z ≤ |d_z|/4). x and y come from the world point o + t d: they are within R δt (|d| = 1, so
/// the slope is at most the row's sum R) + 2 (E + |t| D) + 4u, with E, D and R the larger of their
/// rows' and 4u for 4u|x|, which only matters where |x| is about 1.
#[inline(always)]
pub fn span<L: Lanes, O: Outline>(l: L, shape: &LaneShape<L::Scalar>, ray: &LaneRay<L>) -> Span<L> {
    let u = <L::Scalar as Scalar>::ROUNDOFF;
    let two = l.real(2.0);
    let inverse = &shape.inverse;
    let oz = inverse.row_point(l, 2, ray.origin);
    let dz = inverse.row_dot(l, 2, ray.direction);
    let z_error = l.splat(shape.direction_error[2]);
    let reciprocal = l.real(1.0) / dz;
    let t = -(oz * reciprocal);
    let distance = t.abs();
    let e = distance.mul_add(z_error, shape.origin_error(l, ray, 2)) * two;
    let error = e.mul_add(reciprocal.abs(), distance * l.real(4.0 * u));
    let bounded = dz.abs().gt(z_error * l.real(4.0));
    let (e, d) = shape.largest_errors(l, ray, 2);
    let slope = d * l.real(1.0 / (6.0 * u));
    let across = error.mul_add(slope, distance.mul_add(d, e).mul_add(two, l.real(4.0 * u)));
    let p = ray.origin.along(ray.direction, t);
    let x = inverse.row_point(l, 0, p);
    let y = inverse.row_point(l, 1, p);
    let (inside, outside) = O::contains(l, x, y, across);
    Span {
        near: t,
        far: t,
        error,
        hit: bounded & inside,
        miss: bounded & outside,
    }
}
