//! Implicit surfaces in lanes, by the report's own method.
//!
//! The baseline finder: equal steps along the clipped ray, a change of sign, bisection. It proves
//! nothing; a pair of roots within one step is missed. It stays as the yardstick for certified
//! finders.

use glam::DVec3;

use crate::math::affine::Affine;
use crate::math::lanes::{Lanes, Mask, Real, Scalar};
use crate::math::vec3::{Rows, Vec3};
use crate::scene::ImplicitSurface;

use super::LaneRay;

/// An implicit surface placed in the world.
#[derive(Debug, Clone, Copy)]
pub struct LaneImplicit<T> {
    surface: ImplicitSurface,
    centre: [T; 3],
    half: [T; 3],
    steps: u32,
    inverse: Rows<T>,
}

/// What a ray that starts on the surface knows: which sign the field has just after the start.
#[derive(Clone, Copy)]
pub struct StartSign<L: Lanes> {
    /// Lanes that start on this surface.
    pub on: L::Mask,
    /// Of those, the ones that go inward, where the field is negative.
    pub inward: L::Mask,
}

impl<T: Scalar> LaneImplicit<T> {
    /// Rounds a placement: clip box in object coordinates, world → object map.
    pub fn new(surface: ImplicitSurface, inside: [DVec3; 2], steps: u32, inverse: &Affine) -> Self {
        let centre = (inside[0] + inside[1]) / 2.0;
        let half = (inside[1] - inside[0]) / 2.0;
        Self {
            surface,
            centre: centre.to_array().map(T::from_f64),
            half: half.to_array().map(T::from_f64),
            steps,
            inverse: Rows::from_f64(&inverse.rows),
        }
    }

    /// The field at object points, negative inside.
    #[inline(always)]
    pub fn field<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> L::Real {
        let (xx, yy, zz) = (p.x * p.x, p.y * p.y, p.z * p.z);
        match self.surface {
            ImplicitSurface::Heart => {
                let s = xx + yy * l.real(2.25) + zz - l.real(1.0);
                let cubic = zz * p.z;
                s * s * s - xx * cubic - yy * cubic * l.real(9.0 / 80.0)
            }
            ImplicitSurface::Mitchell => {
                let w = yy + zz;
                (xx * xx + w * w) * l.real(4.0) + xx * w * l.real(17.0) - (xx + w) * l.real(20.0)
                    + l.real(17.0)
            }
        }
    }

    /// Its gradient.
    #[inline(always)]
    pub fn gradient<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> Vec3<L::Real> {
        let (xx, yy, zz) = (p.x * p.x, p.y * p.y, p.z * p.z);
        match self.surface {
            ImplicitSurface::Heart => {
                let s = xx + yy * l.real(2.25) + zz - l.real(1.0);
                let six = s * s * l.real(6.0);
                let cubic = zz * p.z;
                Vec3::new(
                    (six - cubic * l.real(2.0)) * p.x,
                    (six * l.real(2.25) - cubic * l.real(9.0 / 40.0)) * p.y,
                    six * p.z - (xx * l.real(3.0) + yy * l.real(27.0 / 80.0)) * zz,
                )
            }
            ImplicitSurface::Mitchell => {
                let w = yy + zz;
                let across = xx * l.real(34.0) + w * l.real(16.0) - l.real(40.0);
                Vec3::new(
                    (xx * l.real(16.0) + w * l.real(34.0) - l.real(40.0)) * p.x,
                    across * p.y,
                    across * p.z,
                )
            }
        }
    }

    /// The first sign change along each ray before `limit`; where the mask is false, none.
    #[inline(never)]
    pub fn first_change<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        ray: &LaneRay<L>,
        start: StartSign<L>,
        limit: L::Real,
        active: L::Mask,
    ) -> (L::Real, L::Mask) {
        l.vectorize(
            #[inline(always)]
            || {
                let o = self.inverse.point(l, ray.origin);
                let d = self.inverse.vector(l, ray.direction);
                let zero = l.real(0.0);
                let (mut near, mut far) = (zero, limit);
                for (o, d, c, h) in [
                    (o.x, d.x, self.centre[0], self.half[0]),
                    (o.y, d.y, self.centre[1], self.half[1]),
                    (o.z, d.z, self.centre[2], self.half[2]),
                ] {
                    let inverse = l.real(1.0) / d;
                    let (c, h) = (l.splat(c), l.splat(h));
                    let (t1, t2) = ((c - h - o) * inverse, (c + h - o) * inverse);
                    near = t1.min(t2).max(near);
                    far = t1.max(t2).min(far);
                }
                let clipped = active & near.lt(far);
                let mut found = l.mask(false);
                let (mut low, mut high) = (near, near);
                if !clipped.any() {
                    return (near, found);
                }
                let step = (far - near) * l.real(1.0 / f64::from(self.steps));
                let mut negative = self.field(l, o.along(d, near)).lt(zero);
                // On the surface the field's sign at the start is rounding noise, its sign after it known.
                negative = (negative & !start.on) | (start.inward & start.on);
                let mut t = near;
                for i in 1..=self.steps {
                    let next = step.mul_add(l.real(f64::from(i)), near);
                    let change_to = self.field(l, o.along(d, next)).lt(zero);
                    let changed =
                        ((change_to & !negative) | (negative & !change_to)) & clipped & !found;
                    low = l.select(changed, t, low);
                    high = l.select(changed, next, high);
                    found = found | changed;
                    if !(clipped & !found).any() {
                        break;
                    }
                    t = next;
                }
                if !found.any() {
                    return (near, found);
                }
                // Half the step as often as the significand has bits.
                for _ in 0..L::UNIFORM_BITS.max(24) {
                    let middle = (low + high) * l.real(0.5);
                    let inside = self.field(l, o.along(d, middle)).lt(zero);
                    let same = (inside & negative) | (!inside & !negative);
                    low = l.select(same, middle, low);
                    high = l.select(same, high, middle);
                }
                ((low + high) * l.real(0.5), found)
            },
        )
    }
}
