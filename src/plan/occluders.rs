//! Which objects can stand between a surface and a light.
//!
//! A shadow ray runs from a point of a surface that samples lights to a point of a light. A flat
//! object with all of those on one side of its plane, the walls of a room, say, meets no such ray
//! but at its ends, and a ray's own light does not hide its own point. What remains is tested.

use glam::DVec3;

use super::bounds::about_camera;
use crate::math::affine::Affine;
use crate::scene::{Place, Scene, Shape};
use crate::shape::ShapeKind;

/// Points relative to a plane: the range of their signed distances.
type Range = [f64; 2];

/// Most objects for which it pays to look at each pair; among more, a flat one that hides nothing is
/// one of many.
const MOST: usize = 1 << 10;

/// The objects that shadow rays have to be tested against, in order; `lit` are the objects whose
/// light is sampled, `roundoff` that of the coordinates of hits.
pub fn occluders(scene: &Scene, lit: &[u32], roundoff: f64) -> Vec<u32> {
    let placed: Vec<Affine> = scene
        .objects
        .iter()
        .map(|o| about_camera(scene, &o.value))
        .collect();
    let is_end = |k: usize| {
        let material = scene.material_of(&scene.objects[k].value);
        material.surface.kind.is_spread() || lit.contains(&(k as u32))
    };
    let hides = |k: usize| {
        if scene.lights.is_empty() && lit.iter().all(|&light| light as usize == k) {
            return false;
        }
        if placed.len() > MOST {
            return true;
        }
        let Some((normal, height)) = plane(&scene.objects[k].value.shape, &placed[k]) else {
            return true;
        };
        let ends = (0..placed.len()).filter(|&i| i != k && is_end(i));
        let objects = ends.map(|i| range(&scene.objects[i].value.shape, &placed[i], normal));
        let places = scene.lights.iter();
        let places = places.filter_map(|light| light.place(scene.camera.from));
        let lights = places.map(|place| match place {
            Place::At(at) => [normal.dot(at); 2],
            // From any end, the ray leaves towards where the light comes from.
            Place::Towards(direction) => match normal.dot(direction) {
                0.0 => [height; 2],
                away if away > 0.0 => [height, f64::INFINITY],
                _ => [f64::NEG_INFINITY, height],
            },
        });
        let [low, high] = objects.chain(lights).fold([height; 2], |[low, high], r| {
            [low.min(r[0]), high.max(r[1])]
        });
        // What stands out by less than the rounding of a hit's coordinates (6 unit roundoffs of the
        // largest, as in `shape::lanes`) cannot be told from the plane.
        let reach = placed[k].translation().abs().max_element();
        let blur = 6.0 * roundoff * (reach + height.abs());
        low < height - blur && high > height + blur
    };
    (0..placed.len())
        .filter(|&k| hides(k))
        .map(|k| k as u32)
        .collect()
}

/// Unit normal and height of the plane of a flat shape.
fn plane(shape: &Shape, to_world: &Affine) -> Option<(DVec3, f64)> {
    if !shape.kind().is_some_and(ShapeKind::is_flat) {
        return None;
    }
    let [a, b, _] = to_world.columns();
    let normal = a.cross(b).try_normalize()?;
    Some((normal, normal.dot(to_world.translation())))
}

/// The range of normal · p over an object: of its image for the canonical shapes, of the image of
/// its box for implicit surfaces.
fn range(shape: &Shape, to_world: &Affine, normal: DVec3) -> Range {
    let along = DVec3::from_array(to_world.columns().map(|axis| axis.dot(normal)));
    let mut middle = normal.dot(to_world.translation());
    let half = match shape {
        Shape::Canonical(kind) => kind.half_range(along),
        Shape::Implicit(implicit) => {
            let [low, high] = implicit.inside;
            middle += along.dot((low + high) / 2.0);
            along.abs().dot((high - low) / 2.0)
        }
    };
    [middle - half, middle + half]
}
