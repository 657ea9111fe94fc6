//! A few lights by number, to be looked up lane by lane.

use super::{LaneLight, LightShape, SphereTable};
use crate::math::lanes::Scalar;
use crate::math::lookup::SMALL;

/// Columns of a list of lights.
#[derive(Debug, Clone, Default)]
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
        let is_sphere = |light: &&LaneLight<T>| matches!(light.shape, LightShape::Sphere(_));
        if lights.len() > SMALL || lights.iter().filter(is_sphere).count() < 2 {
            return None;
        }
        let mut table = Self::default();
        for (k, light) in lights.iter().enumerate() {
            table.probability[k] = light.probability;
            table.spectrum[k] = light.spectrum;
            table.object[k] = light.object;
            if let LightShape::Sphere(sphere) = &light.shape {
                table.is_sphere[k] = 1;
                table.spheres.set(k, sphere);
            }
        }
        Some(table)
    }
}
