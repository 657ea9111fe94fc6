//! Sampling of lights.

use etalon_lanes::light::LightShape;
use etalon_lanes::math::instructions::{Instructions, Job};
use etalon_lanes::math::lanes::{Lanes, Mask, Scalar};
use etalon_lanes::math::vec3::Vec3;
use glam::DVec3;

use crate::columns::{load, load_vectors, vector};
use crate::{Made, of};

/// A light in either precision.
pub type AnyLight<'a> = Made<&'a LightShape<f32>, &'a LightShape<f64>>;

/// A direction towards a light, as lanes have it.
#[derive(Debug, Clone, Copy)]
pub struct LightSample {
    pub direction: DVec3,
    pub distance: f64,
    /// In solid angle, sr⁻¹.
    pub pdf: f64,
    /// Whether the light sends anything this way.
    pub valid: bool,
}

/// Directions towards a light from p, by variates in [0, 1)².
pub fn light_samples(
    set: Instructions,
    light: AnyLight,
    p: DVec3,
    variates: &[[f64; 2]],
) -> Vec<LightSample> {
    of!(light, |light| set.run(Samples { light, p, variates }))
}

struct Samples<'a, T> {
    light: &'a LightShape<T>,
    p: DVec3,
    variates: &'a [[f64; 2]],
}

impl<T: Scalar> Job<T> for Samples<'_, T> {
    type Output = Vec<LightSample>;

    #[inline(always)]
    fn run<L: Lanes<Scalar = T>>(self, l: L) -> Vec<LightSample> {
        let mut all = Vec::with_capacity(self.variates.len());
        let p = Vec3::splat(l, self.p);
        for variates in self.variates.chunks(L::COUNT) {
            let [u, v] = [0, 1].map(|k| variates.iter().map(move |pair| pair[k]));
            let towards = self.light.sample(l, p, [load(l, u), load(l, v)]);
            let valid = towards.valid.bits();
            all.extend((0..variates.len()).map(|i| LightSample {
                direction: vector(l, towards.direction, i),
                distance: l.lane(towards.distance, i).to_f64(),
                pdf: l.lane(towards.pdf, i).to_f64(),
                valid: valid >> i & 1 == 1,
            }));
        }
        all
    }
}

/// Densities with which directions from p would have been chosen; each comes with the light's normal
/// where it meets the light.
pub fn light_densities(
    set: Instructions,
    light: AnyLight,
    p: DVec3,
    directions: &[(DVec3, DVec3)],
) -> Vec<f64> {
    of!(light, |light| set.run(Densities {
        light,
        p,
        directions
    }))
}

struct Densities<'a, T> {
    light: &'a LightShape<T>,
    p: DVec3,
    directions: &'a [(DVec3, DVec3)],
}

impl<T: Scalar> Job<T> for Densities<'_, T> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<L: Lanes<Scalar = T>>(self, l: L) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.directions.len());
        let p = Vec3::splat(l, self.p);
        for directions in self.directions.chunks(L::COUNT) {
            let direction = load_vectors(l, directions.iter().map(|(direction, _)| *direction));
            let normal = load_vectors(l, directions.iter().map(|(_, normal)| *normal));
            let pdf = self.light.pdf(l, p, direction, normal);
            all.extend((0..directions.len()).map(|i| l.lane(pdf, i).to_f64()));
        }
        all
    }
}
