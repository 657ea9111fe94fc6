//! Spherical lights.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::{Emitting, Light, Towards, scalars, vector};
use crate::math::functions::sin_cos_turns;
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar};
use crate::math::lookup::SMALL;
use crate::math::vec3::Vec3;
use crate::sample::warp::uniform_sphere;
use crate::shape::Emitter;

/// A sphere, sampled uniformly in the cone it fills from outside (P. Shirley, C. Wang and
/// K. Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", ACM TOG 15 (1996)),
/// and by area from inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereLight<T> {
    centre: [T; 3],
    radius: T,
    /// Squared distance from the centre up to which a receiver counts as inside.
    inside_squared: T,
    emits: [bool; 2],
}

/// Spheres, one a lane.
#[derive(Clone, Copy)]
pub struct Spheres<L: Lanes> {
    centre: Vec3<L::Real>,
    radius: L::Real,
    inside_squared: L::Real,
    emits: [L::Mask; 2],
}

/// A few spheres by number, to be looked up lane by lane.
#[derive(Debug, Clone, Default)]
pub struct SphereTable<T> {
    centre: [[T; SMALL]; 3],
    radius: [T; SMALL],
    inside_squared: [T; SMALL],
    /// Whether front and back emit, as bits.
    emits: [u32; SMALL],
}

impl<T: Scalar> SphereTable<T> {
    /// Puts a sphere at number `k`.
    pub fn set(&mut self, k: usize, light: &SphereLight<T>) {
        for (column, x) in self.centre.iter_mut().zip(light.centre) {
            column[k] = x;
        }
        self.radius[k] = light.radius;
        self.inside_squared[k] = light.inside_squared;
        self.emits[k] = u32::from(light.emits[0]) | u32::from(light.emits[1]) << 1;
    }

    /// Each lane's sphere.
    #[inline(always)]
    pub fn at<L: Lanes<Scalar = T>>(&self, l: L, k: L::Int) -> Spheres<L> {
        let [x, y, z] = &self.centre;
        let emits = l.lookup_int(&self.emits, k);
        let side = inlined!(|bit: u32| !(emits & l.int(bit)).same(l.int(0)));
        Spheres {
            centre: Vec3::new(l.lookup(x, k), l.lookup(y, k), l.lookup(z, k)),
            radius: l.lookup(&self.radius, k),
            inside_squared: l.lookup(&self.inside_squared, k),
            emits: [side(1), side(2)],
        }
    }
}

/// The cone of directions in which a receiver sees a sphere.
struct Cone<L: Lanes> {
    to: Vec3<L::Real>,
    squared: L::Real,
    /// 1 − cos of the half-angle, without cancellation: sin²/(1 + cos).
    height: L::Real,
    /// Density of uniform sampling: 1/(2π (1 − cos)).
    pdf: L::Real,
    outside: L::Mask,
}

impl<T: Scalar> SphereLight<T> {
    /// From centre and radius.
    ///
    /// The inner wall of a sphere that emits inward receives its light, so the points *on* it must
    /// count as inside, on whichever side of r rounding has put them. With unit roundoff u such a
    /// point is within 4u (|c| + 4r) of the sphere (three fused products of a unit vector within
    /// 3u, entries within u, and the centre); so |p − c|² is within u (8 |c|/r + 40) of r², relative
    /// to it. Twice that covers |c| ≤ √3 max|cᵢ| and the test's own rounding.
    pub fn new(centre: DVec3, radius: f64, emits: [bool; 2]) -> Self {
        let off = T::ROUNDOFF * (8.0 * centre.length() + 40.0 * radius);
        Self::with_walls(centre, radius, off, emits)
    }

    /// The same where points on the inner wall may seem to be `off` it.
    pub(super) fn with_walls(centre: DVec3, radius: f64, off: f64, emits: [bool; 2]) -> Self {
        let margin = if emits[1] { 2.0 * off / radius } else { 0.0 };
        Self {
            centre: scalars(centre),
            radius: T::from_f64(radius),
            inside_squared: T::from_f64(radius * radius * (1.0 + margin)),
            emits,
        }
    }

    /// The same sphere in every lane.
    #[inline(always)]
    fn everywhere<L: Lanes<Scalar = T>>(&self, l: L) -> Spheres<L> {
        Spheres {
            centre: vector(l, &self.centre),
            radius: l.splat(self.radius),
            inside_squared: l.splat(self.inside_squared),
            emits: [l.mask(self.emits[0]), l.mask(self.emits[1])],
        }
    }

    /// Density of [`Light::sample`].
    #[inline(never)]
    pub(super) fn density<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
    ) -> L::Real {
        l.vectorize(inlined!(|| {
            let spheres = self.everywhere(l);
            spheres.density(l, &spheres.cone(l, p), direction, l.mask(true))
        }))
    }
}

impl<T: Scalar> Light<T> for SphereLight<T> {
    const STRATEGY: &'static str = "by the solid angle of its cone from outside, by area inside";

    fn of_shape(shape: &Emitting<'_>) -> Option<(Self, f64)> {
        (shape.form == Emitter::Sphere && shape.to_world.is_similarity()).then(|| {
            let radius = shape.to_world.columns()[0].length();
            let light = Self::new(shape.to_world.translation(), radius, shape.emits);
            (light, 4.0 * PI * radius * radius)
        })
    }

    #[inline(always)]
    fn sample<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>, u: [L::Real; 2]) -> Towards<L> {
        self.everywhere(l).sample(l, p, u, l.mask(true))
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

impl<L: Lanes> Spheres<L> {
    #[inline(always)]
    fn cone(&self, l: L, p: Vec3<L::Real>) -> Cone<L> {
        let to = self.centre - p;
        let squared = to.length_squared();
        let radius_squared = self.radius * self.radius;
        let sine_squared = radius_squared / squared;
        let one = l.real(1.0);
        let both = one + (one - sine_squared).max(l.real(0.0)).sqrt();
        Cone {
            to,
            squared,
            height: sine_squared / both,
            pdf: both * squared / (radius_squared * l.real(TAU)),
            outside: squared.gt(self.inside_squared),
        }
    }

    /// A direction from p; what is said of lanes outside of `m` means nothing.
    #[inline(never)]
    pub fn sample(&self, l: L, p: Vec3<L::Real>, [u, v]: [L::Real; 2], m: L::Mask) -> Towards<L> {
        l.vectorize(inlined!(|| {
            let one = l.real(1.0);
            let zero = l.real(0.0);
            let cone = self.cone(l, p);
            // In the cone: 1 − cos θ uniform.
            let height = u * cone.height;
            let cosine = one - height;
            let sine_squared = height * (one + cosine);
            let (s, c) = sin_cos_turns(l, v);
            let sine = sine_squared.sqrt();
            let far = cone.squared.sqrt();
            let axis = cone.to.scale(one / far);
            let (a, b) = axis.frame(l);
            let mut direction = axis.scale(cosine).along(a, sine * c).along(b, sine * s);
            // Nearer crossing: d cos θ − √(r² − d² sin² θ).
            let half = (-cone.squared)
                .mul_add(sine_squared, self.radius * self.radius)
                .max(zero)
                .sqrt();
            let mut distance = far.mul_add(cosine, -half);
            let inside = m & !cone.outside;
            if inside.any() {
                // By area.
                let w = uniform_sphere(l, u, v);
                let to = cone.to.along(w, self.radius);
                let from_inside = to.length_squared().sqrt();
                let inward = to.scale(one / from_inside);
                direction = Vec3::select(l, inside, inward, direction);
                distance = l.select(inside, from_inside, distance);
            }
            Towards {
                direction,
                distance,
                pdf: self.density(l, &cone, direction, m),
                valid: (cone.outside & self.emits[0]) | (self.emits[1] & !cone.outside),
            }
        }))
    }

    /// Uniform in the cone from outside; from inside t²/(A cos) at the crossing ahead, with
    /// cos = √(r² − b²)/r for a line that passes the centre at distance b, and t the larger root of
    /// t² − 2t (to · ω) = r² − |to|² in whichever form adds.
    #[inline(always)]
    fn density(&self, l: L, cone: &Cone<L>, direction: Vec3<L::Real>, m: L::Mask) -> L::Real {
        let uniform = cone.pdf;
        if !(m & !cone.outside).any() {
            return uniform;
        }
        let zero = l.real(0.0);
        let radius_squared = self.radius * self.radius;
        let ahead = cone.to.dot(direction);
        let foot = cone.to.along(direction, -ahead);
        let half = (radius_squared - foot.length_squared()).max(zero).sqrt();
        // Along the wall the chord is not known to better than a rounding of the radius.
        let half = half.max(self.radius * l.real(L::Scalar::ROUNDOFF));
        let depth = (radius_squared - cone.squared).max(zero);
        let t = l.select(ahead.gt(zero), half + ahead, depth / (half - ahead));
        let area = radius_squared * l.real(4.0 * PI);
        let by_area = t * t * self.radius / (half * area);
        l.select(cone.outside, uniform, by_area)
    }
}
