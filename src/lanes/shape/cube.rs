//! The cube [-1, 1]³: three slabs.

use glam::DVec3;

use super::kind::{Canonical, Emitter, LaneQuestion, Length};
use super::lanes::part::Part;
use super::lanes::{LaneRay, LaneShape, LaneSpan};
use super::line::{LocalRay, Span};
use super::slab::{LaneSlab, Slab, cut, reach, slab};
use crate::math::lanes::{Lanes, Mask, Real, Scalar};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

/// The surface of [-1, 1]³.
pub struct Cube;

impl Canonical for Cube {
    const NAME: &'static str = "cube";
    const LENGTHS: &'static [Length] = &[
        Length::edge("side", &[0, 1, 2]),
        Length {
            each: true,
            default: None,
            ..Length::edge("size", &[0, 1, 2])
        },
    ];
    const EMITTER: Emitter = Emitter::Cube;
    const FACES: &'static [(usize, &'static [f64])] =
        &[(0, &[-1.0, 1.0]), (1, &[-1.0, 1.0]), (2, &[-1.0, 1.0])];

    fn half_range(along: DVec3) -> f64 {
        along.abs().element_sum()
    }

    /// The last entry must not come after the first exit.
    fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
        let mut span: Option<Span> = None;
        for axis in 0..3 {
            let next = match slab(ray, axis)? {
                Slab::Crossed(next) => next,
                Slab::Inside => continue,
                Slab::Outside => return Some(None),
            };
            span = match span {
                None => Some(next),
                Some(current) => match cut(ray, current, &next)? {
                    None => return Some(None),
                    shorter => shorter,
                },
            };
        }
        Some(span)
    }

    /// Three slabs (Kay and Kajiya 1986), each crossing with its bound; the cube is hit for certain
    /// when the latest possible entry is before the earliest possible exit.
    #[inline(always)]
    fn lane_span<L: Lanes>(l: L, question: &LaneQuestion<'_, L>) -> LaneSpan<L> {
        let LaneQuestion {
            shape, ray, asked, ..
        } = *question;
        let slabs = slabs(l, shape, ray);
        let [x, y, z] = &slabs;
        if (asked & (x.parallel | y.parallel | z.parallel)).any() {
            return with_parallels(l, shape, ray);
        }
        let nowhere = l.mask(false);
        joined(l, &slabs, nowhere, nowhere)
    }

    fn parts<T: Scalar>(shape: &LaneShape<T>) -> Vec<Part<T>> {
        shape.faces.to_vec()
    }

    /// The axis of the face.
    fn part(local: DVec3) -> u32 {
        local.abs().max_position() as u32
    }

    /// The coordinate of the face made exact.
    #[inline(always)]
    fn snapped<L: Lanes>(l: L, local: Vec3<L::Real>) -> Vec3<L::Real> {
        let (on_x, on_y) = faces::<L>(local);
        let one = l.real(1.0);
        Vec3::new(
            l.select(on_x, one.copysign(local.x), local.x),
            l.select(on_y, one.copysign(local.y), local.y),
            l.select(on_x | on_y, local.z, one.copysign(local.z)),
        )
    }
}

/// The three slabs of the lines in local coordinates.
#[inline(always)]
fn slabs<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, ray: &LaneRay<L>) -> [LaneSlab<L>; 3] {
    let slab = inlined!(|i| {
        let local = shape.inverse.row(l, i, ray.origin, ray.direction);
        LaneSlab::new(l, shape, ray, i, local)
    });
    [slab(0), slab(1), slab(2)]
}

/// The same where some line may run along a slab.
#[cold]
#[inline(never)]
fn with_parallels<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, ray: &LaneRay<L>) -> LaneSpan<L> {
    l.vectorize(inlined!(|| {
        let mut slabs = slabs(l, shape, ray);
        let [x, y, z] = &slabs;
        let o = Vec3::new(x.origin, y.origin, z.origin);
        let d = Vec3::new(x.direction, y.direction, z.direction);
        let reach = reach(l, shape, ray, o, d);
        let (mut lost, mut outside) = (l.mask(false), l.mask(false));
        for slab in &mut slabs {
            let (is_lost, is_outside) = slab.settle(l, reach);
            lost = lost | is_lost;
            outside = outside | is_outside;
        }
        joined(l, &slabs, lost, outside)
    }))
}

#[inline(always)]
fn joined<L: Lanes>(
    l: L,
    [x, y, z]: &[LaneSlab<L>; 3],
    lost: L::Mask,
    outside: L::Mask,
) -> LaneSpan<L> {
    let near = x.near.later(y.near).later(z.near);
    let far = x.far.earlier(y.far).earlier(z.far);
    // One part a pair of faces.
    let which = inlined!(|y_later: L::Mask, z_later: L::Mask| {
        let x_or_y = l.select_int(y_later, l.int(1), l.int(0));
        l.select_int(z_later, l.int(2), x_or_y)
    });
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
    LaneSpan {
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
