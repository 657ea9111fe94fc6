//! The unit sphere in lanes.

use super::{LaneRay, LaneShape, LaneSurface, Span};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;

/// The discriminant from the foot of the perpendicular (Haines, Günther and Akenine-Möller, "Precision
/// Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7, 2019).
///
/// Let e = E + |t₀| D with t₀ the foot's parameter, and q = D/|d|, the relative error of the
/// direction, below ⅛. The foot f moves across the ray by δo + t₀ δd, at most √3 e; and along it,
/// because turning the ray moves the foot of a line that passes the centre at distance |f|, by at
/// most 4e + 3q|f| (√3/(1 − √3/8)² = 2.8), which enters |f|² only squared and, by f · δd, once
/// more times q: so |f|² is within (8e + 8u + 64q²) max(1, |f|²) + 16 e² of its exact value. Where
/// q ≥ ⅛ that is more than 1 and more than |f|², and nothing is decided.
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
    let q = dd * inverse_length;
    let relative = (q * q).mul_add(l.real(64.0), e.mul_add(l.real(8.0), l.real(8.0 * u)));
    let c_error = (e * e).mul_add(l.real(16.0), relative * squared.max(l.real(1.0)));
    let root = c.max(l.real(0.0)).sqrt();
    let half = root * inverse_length;
    // δt₀ ≤ (4e + 3q|f|)/|d|, δ√c ≤ δc/√c when c > δc, and 1/|d| is off by 3q of itself, where
    // |f| and √c are below 1; then rounding.
    let along = q.mul_add(l.real(6.0), e * l.real(4.0));
    let error =
        (c_error / root + along).mul_add(inverse_length, (foot_t.abs() + half) * l.real(8.0 * u));
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
