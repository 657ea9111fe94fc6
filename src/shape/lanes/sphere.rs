//! The unit sphere in lanes.

use super::{LaneRay, LaneShape, LaneSurface, Span};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;

/// The discriminant from the foot of the perpendicular (Haines, Günther and Akenine-Möller, "Precision
/// Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7, 2019).
///
/// With e = E + |t₀| D, t₀ the foot's parameter, the foot f is off by at most √3 e + u|f| across
/// the ray, and by 4e along it, which enters |f|² only squared; so |f|² is within
/// (8e + 8u) max(1, |f|²) + 16 e² of its exact value (2√3 · |f| · e < 8 e max(1, |f|²)).
#[inline(always)]
pub fn span<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, ray: &LaneRay<L>) -> Span<L> {
    let u = <L::Scalar as Scalar>::ROUNDOFF;
    let o = shape.inverse.point(l, ray.origin);
    let d = shape.inverse.vector(l, ray.direction);
    let inverse_square = l.real(1.0) / d.length_squared();
    let inverse_length = inverse_square.sqrt();
    let foot_t = -(o.dot(d) * inverse_square);
    let foot = o.along(d, foot_t);
    let squared = foot.length_squared();
    let c = l.real(1.0) - squared;
    let (e0, dd) = shape.largest_errors(l, ray, 3);
    let e = foot_t.abs().mul_add(dd, e0);
    let c_error = (e * e).mul_add(
        l.real(16.0),
        e.mul_add(l.real(8.0), l.real(8.0 * u)) * squared.max(l.real(1.0)),
    );
    let root = c.max(l.real(0.0)).sqrt();
    let half = root * inverse_length;
    // δt ≤ (4e + δc/(2√c))/|d| + rounding; δc/√c is also at least twice δ√c when c > δc.
    let error = (c_error / root + e.mul_add(l.real(4.0), l.real(0.0)))
        .mul_add(inverse_length, (foot_t.abs() + half) * l.real(8.0 * u));
    Span {
        near: foot_t - half,
        far: foot_t + half,
        error,
        hit: c.gt(c_error),
        miss: c.lt(-c_error),
    }
}

/// The canonical point scaled to length 1, which is also the canonical normal.
#[inline(always)]
pub fn surface<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, p: Vec3<L::Real>) -> LaneSurface<L> {
    let local = shape.inverse.point(l, p).normalized(l);
    LaneSurface {
        point: shape.forward.point(l, local),
        normal: shape.inverse.transposed(l, local).normalized(l),
    }
}
