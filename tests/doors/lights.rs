//! Sampling of lights.

use etalon_lanes::light::LightShape;
use etalon_lanes::math::instructions::{Instructions, Job};
use etalon_lanes::math::lanes::{Lanes, Mask, Scalar};
use etalon_lanes::math::vec3::Vec3;
use glam::DVec3;

use crate::Made;
use crate::columns::{jobs, load, load_vectors, vector};

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

jobs! {
    /// Directions towards a light from p, by variates in [0, 1)².
    light_samples<'a>(l: L, light of LightShape, p: DVec3, variates: &'a [[f64; 2]]) -> Vec<LightSample> {
        let mut all = Vec::with_capacity(variates.len());
        let p = Vec3::splat(l, p);
        for variates in variates.chunks(L::COUNT) {
            let [u, v] = [0, 1].map(|k| variates.iter().map(move |pair| pair[k]));
            let towards = light.sample(l, p, [load(l, u), load(l, v)]);
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

    /// Densities with which directions from p would have been chosen; each comes with the light's
    /// normal where it meets the light.
    light_densities<'a>(l: L, light of LightShape, p: DVec3, directions: &'a [(DVec3, DVec3)]) -> Vec<f64> {
        let mut all = Vec::with_capacity(directions.len());
        let p = Vec3::splat(l, p);
        for directions in directions.chunks(L::COUNT) {
            let direction = load_vectors(l, directions.iter().map(|(direction, _)| *direction));
            let normal = load_vectors(l, directions.iter().map(|(_, normal)| *normal));
            let pdf = light.pdf(l, p, direction, normal);
            all.extend((0..directions.len()).map(|i| l.lane(pdf, i).to_f64()));
        }
        all
    }
}
