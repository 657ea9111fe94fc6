//! Right circular cylinders with caps.

use std::f64::consts::PI;

use glam::DVec3;

use super::{Emitting, Light, Towards, combined, products, scalars, signed, vector};
use crate::math::functions::sin_cos_turns;
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::Vec3;
use crate::sample::warp::square_to_disk;
use crate::shape::Emitter;

/// A right circular cylinder. A part that faces the receiver is chosen by its size; on caps and from
/// inside points are chosen by area, on the side from outside by height and by how far their line of
/// sight passes the axis, so that the density is bounded at the outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CylinderLight<T> {
    centre: [T; 3],
    /// Unit vectors, the third along the axis.
    axes: [[T; 3]; 3],
    radius: T,
    half_height: T,
    /// How far receivers count as inside: squared distance from the axis, height.
    inside: [T; 2],
    emits: [bool; 2],
}

/// What a receiver at q, in coordinates along the axes, sees of the cylinder.
struct View<L: Lanes> {
    q: Vec3<L::Real>,
    outside: L::Mask,
    /// q's distance from the axis.
    away: L::Real,
    /// Sizes of the side and of the caps towards +z and −z; 0 of what sends nothing this way.
    sizes: [L::Real; 3],
    total: L::Real,
}

/// A part of the surface: the side, else the cap towards +z (`top`) or the one towards −z.
pub(super) struct Part<L: Lanes> {
    side: L::Mask,
    top: L::Mask,
}

impl<T: Scalar> CylinderLight<T> {
    /// From the centre, the axes of the base, of equal length, and half the height, all at right
    /// angles.
    ///
    /// The inner wall of a cylinder that emits inward receives its light; points *on* it must count
    /// as inside. They are off by at most 4u (|c| + 4 max(r, h)), as on a sphere, which counts twice
    /// in the square; doubled.
    pub fn new(centre: DVec3, base: [DVec3; 2], half_height: DVec3, emits: [bool; 2]) -> Self {
        let size = base[0].length().max(half_height.length());
        let off = 8.0 * T::ROUNDOFF * (centre.length() + 4.0 * size);
        Self::with_walls(centre, base, half_height, off, emits)
    }

    /// The same where points on the inner wall may seem to be `off` it.
    pub(super) fn with_walls(
        centre: DVec3,
        base: [DVec3; 2],
        half_height: DVec3,
        off: f64,
        emits: [bool; 2],
    ) -> Self {
        let (radius, height) = (base[0].length(), half_height.length());
        let off = if emits[1] { off } else { 0.0 };
        let inside = [radius * radius * (1.0 + 2.0 * off / radius), height + off];
        Self {
            centre: scalars(centre),
            axes: [base[0] / radius, base[1] / radius, half_height / height].map(scalars),
            radius: T::from_f64(radius),
            half_height: T::from_f64(height),
            inside: inside.map(T::from_f64),
            emits,
        }
    }

    #[inline(always)]
    fn view<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> View<L> {
        let zero = l.real(0.0);
        let q = products(l, &self.axes, p - vector(l, &self.centre));
        let (radius, height) = (l.splat(self.radius), l.splat(self.half_height));
        let squared = q.x.mul_add(q.x, q.y * q.y);
        let away = squared.sqrt();
        let [inside_squared, inside_height] = self.inside.map(
            #[inline(always)]
            |x| l.splat(x),
        );
        let outside = squared.gt(inside_squared) | q.z.abs().gt(inside_height);
        let seen = l.mask(self.emits[0]) & outside;
        let within = l.mask(self.emits[1]) & !outside;
        let breadth = radius * height * l.real(4.0);
        let cap = radius * radius * l.real(PI);
        let side = l.select(seen & away.gt(radius), breadth, zero);
        let side = l.select(within, breadth * l.real(PI), side);
        let top = l.select(within | (seen & q.z.gt(height)), cap, zero);
        let bottom = l.select(within | (seen & q.z.lt(-height)), cap, zero);
        View {
            q,
            outside,
            away,
            sizes: [side, top, bottom],
            total: side + top + bottom,
        }
    }

    /// Density in solid angle of a direction that meets the part at t: t²/cos times that of its point
    /// by area. On the side from outside, with D the distance from the axis and ψ the angle between
    /// the axis and the line of sight, seen along the axis, D dψ cos ψ dz is spread evenly over 2r 2h;
    /// with a = sin² of the angle between direction and axis, dω = a^{3/2} dψ dz/(t √a).
    #[inline(always)]
    fn density<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        view: &View<L>,
        direction: Vec3<L::Real>,
        part: &Part<L>,
    ) -> L::Real {
        let zero = l.real(0.0);
        let (radius, height) = (l.splat(self.radius), l.splat(self.half_height));
        let d = products(l, &self.axes, direction);
        let q = view.q;
        let a = d.x.mul_add(d.x, d.y * d.y);
        let b = q.x.mul_add(d.x, q.y * d.y);
        let moment = q.x.mul_add(d.y, -(q.y * d.x));
        let root = (a * radius)
            .mul_add(radius, -(moment * moment))
            .max(zero)
            .sqrt();
        // Along the wall the chord is not known to better than a rounding of the radius.
        let root = root.max(a.sqrt() * radius * l.real(T::ROUNDOFF));
        // The nearer crossing from outside, the farther from inside, in whichever form adds.
        let depth = (view.away - radius) * (view.away + radius);
        let near = depth / (root - b);
        let seen = -(b * near) / (a * a.sqrt() * view.total);
        let far = l.select(b.gt(zero), -depth / (b + root), (root - b) / a);
        let within = far * far * radius / (root * view.total);
        let on_side = l.select(view.outside, seen, within);
        // The cap.
        let level = l.select(part.top, height, -height);
        let t = (level - q.z) / d.z;
        let on_cap = t * t / (d.z.abs() * view.total);
        l.select(part.side, on_side, on_cap)
    }

    /// A direction from p and the part it leads to.
    #[inline(never)]
    pub(super) fn sample_part<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        [u, v]: [L::Real; 2],
    ) -> (Towards<L>, Part<L>) {
        l.vectorize(inlined!(|| {
            let (zero, one) = (l.real(0.0), l.real(1.0));
            let (radius, height) = (l.splat(self.radius), l.splat(self.half_height));
            let view = self.view(l, p);
            let [side, top, bottom] = view.sizes;
            let target = u * view.total;
            let part = Part {
                side: target.lt(side),
                top: !target.lt(side) & (target - side).lt(top),
            };
            let below = l.select(part.side, zero, l.select(part.top, side, side + top));
            let size = l.select(part.side, side, l.select(part.top, top, bottom));
            let share = ((target - below) / size).max(zero).min(one);
            // The side from outside: past the axis at the distance `moment`.
            let moment = signed(l, share) * radius;
            let away = view.away;
            let sine = moment / away;
            let cosine = (-sine).mul_add(sine, one).max(zero).sqrt();
            let half = (-moment).mul_add(moment, radius * radius).max(zero).sqrt();
            let near = (away - radius) * (away + radius) / away.mul_add(cosine, half);
            let (x, y) = (-view.q.x / away, -view.q.y / away);
            let past = Vec3::new(
                x.mul_add(cosine, -(y * sine)) * near,
                y.mul_add(cosine, x * sine) * near,
                zero,
            );
            // From inside by angle; caps.
            let (s, c) = sin_cos_turns(l, share);
            let (cap_x, cap_y) = square_to_disk(l, share, v);
            let across = Vec3::new(
                l.select(part.side, c, cap_x).mul_add(radius, -view.q.x),
                l.select(part.side, s, cap_y).mul_add(radius, -view.q.y),
                zero,
            );
            let to = Vec3::select(l, part.side & view.outside, past, across);
            let level = l.select(part.top, height, -height);
            let level = l.select(part.side, signed(l, v) * height, level);
            let to = Vec3::new(to.x, to.y, level - view.q.z);
            let distance = to.length_squared().sqrt();
            let to = to.scale(one / distance);
            let direction = combined(l, &self.axes, to);
            let towards = Towards {
                direction,
                distance,
                pdf: self.density(l, &view, direction, &part),
                valid: view.total.gt(zero),
            };
            (towards, part)
        }))
    }

    /// Density of [`Self::sample_part`].
    #[inline(always)]
    pub(super) fn pdf_of_part<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        part: &Part<L>,
    ) -> L::Real {
        self.density(l, &self.view(l, p), direction, part)
    }
}

impl<T: Scalar> Light<T> for CylinderLight<T> {
    const STRATEGY: &'static str = "by the size of its visible parts";

    fn of_shape(shape: &Emitting<'_>) -> Option<(Self, f64)> {
        (shape.form == Emitter::Cylinder && shape.to_world.is_right_circular()).then(|| {
            let [a, b, c] = shape.to_world.columns();
            let (radius, height) = (a.length(), 2.0 * c.length());
            let light = Self::new(shape.to_world.translation(), [a, b], c, shape.emits);
            (light, 2.0 * PI * radius * (radius + height))
        })
    }

    #[inline(never)]
    fn sample<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>, u: [L::Real; 2]) -> Towards<L> {
        self.sample_part(l, p, u).0
    }

    #[inline(never)]
    fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
        normal: Vec3<L::Real>,
    ) -> L::Real {
        l.vectorize(inlined!(|| {
            // Normals are along the axis or at right angles to it, up to rounding.
            let along = normal.dot(vector(l, &self.axes[2]));
            let part = Part {
                side: along.abs().lt(l.real(0.5)),
                top: along.gt(l.real(0.0)),
            };
            self.density(l, &self.view(l, p), direction, &part)
        }))
    }
}
