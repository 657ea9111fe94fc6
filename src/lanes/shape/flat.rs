//! Pieces of the plane z = 0: how a line crosses it, and a test of where; exactly and in lanes.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use super::kind::{Canonical, Emitter, LaneQuestion, Length};
use super::lanes::part::{Part, PartKind};
use super::lanes::{Enclosure, LaneShape, LaneSpan};
use super::line::{Crossing, Feature, Fraction, LocalRay, Span};
use crate::math::affine::Affine;
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

/// The one crossing with z = 0. A line in the plane misses: it sees the shape edge-on.
fn crossing<N: Number>(ray: &LocalRay<N>) -> Option<Option<Crossing>> {
    let slope = ray.direction[2].sign()?;
    Some((slope != Ordering::Equal).then_some(Crossing {
        feature: Feature::Flat,
        leaving: slope == Ordering::Greater,
    }))
}

/// A part of the plane z = 0. What has the name of an item of [`Canonical`] becomes that item.
pub trait Flat {
    const NAME: &'static str;
    const LENGTHS: &'static [Length] = &[];
    const EMITTER: Emitter;

    fn corners() -> Option<[DVec3; 2]> {
        Some([DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)])
    }

    /// For the components of a in the plane.
    fn half_range(along: DVec2) -> f64;

    /// Whether it covers the line's point at `t`, where z is 0; `None` where this kind of number cannot
    /// tell.
    fn covers<N: Number>(ray: &LocalRay<N>, t: &Fraction<N>) -> Option<bool>;

    /// Whether the point (x/z, y/z) of `at` = (x, y, z), with each of x, y and z > 0 within `margin`
    /// together, is certainly inside and certainly outside.
    fn contains<L: Lanes>(l: L, at: Vec3<L::Real>, margin: L::Real) -> (L::Mask, L::Mask);
}

impl<F: Flat> Canonical for F {
    const NAME: &'static str = F::NAME;
    const LENGTHS: &'static [Length] = F::LENGTHS;
    const FLAT: bool = true;
    const EMITTER: Emitter = F::EMITTER;
    const FACES: &'static [(usize, &'static [f64])] = &[(2, &[0.0])];

    fn corners() -> Option<[DVec3; 2]> {
        F::corners()
    }

    fn half_range(along: DVec3) -> f64 {
        F::half_range(along.truncate())
    }

    /// The one crossing twice.
    fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
        let Some(crossing) = crossing(ray)? else {
            return Some(None);
        };
        let covered = F::covers(ray, &crossing.fraction(ray).ok()?)?;
        Some(covered.then_some(Span {
            near: crossing,
            far: crossing,
        }))
    }

    /// t = −o_z/d_z within 2 (E_z + |t| D_z)/|d_z| + 5u|t| (first order, doubled for the rest while
    /// D_z ≤ |d_z|/4, which [`margins`] ensures; 1/d_z, the product and the ends t ∓ error are each off
    /// by u, the rest of 5u pays for evaluating the error).
    #[inline(always)]
    fn lane_span<L: Lanes>(l: L, question: &LaneQuestion<'_, L>) -> LaneSpan<L> {
        let LaneQuestion { shape, ray, .. } = *question;
        let u = <L::Scalar as Scalar>::ROUNDOFF;
        let row = inlined!(|i: usize| shape.inverse.row(l, i, ray.origin, ray.direction));
        let ((ox, dx), (oy, dy), (oz, dz)) = (row(0), row(1), row(2));
        let [constant, factor] = shape.margins;
        let margin = ray.extent.mul_add(l.splat(factor), l.splat(constant));
        let x = ox.mul_add(dz, -(oz * dx));
        let y = oy.mul_add(dz, -(oz * dy));
        let (inside, outside) = F::contains(l, Vec3::new(x, y, dz.abs()), margin);
        let reciprocal = l.real(1.0) / dz;
        let t = -(oz * reciprocal);
        let distance = t.abs();
        let z_error = l.splat(shape.direction_error[2]);
        let e = distance.mul_add(z_error, shape.origin_error(l, ray, 2)) * l.real(2.0);
        let error = e.mul_add(reciprocal.abs(), distance * l.real(5.0 * u));
        let at = Enclosure::about(t, error);
        LaneSpan {
            near: at,
            far: at,
            hit: inside,
            miss: outside,
            parts: [l.int(0); 2],
        }
    }

    fn parts<T: Scalar>(shape: &LaneShape<T>) -> Vec<Part<T>> {
        vec![Part {
            kind: PartKind::Plane,
            half: T::default(),
            ..shape.faces[2]
        }]
    }

    #[inline(always)]
    fn snapped<L: Lanes>(l: L, local: Vec3<L::Real>) -> Vec3<L::Real> {
        Vec3::new(local.x, local.y, l.real(0.0))
    }
}

/// The constant and the factor of max|o| in the margin of the test of where.
///
/// The line meets z = 0 at x/z with x = o_x d_z − o_z d_x and z = |d_z|, without a division. With
/// Aᵢ = Rᵢ s + |bᵢ| ≥ |oᵢ|, Rᵢ ≥ |dᵢ|, Eᵢ = 6u (Aᵢ + 1) and Dᵢ = 6u Rᵢ, x is off by at most
/// |o_x| D_z + |d_z| E_x + |o_z| D_x + |d_x| E_z + 2u (|o_x d_z| + |o_z d_x|)
/// ≤ u (14 (A_x R_z + A_z R_x) + 6 (R_x + R_z)), and z by 6u R_z. Of that, 24u R_z are counted, so that
/// |d_z| > 4 D_z wherever the line is found inside; one twentieth pays for terms in u² and for the
/// evaluation of the margin.
pub fn margins<T: Scalar>(inverse: &Affine) -> [f64; 2] {
    let sum = inverse.abs().vector(DVec3::ONE);
    let shift = inverse.translation().abs();
    let unit = 1.05 * T::ROUNDOFF;
    let across = |i: usize| {
        let constant = 14.0 * (shift[i] * sum.z + shift.z * sum[i]) + 6.0 * sum[i] + 30.0 * sum.z;
        [unit * constant, unit * 28.0 * sum[i] * sum.z]
    };
    let (x, y) = (across(0), across(1));
    [x[0].max(y[0]), x[1].max(y[1])]
}
