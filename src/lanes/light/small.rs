//! A few lights by number, to be looked up lane by lane.

use super::{LaneLight, LightShape, SphereTable};
use crate::math::lanes::Scalar;
use crate::math::lookup::SMALL;

/// Columns of a list of lights.
#[derive(Debug, Clone)]
pub struct SmallLights<T> {
    /// [`LaneLight::probability`].
    pub probability: [T; SMALL],
    /// [`LaneLight::spectrum`].
    pub spectrum: [u32; SMALL],
    /// [`LaneLight::object`].
    pub object: [u32; SMALL],
    /// 1 where the light is a sphere.
    pub is_sphere: [u32; SMALL],
    /// The spheres among them.
    pub spheres: SphereTable<T>,
}

impl<T: Scalar> SmallLights<T> {
    /// The lights, where they are few and there is more than one sphere: then lanes with different
    /// lights can be sampled together.
    pub fn new(lights: &[LaneLight<T>]) -> Option<Self> {
        let spheres = lights.iter().filter(|light| light.sphere().is_some());
        if lights.len() > SMALL || spheres.count() < 2 {
            return None;
        }
        let mut table = Self {
            probability: [T::default(); SMALL],
            spectrum: [0; SMALL],
            object: [0; SMALL],
            is_sphere: [0; SMALL],
            spheres: SphereTable::default(),
        };
        for (k, light) in lights.iter().enumerate() {
            table.probability[k] = light.probability;
            table.spectrum[k] = light.spectrum;
            table.object[k] = light.object;
            if let Some(sphere) = light.sphere() {
                table.is_sphere[k] = 1;
                table.spheres.set(k, sphere);
            }
        }
        Some(table)
    }
}

impl<T> LaneLight<T> {
    fn sphere(&self) -> Option<&super::SphereLight<T>> {
        match &self.shape {
            LightShape::Sphere(sphere) => Some(sphere),
            _ => None,
        }
    }
}
