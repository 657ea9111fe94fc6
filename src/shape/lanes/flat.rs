//! Rectangle, disk and plane in lanes: z = 0 and a test of where.

use super::{LaneRay, LaneShape, Span};
use crate::math::lanes::{Lanes, Real, Scalar, inlined};

/// The part of z = 0 that a flat shape covers.
pub trait Outline {
    /// Whether (x, y), each within `error`, is certainly inside and certainly outside.
    fn contains<L: Lanes>(l: L, x: L::Real, y: L::Real, error: [L::Real; 2]) -> (L::Mask, L::Mask);
}

/// |x| ≤ 1, |y| ≤ 1.
pub struct Rectangle;

impl Outline for Rectangle {
    #[inline(always)]
    fn contains<L: Lanes>(
        l: L,
        x: L::Real,
        y: L::Real,
        [ex, ey]: [L::Real; 2],
    ) -> (L::Mask, L::Mask) {
        let one = l.real(1.0);
        let (ax, ay) = (x.abs(), y.abs());
        (
            (ax + ex).lt(one) & (ay + ey).lt(one),
            (ax - ex).gt(one) | (ay - ey).gt(one),
        )
    }
}

/// x² + y² ≤ 1.
pub struct Disk;

impl Outline for Disk {
    #[inline(always)]
    fn contains<L: Lanes>(
        l: L,
        x: L::Real,
        y: L::Real,
        [ex, ey]: [L::Real; 2],
    ) -> (L::Mask, L::Mask) {
        let one = l.real(1.0);
        let squared = x.mul_add(x, y * y);
        // |(x+δ)² − x²| ≤ (2|x| + e) e, and 4u for the arithmetic.
        let two = l.real(2.0);
        let error = (x.abs().mul_add(two, ex) * ex
            + y.abs().mul_add(two, ey) * ey
            + squared * l.real(4.0 * <L::Scalar as Scalar>::ROUNDOFF))
            * l.real(1.0 + 1e-6);
        ((squared + error).lt(one), (squared - error).gt(one))
    }
}

/// Everything.
pub struct Plane;

impl Outline for Plane {
    #[inline(always)]
    fn contains<L: Lanes>(
        l: L,
        _x: L::Real,
        _y: L::Real,
        _error: [L::Real; 2],
    ) -> (L::Mask, L::Mask) {
        (l.mask(true), l.mask(false))
    }
}

/// t = −o_z/d_z within 2 (E_z + |t| D_z)/|d_z| + 4u|t| (first order, doubled for the rest while
/// D_z ≤ |d_z|/4); x and y within |d| δt + 2 (E + |t| D) + 4u of the larger of their rows, where
/// 4u stands for 4u|x|: it only matters where |x| is about 1.
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
    let across = distance.mul_add(d, e).mul_add(two, l.real(4.0 * u));
    let coordinate = inlined(
        #[inline(always)]
        |i: usize| {
            let slope = inverse.row_dot(l, i, ray.direction);
            let value = slope.mul_add(t, inverse.row_point(l, i, ray.origin));
            (value, slope.abs().mul_add(error, across))
        },
    );
    let ((x, x_error), (y, y_error)) = (coordinate(0), coordinate(1));
    let (inside, outside) = O::contains(l, x, y, [x_error, y_error]);
    Span {
        near: t,
        far: t,
        error,
        hit: bounded & inside,
        miss: bounded & outside,
    }
}
