//! Right-angled rectangular lights.

use glam::DVec3;

use super::{Emitting, Light, Plane, Towards, area_pdf, by_area, signed, vector};
use crate::math::affine::perpendicular;
use crate::math::functions::{atan2_turns, sin_cos_turns};
use crate::math::lanes::{Lanes, Mask, Real, Scalar};
use crate::math::vec3::Vec3;
use crate::shape::Emitter;

/// A rectangle sampled uniformly in solid angle from near points and by area from far ones.
///
/// Far is farther from the centre than twice the root of the area, where the solid angle is below
/// ¼ sr, the density d²/(A cos) hardly varies, and the solid angle as a difference of arctangents
/// would lose digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RectangleLight<T> {
    /// With unit axes.
    plane: Plane<T>,
    half: [T; 2],
    inverse_area: T,
    inverse_root_area: T,
    near_squared: T,
    emits: [bool; 2],
}

/// The rectangle in coordinates about the receiver.
struct Seen<L: Lanes> {
    x: [L::Real; 2],
    y: [L::Real; 2],
    z: L::Real,
    /// Solid angle in units of 2π sr.
    turns: L::Real,
    /// Interior angles at the two corners of smaller x, in turns.
    corners: L::Real,
    near: L::Mask,
}

impl<T: Scalar> RectangleLight<T> {
    /// From the centre and two perpendicular half-edges.
    pub fn new(centre: DVec3, half: [DVec3; 2], normal: DVec3, emits: [bool; 2]) -> Self {
        let lengths = half.map(DVec3::length);
        let area = 4.0 * lengths[0] * lengths[1];
        Self {
            plane: Plane::new(centre, half.map(DVec3::normalize), normal),
            half: lengths.map(T::from_f64),
            inverse_area: T::from_f64(1.0 / area),
            inverse_root_area: T::from_f64(1.0 / area.sqrt()),
            near_squared: T::from_f64(4.0 * area),
            emits,
        }
    }

    /// Solid angle as an excess of corner angles (C. Ureña, M. Fajardo and A. King, "An
    /// Area-Preserving Parametrization for Spherical Rectangles", EGSR 2013, section 3): the angle
    /// at a corner between the great circles of its edges has cosine ±x y/(√(x²+z²) √(y²+z²)) and
    /// sine |z| r/(…), so its tangent needs one square root.
    #[inline(always)]
    fn seen<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> Seen<L> {
        let to = self.plane.towards_centre(l, p);
        let near = to.length_squared().lt(l.splat(self.near_squared));
        let [ax, ay] = &self.plane.axes;
        let (cx, cy) = (to.dot(vector(l, ax)), to.dot(vector(l, ay)));
        // The parametrisation looks along −z.
        let z = -to.dot(self.plane.normal(l)).abs();
        let (hx, hy) = (l.splat(self.half[0]), l.splat(self.half[1]));
        let (x, y) = ([cx - hx, cx + hx], [cy - hy, cy + hy]);
        let mut seen = Seen {
            x,
            y,
            z,
            turns: l.real(0.0),
            corners: l.real(0.0),
            near,
        };
        if near.any() {
            // In units of the root of the area, so that no product leaves the range of numbers.
            let unit = l.splat(self.inverse_root_area);
            let (x, y) = ([x[0] * unit, x[1] * unit], [y[0] * unit, y[1] * unit]);
            let (zz, depth) = (z * unit * (z * unit), -(z * unit));
            // cos and sin of a corner's angle, times a common factor.
            let corner = inlined!(|x: L::Real, y: L::Real| {
                let r = x.mul_add(x, y.mul_add(y, zz)).sqrt();
                (x * y, depth * r)
            });
            // The angle of (c₀ + i s₀)(−c₁ + i s₁), a sum of two angles in [0, ½] turns.
            type Pair<L> = (<L as Lanes>::Real, <L as Lanes>::Real);
            let sum = inlined!(|(c0, s0): Pair<L>, (c1, s1): Pair<L>| {
                let cosine = -c0.mul_add(c1, s0 * s1);
                let turns = atan2_turns(l, c0.mul_add(s1, -(s0 * c1)), cosine);
                l.select(turns.lt(l.real(0.0)), turns + l.real(1.0), turns)
            });
            seen.corners = sum(corner(x[0], y[1]), corner(x[0], y[0]));
            let others = sum(corner(x[1], y[0]), corner(x[1], y[1]));
            seen.turns = others - (l.real(1.0) - seen.corners);
            // Below 0.01 sr the difference has lost too much: 2 sums of angles to 2⁻²⁴ turns each are
            // within 7.5e-5 of it.
            let least: L::Real = l.real(0.01 / std::f64::consts::TAU);
            seen.near = near & least.lt(seen.turns);
        }
        seen
    }

    /// Density of [`Light::sample`].
    #[inline(never)]
    fn density<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
    ) -> L::Real {
        l.vectorize(inlined!(|| {
            let seen = self.seen(l, p);
            let cosine = direction.dot(self.plane.normal(l));
            let area = area_pdf(cosine, seen.z, l.splat(self.inverse_area));
            l.select(seen.near, seen.pdf(l), area)
        }))
    }
}

impl<T: Scalar> Light<T> for RectangleLight<T> {
    const STRATEGY: &'static str = "by solid angle near, by area far";
    const FLAT: bool = true;

    fn of_shape(shape: &Emitting<'_>) -> Option<(Self, f64)> {
        let [a, b, _] = shape.to_world.columns();
        let centre = shape.to_world.translation();
        (shape.form == Emitter::Rectangle && perpendicular(a, b)).then(|| {
            let light = Self::new(centre, [a, b], shape.normal(2), shape.emits);
            (light, 4.0 * a.cross(b).length())
        })
    }

    #[inline(never)]
    fn sample<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        [u, v]: [L::Real; 2],
    ) -> Towards<L> {
        l.vectorize(inlined!(|| {
            let seen = self.seen(l, p);
            let mut x = signed(l, u) * l.splat(self.half[0]);
            let mut y = signed(l, v) * l.splat(self.half[1]);
            if seen.near.any() {
                let (sx, sy) = seen.point(l, u, v);
                // Back to coordinates about the centre.
                x = l.select(seen.near, sx - (seen.x[0] + seen.x[1]) * l.real(0.5), x);
                y = l.select(seen.near, sy - (seen.y[0] + seen.y[1]) * l.real(0.5), y);
            }
            let to = self
                .plane
                .towards(l, self.plane.towards_centre(l, p), [x, y]);
            let area = l.splat(self.inverse_area);
            let mut towards = by_area(l, to, self.plane.normal(l), seen.z, area, self.emits);
            towards.pdf = l.select(seen.near, seen.pdf(l), towards.pdf);
            towards
        }))
    }

    #[inline(always)]
    fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        _: Vec3<L::Real>,
    ) -> L::Real {
        self.density(l, p, direction)
    }
}

impl<L: Lanes> Seen<L> {
    #[inline(always)]
    fn pdf(&self, l: L) -> L::Real {
        l.real(1.0 / std::f64::consts::TAU) / self.turns
    }

    /// The point of the rectangle for (u, v), in its plane (Ureña et al. 2013, section 4).
    #[inline(always)]
    fn point(&self, l: L, u: L::Real, v: L::Real) -> (L::Real, L::Real) {
        let one = l.real(1.0);
        let zero = l.real(0.0);
        let zz = self.z * self.z;
        let b = inlined!(|y: L::Real| y / y.mul_add(y, zz).sqrt());
        let (b0, b1) = (-b(self.y[0]), b(self.y[1]));
        let angle = u.mul_add(self.turns, one - self.corners);
        let (sine, cosine) = sin_cos_turns(l, angle);
        let f = cosine.mul_add(b0, -b1) / sine;
        let c = one.copysign(f) / f.mul_add(f, b0 * b0).sqrt();
        let c = c.max(-one).min(one);
        let across = -(c * self.z) / (-c).mul_add(c, one).max(zero).sqrt();
        let x = across.max(self.x[0]).min(self.x[1]);
        let d2 = x.mul_add(x, zz);
        let h = inlined!(|y: L::Real| y / y.mul_add(y, d2).sqrt());
        let (h0, h1) = (h(self.y[0]), h(self.y[1]));
        let hv = v.mul_add(h1 - h0, h0);
        let y = hv * (d2 / (-hv).mul_add(hv, one)).sqrt();
        (x, y.max(self.y[0]).min(self.y[1]))
    }
}
