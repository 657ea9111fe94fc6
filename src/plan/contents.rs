//! What a scene holds, as far as the plan asks.

use crate::scene::{Light, Material, Scene, Shape};
use crate::spectrum::Spectrum;

/// Materials that some object wears.
fn worn(scene: &Scene) -> impl Iterator<Item = &Material> {
    scene
        .objects
        .iter()
        .map(|object| &scene.materials[object.value.material].value)
}

/// Whether some object is an implicit surface.
pub fn is_implicit(scene: &Scene) -> bool {
    let mut shapes = scene.objects.iter().map(|object| &object.value.shape);
    shapes.any(|shape| matches!(shape, Shape::Implicit(_)))
}

/// The spectra that light takes on its way, other than refractive indices.
pub fn spectra(scene: &Scene) -> impl Iterator<Item = &Spectrum> {
    let surfaces = worn(scene).flat_map(|material| material.surface.spectra());
    let emissions = worn(scene).filter_map(|material| material.emission.as_ref());
    let lights = scene.lights.iter().map(|light| match light {
        Light::Point { intensity, .. } => intensity,
        Light::Directional { irradiance, .. } => irradiance,
    });
    surfaces
        .chain(emissions.map(|emission| &emission.radiance))
        .chain(lights)
        .chain(&scene.environment)
}

/// Light that paths from the camera can never find: point or directional light that reaches a
/// surface, or the camera, by way of a mirror or through glass.
pub fn left_out(scene: &Scene) -> Vec<String> {
    let specular = worn(scene).any(|material| material.surface.kind.is_delta());
    if !specular {
        return Vec::new();
    }
    scene
        .lights
        .iter()
        .enumerate()
        .map(|(i, light)| {
            let kind = match light {
                Light::Point { .. } => "point",
                Light::Directional { .. } => "directional",
            };
            format!("{kind} light {i} by way of mirrors and glass")
        })
        .collect()
}
