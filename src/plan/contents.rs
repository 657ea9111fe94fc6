//! What a scene holds, as far as the plan asks.

use crate::scene::{Light, Material, Scene, Shape};
use crate::spectrum::Spectrum;

fn materials(scene: &Scene) -> impl Iterator<Item = &Material> {
    let objects = scene.objects.iter();
    objects.map(|object| scene.material_of(&object.value))
}

/// Whether some object is an implicit surface.
pub fn is_implicit(scene: &Scene) -> bool {
    let mut shapes = scene.objects.iter().map(|object| &object.value.shape);
    shapes.any(|shape| matches!(shape, Shape::Implicit(_)))
}

/// The spectra that light takes on its way, other than refractive indices.
pub fn spectra(scene: &Scene) -> impl Iterator<Item = &Spectrum> {
    let surfaces = materials(scene).flat_map(|material| material.surface.spectra());
    let emissions = materials(scene).filter_map(|material| material.emission.as_ref());
    surfaces
        .chain(emissions.map(|emission| &emission.radiance))
        .chain(scene.lights.iter().filter_map(Light::spectrum))
        .chain(&scene.environment)
}

/// Light that paths from the camera can never find: that of lights without a surface which reaches
/// a surface, or the camera, by way of a mirror or through glass.
pub fn left_out(scene: &Scene) -> Vec<String> {
    if !materials(scene).any(|material| material.surface.kind.is_delta()) {
        return Vec::new();
    }
    let lights = scene.lights.iter().enumerate();
    lights
        .map(|(i, light)| format!("{} {i} by way of mirrors and glass", light.kind.name()))
        .collect()
}
