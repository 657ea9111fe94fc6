//! What can happen in a scene.

use crate::integrate::model::Needs;
use crate::material::MaterialKind;
use crate::scene::{Light, Material, Scene, Shape};
use crate::spectrum::Spectrum;

/// Materials that some object wears.
fn worn(scene: &Scene) -> impl Iterator<Item = &Material> {
    scene
        .objects
        .iter()
        .map(|object| &scene.materials[object.value.material].value)
}

/// Reads the needs off the objects that exist; what is only defined needs nothing.
pub fn needs(scene: &Scene) -> Needs {
    let kinds = worn(scene).map(|material| material.surface.kind);
    Needs {
        materials: kinds
            .flat_map(|kind| [Some(kind), kind.texture_of()])
            .flatten()
            .collect(),
        dispersion: worn(scene).any(|m| m.surface.disperses()),
        emission: worn(scene).any(|m| m.emission.is_some()),
        lens: scene.camera.lens.is_some(),
        implicit: scene
            .objects
            .iter()
            .any(|o| matches!(o.value.shape, Shape::Implicit(_))),
    }
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

/// Everything switched on, whether it can happen or not.
pub fn everything() -> Needs {
    Needs {
        materials: MaterialKind::ALL.iter().copied().collect(),
        dispersion: true,
        emission: true,
        lens: true,
        implicit: true,
    }
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
