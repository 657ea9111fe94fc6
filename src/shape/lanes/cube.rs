//! The cube [-1, 1]³ in lanes.

use super::{Enclosure, LaneRay, LaneShape, Span, reach, slab};
use crate::math::lanes::{Lanes, Real, inlined};
use crate::math::vec3::Vec3;

/// Three slabs (Kay and Kajiya 1986), each crossing with its bound; the cube is hit for certain
/// when the latest possible entry is before the earliest possible exit.
#[inline(always)]
pub fn span<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, ray: &LaneRay<L>) -> Span<L> {
    let row = inlined(
        #[inline(always)]
        |i: usize| shape.inverse.row(l, i, ray.origin, ray.direction),
    );
    let ((ox, dx), (oy, dy), (oz, dz)) = (row(0), row(1), row(2));
    let (o, d) = (Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz));
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
    let near = Enclosure {
        low: x.near.low.max(y.near.low).max(z.near.low),
        high: x.near.high.max(y.near.high).max(z.near.high),
    };
    let far = Enclosure {
        low: x.far.low.min(y.far.low).min(z.far.low),
        high: x.far.high.min(y.far.high).min(z.far.high),
    };
    // One part a pair of faces.
    let which = inlined(
        #[inline(always)]
        |y_later: L::Mask, z_later: L::Mask| {
            let x_or_y = l.select_int(y_later, l.int(1), l.int(0));
            l.select_int(z_later, l.int(2), x_or_y)
        },
    );
    let parts = [
        which(
            y.near.high.gt(x.near.high),
            z.near.high.gt(x.near.high.max(y.near.high)),
        ),
        which(
            y.far.low.lt(x.far.low),
            z.far.low.lt(x.far.low.min(y.far.low)),
        ),
    ];
    let lost = x.lost | y.lost | z.lost;
    let outside = x.outside | y.outside | z.outside;
    Span {
        near,
        far,
        hit: near.high.lt(far.low) & !lost & !outside,
        miss: outside | (near.low.gt(far.high) & !lost),
        parts,
    }
}

/// Which pair of faces a point is on: that of the largest coordinate.
#[inline(always)]
fn faces<L: Lanes>(local: Vec3<L::Real>) -> (L::Mask, L::Mask) {
    let (ax, ay, az) = (local.x.abs(), local.y.abs(), local.z.abs());
    let on_x = ax.ge(ay) & ax.ge(az);
    (on_x, !on_x & ay.ge(az))
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
