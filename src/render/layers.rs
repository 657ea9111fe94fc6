//! Optional layers of a picture.

use glam::DVec3;

use super::bins::BinGrid;
use super::session::Rendered;
use super::tile::Window;
use super::trace::{FirstHit, Singular, first_hits};
use crate::film::pixels::Estimate;
use crate::film::spectral::Bin;
use crate::film::{Channel, Picture, names};
use crate::math::instructions::Instructions;
use crate::scene::Scene;

/// A layer about the first surface on the ray through each pixel's centre, decided exactly; nothing
/// is averaged over the pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// Depth along the view axis, scene units; infinite where nothing is visible.
    Depth,
    /// Unit normal, world coordinates; zero where nothing is visible.
    Normal,
    /// Index of the object.
    Object,
    /// Index of the object's material.
    Material,
}

impl Layer {
    /// All layers, with their names on the command line and in messages.
    pub const ALL: [(&str, Self); 4] = [
        ("depth", Self::Depth),
        ("normal", Self::Normal),
        ("object", Self::Object),
        ("material", Self::Material),
    ];

    /// Number of channels.
    pub fn channels(self) -> usize {
        match self {
            Self::Depth | Self::Object | Self::Material => 1,
            Self::Normal => 3,
        }
    }
}

/// Adds the layers asked for.
pub(super) fn push(
    picture: &mut Picture,
    layers: &[Layer],
    scene: &Scene,
    window: Window,
    instructions: Instructions,
) -> Result<(), Singular> {
    if layers.is_empty() {
        return Ok(());
    }
    let hits = first_hits(scene, window, instructions)?;
    let wanted = |layer: Layer| layers.contains(&layer);
    if wanted(Layer::Depth) {
        let depth = |hit: &Option<FirstHit>| hit.as_ref().map_or(f64::INFINITY, |h| h.t) as f32;
        let depths = hits.iter().map(depth).collect();
        picture.channels.push(Channel::float(names::DEPTH, depths));
    }
    if wanted(Layer::Normal) {
        let normal = |hit: &Option<FirstHit>| hit.as_ref().and_then(|hit| hit.normal);
        let single = |n: Option<DVec3>| n.unwrap_or(DVec3::ZERO).as_vec3().to_array();
        let normals: Vec<_> = hits.iter().map(|hit| single(normal(hit))).collect();
        picture.push_triple(names::NORMAL, names::XYZ, &normals);
    }
    let mut identities = |name: &str, of: &dyn Fn(&FirstHit) -> usize| {
        let of = |hit: &Option<FirstHit>| hit.as_ref().map_or(names::NOTHING, |h| of(h) as u32);
        let values = hits.iter().map(of).collect();
        picture.channels.push(Channel::integer(name, values));
    };
    if wanted(Layer::Object) {
        identities(names::OBJECT_ID, &|hit| hit.object);
    }
    if wanted(Layer::Material) {
        identities(names::MATERIAL_ID, &|hit| {
            scene.objects[hit.object].value.material
        });
    }
    Ok(())
}

/// Adds a channel for each spectral bin.
pub(super) fn push_spectral(picture: &mut Picture, grid: &BinGrid, rendered: &Rendered) {
    let known = rendered.replicates() > 1;
    let bin = |(index, &nm): (usize, &f64)| {
        let estimates = rendered.bin(index)?;
        let single = |value: fn(&Estimate<1>) -> f64| {
            let values = estimates.iter().map(|e| value(e) as f32);
            values.collect::<Vec<_>>()
        };
        Some(Bin {
            nm,
            values: single(|e| e.mean[0]),
            standard_errors: known.then(|| single(|e| e.standard_error[0])),
        })
    };
    picture.push_spectral(grid.centres().iter().enumerate().filter_map(bin));
}
