//! Layers of the picture that are asked for.
//!
//! Depth, normal, object and material are those of the first surface on the ray through the
//! pixel's centre, decided exactly; nothing is averaged over the pixel.

use etalon::film::pixels::Estimate;
use etalon::film::spectral::Bin;
use etalon::film::{Channel, Picture, names};
use etalon::render::Rendered;
use etalon::render::bins::BinGrid;
use etalon::render::target::{FirstHit, first_hits};
use glam::DVec3;

use super::super::args::Render;
use super::super::error::CommandError;
use super::super::values::{Layer, SpectralRange};
use super::job::Job;

/// The bins of plain `--layers spectral`: the visible range as most tables have it.
const USUAL_BINS: SpectralRange = SpectralRange {
    from: 400.0,
    to: 700.0,
    step: 10.0,
};

/// The spectral bins asked for; where several are, the last counts.
pub fn bins(layers: &[Layer]) -> Result<Option<BinGrid>, CommandError> {
    let asked = layers.iter().rev().find_map(|layer| match layer {
        Layer::Spectral(range) => Some(range.unwrap_or(USUAL_BINS)),
        _ => None,
    });
    asked
        .map(|range| Ok(BinGrid::new(range.from, range.to, range.step)?))
        .transpose()
}

/// Channels of the other layers.
pub fn channel_count(layers: &[Layer]) -> usize {
    let count = |layer: &Layer| match layer {
        Layer::Depth | Layer::Object | Layer::Material => 1,
        Layer::Normal => 3,
        Layer::Spectral(_) => 0,
    };
    layers.iter().map(count).sum()
}

/// Adds the layers asked for.
pub fn push(
    picture: &mut Picture,
    arguments: &Render,
    job: &Job,
    rendered: &Rendered,
) -> Result<(), CommandError> {
    let wanted = |layer: Layer| arguments.layers.contains(&layer);
    let kinds = [Layer::Depth, Layer::Normal, Layer::Object, Layer::Material];
    if kinds.into_iter().any(wanted) {
        let hits = first_hits(&job.scene, job.window, arguments.instructions)?;
        if wanted(Layer::Depth) {
            let depth =
                |hit: &Option<FirstHit>| hit.as_ref().map_or(f64::INFINITY, |hit| hit.t) as f32;
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
            let of =
                |hit: &Option<FirstHit>| hit.as_ref().map_or(names::NOTHING, |hit| of(hit) as u32);
            let values = hits.iter().map(of).collect();
            picture.channels.push(Channel::integer(name, values));
        };
        if wanted(Layer::Object) {
            identities(names::OBJECT_ID, &|hit| hit.object);
        }
        if wanted(Layer::Material) {
            identities(names::MATERIAL_ID, &|hit| {
                job.scene.objects[hit.object].value.material
            });
        }
    }
    push_spectral(picture, job, rendered);
    Ok(())
}

fn push_spectral(picture: &mut Picture, job: &Job, rendered: &Rendered) {
    let Some(grid) = &job.bins else {
        return;
    };
    let replicates = job.plan.choices.replicates.count(rendered.samples);
    let bin = |(index, &nm): (usize, &f64)| {
        let estimates = rendered.bin(index)?;
        let single = |value: fn(&Estimate<1>) -> f64| {
            let values = estimates.iter().map(|e| value(e) as f32);
            values.collect::<Vec<_>>()
        };
        Some(Bin {
            nm,
            sensitivity: Vec::new(),
            values: single(|e| e.mean[0]),
            standard_errors: if replicates > 1 {
                single(|e| e.standard_error[0])
            } else {
                Vec::new()
            },
        })
    };
    let bins = grid.centres().iter().enumerate().filter_map(bin).collect();
    picture.push_spectral(bins);
}
