//! Spherical lights.

use glam::DVec3;

use super::{Towards, vector};
use crate::math::functions::sin_cos_turns;
use crate::math::lanes::{Lanes, Mask, Real, Scalar};
use crate::math::vec3::Vec3;
use crate::sample::warp::uniform_sphere;

/// A sphere, sampled uniformly in the cone it fills from outside (P. Shirley, C. Wang and
/// K. Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", ACM TOG 15 (1996)),
/// and by area from inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereLight<T> {
    centre: [T; 3],
    radius: T,
    radius_squared: T,
    /// Squared distance from the centre up to which a receiver counts as inside.
    inside_squared: T,
    inverse_area: T,
    emits: [bool; 2],
}

/// The cone of directions in which a receiver sees the sphere.
struct Cone<L: Lanes> {
    to: Vec3<L::Real>,
    squared: L::Real,
    /// 1 − cos of the half-angle, without cancellation.
    height: L::Real,
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
        let margin = if emits[1] {
            T::ROUNDOFF * (16.0 * centre.length() / radius + 80.0)
        } else {
            0.0
        };
        Self {
            centre: centre.to_array().map(T::from_f64),
            radius: T::from_f64(radius),
            radius_squared: T::from_f64(radius * radius),
            inside_squared: T::from_f64(radius * radius * (1.0 + margin)),
            inverse_area: T::from_f64(1.0 / (4.0 * std::f64::consts::PI * radius * radius)),
            emits,
        }
    }

    #[inline(always)]
    fn cone<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> Cone<L> {
        let to = vector(l, &self.centre) - p;
        let squared = to.length_squared();
        let sine_squared = l.splat(self.radius_squared) / squared;
        let one = l.real(1.0);
        let cosine = (one - sine_squared).max(l.real(0.0)).sqrt();
        Cone {
            to,
            squared,
            height: sine_squared / (one + cosine),
            outside: squared.gt(l.splat(self.inside_squared)),
        }
    }

    /// A direction from p.
    #[inline(never)]
    pub fn sample<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        [u, v]: [L::Real; 2],
    ) -> Towards<L> {
        l.vectorize(
            #[inline(always)]
            || {
                let one = l.real(1.0);
                let zero = l.real(0.0);
                let cone = self.cone(l, p);
                // By area, as seen from inside.
                let w = uniform_sphere(l, u, v);
                let to = cone.to.along(w, l.splat(self.radius));
                let from_inside = to.length_squared().sqrt();
                let inward = to.scale(one / from_inside);
                // In the cone: 1 − cos θ uniform.
                let height = u * cone.height;
                let cosine = one - height;
                let sine_squared = height * (one + cosine);
                let (s, c) = sin_cos_turns(l, v);
                let sine = sine_squared.sqrt();
                let axis = cone.to.scale(one / cone.squared.sqrt());
                let (a, b) = axis.frame(l);
                let outward = axis.scale(cosine).along(a, sine * c).along(b, sine * s);
                let direction = Vec3::select(l, cone.outside, outward, inward);
                // Nearer crossing: d cos θ − √(r² − d² sin² θ).
                let half = (-cone.squared)
                    .mul_add(sine_squared, l.splat(self.radius_squared))
                    .max(zero)
                    .sqrt();
                let distance = cone.squared.sqrt().mul_add(cosine, -half);
                Towards {
                    direction,
                    distance: l.select(cone.outside, distance, from_inside),
                    pdf: self.density(l, &cone, direction),
                    valid: (cone.outside & l.mask(self.emits[0]))
                        | (!cone.outside & l.mask(self.emits[1])),
                }
            },
        )
    }

    /// Density of [`Self::sample`].
    #[inline(never)]
    pub fn pdf<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        p: Vec3<L::Real>,
        direction: Vec3<L::Real>,
    ) -> L::Real {
        l.vectorize(
            #[inline(always)]
            || self.density(l, &self.cone(l, p), direction),
        )
    }

    /// Uniform in the cone from outside; from inside t²/(A cos) at the crossing ahead, with
    /// cos = √(r² − b²)/r for a line that passes the centre at distance b, and t the larger root of
    /// t² − 2t (to · ω) = r² − |to|² in whichever form adds.
    #[inline(always)]
    fn density<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        cone: &Cone<L>,
        direction: Vec3<L::Real>,
    ) -> L::Real {
        let uniform = cone_pdf(l, cone.height);
        if !(!cone.outside).any() {
            return uniform;
        }
        let zero = l.real(0.0);
        let ahead = cone.to.dot(direction);
        let foot = cone.to.along(direction, -ahead);
        let half = (l.splat(self.radius_squared) - foot.length_squared())
            .max(zero)
            .sqrt();
        let depth = (l.splat(self.radius_squared) - cone.squared).max(zero);
        let t = l.select(ahead.gt(zero), half + ahead, depth / (half - ahead));
        let by_area = t * t * l.splat(self.radius) / half * l.splat(self.inverse_area);
        l.select(cone.outside, uniform, by_area)
    }
}

/// 1/(2π (1 − cos)).
#[inline(always)]
fn cone_pdf<L: Lanes>(l: L, height: L::Real) -> L::Real {
    l.real(1.0 / std::f64::consts::TAU) / height
}
