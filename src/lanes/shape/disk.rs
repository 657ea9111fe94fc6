//! The disk z = 0, x² + y² ≤ 1.

use std::cmp::Ordering;

use glam::DVec2;

use super::flat::Flat;
use super::kind::{Emitter, Length};
use super::line::{Fraction, LocalRay};
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

pub struct Disk;

impl Flat for Disk {
    const NAME: &'static str = "disk";
    const LENGTHS: &'static [Length] = &[Length::radius(&[0, 1])];
    const EMITTER: Emitter = Emitter::Disk;

    fn half_range(along: DVec2) -> f64 {
        along.length()
    }

    fn covers<N: Number>(ray: &LocalRay<N>, t: &Fraction<N>) -> Option<bool> {
        Some(ray.radial(2, t).0.sign()? != Ordering::Greater)
    }

    /// (x, y) is at most √2 of the margin from its exact place; 1½ pays for evaluating z ∓ margin too.
    /// x² + y² is rounded twice and (z ∓ margin)² three times, 5u of z² or 2½u of z: 4u pay for that.
    #[inline(always)]
    fn contains<L: Lanes>(l: L, at: Vec3<L::Real>, margin: L::Real) -> (L::Mask, L::Mask) {
        let u = <L::Scalar as Scalar>::ROUNDOFF;
        let squared = at.x.mul_add(at.x, at.y * at.y);
        let margin = at.z.mul_add(l.real(4.0 * u), margin * l.real(1.5));
        let (low, high) = (at.z - margin, at.z + margin);
        let inside = low.gt(l.real(0.0)) & squared.lt(low * low);
        (inside, squared.gt(high * high))
    }
}
