//! The cube [-1, 1]³ in lanes.

use super::{LaneRay, LaneShape, LaneSurface, Span, reach, slab};
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
                || reach(l, shape, ray, o, d),
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

/// Which pair of faces a point is on: that of the largest coordinate.
#[inline(always)]
fn faces<L: Lanes>(local: Vec3<L::Real>) -> (L::Mask, L::Mask) {
    let (ax, ay, az) = (local.x.abs(), local.y.abs(), local.z.abs());
    let on_x = ax.ge(ay) & ax.ge(az);
    (on_x, !on_x & ay.ge(az))
}

/// The foot on the face's plane.
#[inline(always)]
pub fn surface<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, p: Vec3<L::Real>) -> LaneSurface<L> {
    let local = shape.inverse.point(l, p);
    let (on_x, on_y) = faces::<L>(local);
    let [px, py, pz] = &shape.planes;
    let choose = inlined(
        #[inline(always)]
        |x, y, z| l.select(on_x, x, l.select(on_y, y, z)),
    );
    let normal = Vec3::select(
        l,
        on_x,
        px.normal(l),
        Vec3::select(l, on_y, py.normal(l), pz.normal(l)),
    );
    let sign = l.real(1.0).copysign(choose(local.x, local.y, local.z));
    let middle = choose(l.splat(px.middle), l.splat(py.middle), l.splat(pz.middle));
    let half = choose(l.splat(px.half), l.splat(py.half), l.splat(pz.half));
    LaneSurface {
        point: px.onto(l, normal, p, half.mul_add(sign, middle)),
        normal: normal.scale(sign),
    }
}

/// The coordinate of the face made exact.
#[inline(always)]
pub fn snapped<L: Lanes>(l: L, local: Vec3<L::Real>) -> Vec3<L::Real> {
    let (on_x, on_y) = faces::<L>(local);
    let one = l.real(1.0);
    Vec3::new(
        l.select(on_x, one.copysign(local.x), local.x),
        l.select(on_y, one.copysign(local.y), local.y),
        l.select(on_x | on_y, local.z, one.copysign(local.z)),
    )
}
