//! The cube [-1, 1]³ in lanes.

use super::{LaneRay, LaneShape, Span, reach, slab};
use crate::math::lanes::{Lanes, Real, inlined};
use crate::math::vec3::Vec3;

/// Three slabs (Kay and Kajiya 1986), each crossing with its bound; the cube is hit for certain
/// when the latest possible entry is before the earliest possible exit.
#[inline(always)]
pub fn span<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, ray: &LaneRay<L>) -> Span<L> {
    let o = shape.inverse.point(l, ray.origin);
    let d = shape.inverse.vector(l, ray.direction);
    let axis = inlined(
        #[inline(always)]
        |i, o_i, d_i| {
            let e = shape.origin_error(l, ray, i);
            let dd = l.splat(shape.direction_error[i]);
            slab(
                l,
                o_i,
                d_i,
                e,
                dd,
                #[inline(always)]
                || reach(l, o, d),
            )
        },
    );
    let (x, y, z) = (axis(0, o.x, d.x), axis(1, o.y, d.y), axis(2, o.z, d.z));
    let near = x.near.max(y.near).max(z.near);
    let far = x.far.min(y.far).min(z.far);
    let latest_entry = (x.near + x.error)
        .max(y.near + y.error)
        .max(z.near + z.error);
    let earliest_entry = (x.near - x.error)
        .max(y.near - y.error)
        .max(z.near - z.error);
    let earliest_exit = (x.far - x.error).min(y.far - y.error).min(z.far - z.error);
    let latest_exit = (x.far + x.error).min(y.far + y.error).min(z.far + z.error);
    let lost = x.lost | y.lost | z.lost;
    let outside = x.outside | y.outside | z.outside;
    let error = (latest_entry - near)
        .max(near - earliest_entry)
        .max((latest_exit - far).max(far - earliest_exit));
    Span {
        near,
        far,
        error,
        hit: latest_entry.lt(earliest_exit) & !lost & !outside,
        miss: outside | (earliest_entry.gt(latest_exit) & !lost),
    }
}

/// The face is that of the largest coordinate.
#[inline(always)]
pub fn surface<L: Lanes>(l: L, local: Vec3<L::Real>) -> (Vec3<L::Real>, Vec3<L::Real>) {
    let (ax, ay, az) = (local.x.abs(), local.y.abs(), local.z.abs());
    let one = l.real(1.0);
    let zero = l.real(0.0);
    let on_x = ax.ge(ay) & ax.ge(az);
    let on_y = !on_x & ay.ge(az);
    let on_z = !on_x & !on_y;
    let face = Vec3::new(
        one.copysign(local.x),
        one.copysign(local.y),
        one.copysign(local.z),
    );
    let point = Vec3::new(
        l.select(on_x, face.x, local.x),
        l.select(on_y, face.y, local.y),
        l.select(on_z, face.z, local.z),
    );
    let normal = Vec3::new(
        l.select(on_x, face.x, zero),
        l.select(on_y, face.y, zero),
        l.select(on_z, face.z, zero),
    );
    (point, normal)
}
