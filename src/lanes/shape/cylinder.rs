//! The capped cylinder x² + y² ≤ 1, |z| ≤ 1: a round side between two caps.

use std::cmp::Ordering;

use glam::DVec3;

use super::kind::{Canonical, Emitter, LaneQuestion, Length};
use super::lanes::{LaneShape, LaneSpan, LaneSurface};
use super::line::{Crossing, Fraction, LocalRay, Span};
use super::slab::{LaneSlab, Slab, cut, reach, slab};
use super::sphere::round_span;
use crate::math::lanes::{Lanes, Mask, Real};
use crate::math::number::{Number, dot};
use crate::math::vec3::Vec3;

/// x² + y² = 1 for |z| ≤ 1, with both caps.
pub struct Cylinder;

impl Canonical for Cylinder {
    const NAME: &'static str = "cylinder";
    const LENGTHS: &'static [Length] = &[Length::radius(&[0, 1]), Length::edge("height", &[2])];
    const EMITTER: Emitter = Emitter::Cylinder;
    const FACES: &'static [(usize, &'static [f64])] = &[(2, &[-1.0, 1.0])];
    const ROUND: Option<usize> = Some(2);

    fn half_range(along: DVec3) -> f64 {
        along.truncate().length() + along.z.abs()
    }

    /// The line's stretch inside x² + y² ≤ 1, cut by its stretch inside |z| ≤ 1.
    fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
        let direction = &ray.direction[..2];
        let a = dot(direction, direction);
        if a.sign()? == Ordering::Equal {
            return along_axis(ray);
        }
        if ray.discriminant(2, &a).sign()? == Ordering::Less {
            return Some(None);
        }
        let side = Span {
            near: Crossing::round(2, false),
            far: Crossing::round(2, true),
        };
        match slab(ray, 2)? {
            Slab::Crossed(caps) => cut(ray, side, &caps),
            Slab::Inside => Some(Some(side)),
            Slab::Outside => Some(None),
        }
    }

    /// The side as a circle about the foot of the perpendicular in the plane (bounds as for the
    /// sphere, with √2 in place of √3), the caps as a slab.
    #[inline(always)]
    fn lane_span<L: Lanes>(l: L, question: &LaneQuestion<'_, L>) -> LaneSpan<L> {
        let LaneQuestion {
            shape, ray, asked, ..
        } = *question;
        let one = l.real(1.0);
        let row = inlined!(|i: usize| shape.inverse.row(l, i, ray.origin, ray.direction));
        let ((ox, dx), (oy, dy), (oz, dz)) = (row(0), row(1), row(2));
        let (o, d) = (Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz));
        let (e0, dd) = shape.largest_errors(l, ray, 2);

        let across = d.x.mul_add(d.x, d.y * d.y);
        let inverse_square = one / across;
        let inverse_length = inverse_square.sqrt();
        let foot_t = -(o.x.mul_add(d.x, o.y * d.y) * inverse_square);
        let (fx, fy) = (d.x.mul_add(foot_t, o.x), d.y.mul_add(foot_t, o.y));
        let squared = fx.mul_add(fx, fy * fy);
        let mut side = round_span(l, foot_t, squared, inverse_length, (e0, dd));
        // Along the axis the relative error of the direction across it is unbounded.
        let parallel = !across.sqrt().gt(dd * l.real(8.0));
        if (parallel & asked).any() {
            let drift = (across.sqrt() + dd * l.real(2.0))
                .mul_add(reach(l, shape, ray, o, d), e0 * l.real(2.0))
                * l.real(1.0 + 1e-6);
            let radius = o.x.mul_add(o.x, o.y * o.y).sqrt();
            let far = l.real(f64::INFINITY);
            side.near = side.near.replaced(l, parallel, -far);
            side.far = side.far.replaced(l, parallel, far);
            let inside = (radius + drift).lt(one);
            let outside = (radius - drift).gt(one);
            side.hit = (side.hit & !parallel) | (parallel & inside);
            side.miss = (side.miss & !parallel) | (parallel & outside);
        }

        let mut caps = LaneSlab::new(l, shape, ray, 2, (o.z, d.z));
        let (mut lost, mut outside) = (l.mask(false), l.mask(false));
        if (caps.parallel & asked).any() {
            (lost, outside) = caps.settle(l, reach(l, shape, ray, o, d));
        }
        let near = side.near.later(caps.near);
        let far = side.far.earlier(caps.far);
        LaneSpan {
            near,
            far,
            hit: side.hit & near.high.lt(far.low) & !lost & !outside,
            miss: side.miss | outside | (side.hit & near.low.gt(far.high) & !lost),
            parts: [l.int(0); 2],
        }
    }

    /// The canonical point moved onto side or cap.
    #[inline(always)]
    fn surface<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, p: Vec3<L::Real>) -> LaneSurface<L> {
        let local = shape.inverse.point(l, p);
        let (cap, radius) = on_cap::<L>(local);
        let zero = l.real(0.0);
        let face = l.real(1.0).copysign(local.z);
        let (x, y) = (local.x / radius, local.y / radius);
        let point = Vec3::new(
            l.select(cap, local.x, x),
            l.select(cap, local.y, y),
            l.select(cap, face, local.z),
        );
        let normal = Vec3::new(
            l.select(cap, zero, x),
            l.select(cap, zero, y),
            l.select(cap, face, zero),
        );
        LaneSurface {
            point: shape.forward.point(l, point),
            normal: shape.inverse.transposed(l, normal).normalized(l),
        }
    }

    /// The coordinate of a cap made exact.
    #[inline(always)]
    fn snapped<L: Lanes>(l: L, local: Vec3<L::Real>) -> Vec3<L::Real> {
        let (cap, _) = on_cap::<L>(local);
        let face = l.real(1.0).copysign(local.z);
        Vec3::new(local.x, local.y, l.select(cap, face, local.z))
    }
}

/// A line parallel to the axis meets the caps or nothing.
fn along_axis<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
    let start = Fraction::whole(N::of(0.0));
    if ray.radial(2, &start).0.sign()? == Ordering::Greater {
        return Some(None);
    }
    Some(match slab(ray, 2)? {
        Slab::Crossed(caps) => Some(caps),
        Slab::Inside | Slab::Outside => None,
    })
}

/// A cap where |z| exceeds the distance from the axis, else the side.
#[inline(always)]
fn on_cap<L: Lanes>(local: Vec3<L::Real>) -> (L::Mask, L::Real) {
    let radius = local.x.mul_add(local.x, local.y * local.y).sqrt();
    (local.z.abs().gt(radius), radius)
}
