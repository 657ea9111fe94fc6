//! How large things are and how close, for the choice of precision.

use glam::DVec3;

use super::faces;
use crate::camera::pixel_size;
use crate::math::affine::{Affine, ROUNDED};
use crate::scene::{Object, Projection, Scene, Shape};
use crate::shape::ShapeKind;
use crate::shape::hierarchy::Bounds;

/// The object's map with the camera at the origin.
pub fn about_camera(scene: &Scene, object: &Object) -> Affine {
    let mut rows = object.to_world.rows;
    for (row, from) in rows.iter_mut().zip(scene.camera.from.to_array()) {
        row[3] -= from;
    }
    Affine { rows }
}

/// Bounds of a placed shape about the camera: the image of its canonical box; infinite planes have
/// none.
pub fn bounds(shape: &Shape, to_world: &Affine) -> Option<Bounds> {
    let [low, high] = shape.corners()?;
    Some(Bounds::of_image(to_world, low, high))
}

/// Distance between two boxes; 0 where they touch or overlap.
fn gap(a: &Bounds, b: &Bounds) -> f64 {
    let apart = (b.low - a.high).max(a.low - b.high);
    apart.max(DVec3::ZERO).length()
}

/// Largest magnitude of a coordinate.
pub fn reach(bounds: &Bounds) -> f64 {
    bounds.low.abs().max(bounds.high.abs()).max_element()
}

/// Centre and radius where the object is a sphere under a similarity.
pub fn as_ball(object: &Object, to_world: &Affine) -> Option<(DVec3, f64)> {
    if object.shape != Shape::Canonical(ShapeKind::Sphere) {
        return None;
    }
    let axes = to_world.columns();
    let radius = axes[0].length();
    to_world
        .is_similarity()
        .then_some((to_world.translation(), radius))
}

/// Pairs are compared up to this many objects; larger scenes are dense, and the pixel decides.
const LARGEST_PAIRWISE: usize = 512;

/// Smallest positive gap between two objects: exact for balls beside or inside each other, between
/// bounding boxes for the rest, and where these overlap between parallel faces and round walls (0, which
/// is contact or overlap, does not count).
pub fn smallest_gap(scene: &Scene) -> Option<f64> {
    if scene.objects.len() > LARGEST_PAIRWISE {
        return None;
    }
    let placed: Vec<_> = scene
        .objects
        .iter()
        .filter_map(|o| {
            let to_world = about_camera(scene, &o.value);
            let bounds = bounds(&o.value.shape, &to_world)?;
            Some((bounds, as_ball(&o.value, &to_world)))
        })
        .collect();
    let mut smallest = smallest_between_faces(scene);
    for (i, (bounds, ball)) in placed.iter().enumerate() {
        for (other_bounds, other_ball) in &placed[i + 1..] {
            let between = match (ball, other_ball) {
                (Some((c1, r1)), Some((c2, r2))) => {
                    let centres = c1.distance(*c2);
                    (centres - r1 - r2).max((r1 - r2).abs() - centres)
                }
                _ => gap(bounds, other_bounds),
            };
            if between > ROUNDED * reach(bounds).max(reach(other_bounds)) {
                smallest = smallest.min(between);
            }
        }
    }
    smallest.is_finite().then_some(smallest)
}

/// The same between faces and round walls of objects whose bounding boxes overlap; infinite planes are
/// wherever other things are.
fn smallest_between_faces(scene: &Scene) -> f64 {
    let placed: Vec<_> = scene
        .objects
        .iter()
        .filter_map(|o| {
            let to_world = about_camera(scene, &o.value);
            let shape = &o.value.shape;
            Some((shape.kind()?, to_world, bounds(shape, &to_world)))
        })
        .collect();
    let mut smallest = f64::INFINITY;
    for (i, (shape, to_world, bounds)) in placed.iter().enumerate() {
        for (other, other_to_world, other_bounds) in &placed[i + 1..] {
            let apart = match (bounds, other_bounds) {
                (Some(a), Some(b)) => gap(a, b) > 0.0,
                _ => false,
            };
            if !apart {
                let between = faces::gap((*shape, to_world), (*other, other_to_world));
                smallest = smallest.min(between);
            }
        }
    }
    smallest
}

/// Bound on the error of a hit's position in arithmetic of unit roundoff `roundoff`, and the
/// width of a pixel there, for the object where their ratio is worst; scene units.
///
/// A point goes to object coordinates and back: with |o| up to the scene's reach s, the local
/// errors Eᵢ of `shape::lanes` carried through the map, plus the rounding of the result.
pub fn worst_error(
    scene: &Scene,
    roundoff: f64,
    inverse_of: impl Fn(&Affine) -> Option<Affine>,
) -> Error {
    let reach = scene
        .objects
        .iter()
        .filter_map(|o| bounds(&o.value.shape, &about_camera(scene, &o.value)))
        .map(|b| reach(&b))
        .fold(0.0, f64::max);
    let pixel = pixel_size(&scene.camera.projection, scene.image.size[1]);
    let mut worst = Error {
        position: 0.0,
        pixel: f64::INFINITY,
    };
    for object in &scene.objects {
        let to_world = about_camera(scene, &object.value);
        let Some(inverse) = inverse_of(&to_world) else {
            continue;
        };
        let row_sum = |r: &[f64; 4]| r[0].abs() + r[1].abs() + r[2].abs();
        let local = inverse
            .rows
            .map(|r| 6.5 * roundoff * (row_sum(&r) * reach + r[3].abs() + 1.0));
        let back = |r: &[f64; 4]| {
            r[0].abs() * local[0]
                + r[1].abs() * local[1]
                + r[2].abs() * local[2]
                + 4.0 * roundoff * (row_sum(r) + r[3].abs())
        };
        let position = to_world.rows.iter().map(back).fold(0.0, f64::max);
        let distance = to_world.translation().length();
        let width = match scene.camera.projection {
            Projection::Perspective { .. } => pixel * distance,
            Projection::Orthographic { .. } => pixel,
        };
        if position * worst.pixel > worst.position * width || worst.pixel.is_infinite() {
            worst = Error {
                position: position.max(worst.position),
                pixel: width,
            };
        }
    }
    worst
}

/// A position error beside the width of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Error {
    /// Bound on the error of a position, scene units.
    pub position: f64,
    /// Width of a pixel there, scene units.
    pub pixel: f64,
}
