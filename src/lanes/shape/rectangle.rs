//! The rectangle z = 0, |x| ≤ 1, |y| ≤ 1.

use glam::DVec2;

use super::flat::Flat;
use super::kind::{Emitter, Length};
use super::line::{Fraction, LocalRay};
use crate::math::lanes::{Lanes, Real};
use crate::math::number::Number;
use crate::math::vec3::Vec3;

pub struct Rectangle;

impl Flat for Rectangle {
    const NAME: &'static str = "rectangle";
    const LENGTHS: &'static [Length] = &[Length {
        each: true,
        ..Length::edge("size", &[0, 1])
    }];
    const EMITTER: Emitter = Emitter::Rectangle;

    fn half_range(along: DVec2) -> f64 {
        along.abs().element_sum()
    }

    fn covers<N: Number>(ray: &LocalRay<N>, t: &Fraction<N>) -> Option<bool> {
        match (ray.within(0, t), ray.within(1, t)) {
            (Some(false), _) | (_, Some(false)) => Some(false),
            (x, y) => x.and(y),
        }
    }

    #[inline(always)]
    fn contains<L: Lanes>(_: L, at: Vec3<L::Real>, margin: L::Real) -> (L::Mask, L::Mask) {
        let depth = at.z - at.x.abs().max(at.y.abs());
        (depth.gt(margin), depth.lt(-margin))
    }
}
