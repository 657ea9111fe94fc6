//! How far off positions may be, and what that must be small against.
//!
//! `positions` bounds the error of a hit, `shadows` that of a hard shadow's edge, `pixels` finds how near
//! the camera an object is seen, and [`gaps`] finds the smallest distance between two objects. Each is an
//! extreme over all objects by itself, so that another object can only make it worse.

mod faces;
pub mod gaps;
mod pixels;
mod positions;
mod shadows;

use glam::DVec3;

use crate::camera::pixel_size;
use crate::math::affine::Affine;
use crate::scene::{Object, Scene, Shape};
use crate::shape::hierarchy::Bounds;
use crate::shape::{Placed, ShapeKind};
use positions::Error;

/// Share of a pixel's width that single precision may blur.
pub const PIXEL_SHARE: f64 = 1e-2;
/// Share of the smallest gap between objects that it may blur. A half would keep every point on
/// its side of the gap; an eighth of that keeps what is seen through it, too, as errors have
/// either sign and hardly ever their worst size.
pub const GAP_SHARE: f64 = 1.0 / 16.0;

/// What a precision may blur in a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blur {
    /// Bound on the error of a hit in each coordinate, across the ray and across the surface, scene
    /// units, where no coordinate is above `reach`; on an infinite plane it grows on with that.
    pub position: f64,
    /// Largest coordinate, about the camera, of the objects' boxes and of where camera rays begin.
    pub reach: f64,
    /// The largest share that the error, or the shift of a hard shadow, takes of a pixel's width where the
    /// pixel sees it; in parallel projection within `reach`.
    pub pixels: f64,
    /// Smallest gap between two objects, scene units, if there is any.
    pub gap: Option<f64>,
}

impl Blur {
    /// Bounds for a scene in arithmetic of this unit roundoff.
    pub fn new(scene: &Scene, roundoff: f64) -> Self {
        let sites = sites(scene);
        let start = start(scene);
        let reach = sites.iter().map(Site::reach).fold(start, f64::max);
        let central = scene.camera.projection.kind.is_central();
        let pixel = pixel_size(&scene.camera.projection, scene.image.size[1]);
        let mut blur = Self {
            position: 0.0,
            reach,
            pixels: shadows::shift(scene, &sites, roundoff, reach) / pixel,
            gap: gaps::smallest(&sites),
        };
        for site in &sites {
            let error = Error::new(site, roundoff);
            let worst = error.at(reach);
            let angle = if central {
                error.angle(pixels::nearest(site, DVec3::ZERO), start)
            } else {
                worst
            };
            blur.position = blur.position.max(worst);
            blur.pixels = blur.pixels.max(angle / pixel);
        }
        blur
    }

    /// Whether it shows nowhere.
    pub fn is_small(&self) -> bool {
        let room = self.gap.is_none_or(|gap| self.position <= GAP_SHARE * gap);
        self.pixels <= PIXEL_SHARE && room
    }
}

/// Where an object is, about the camera.
#[derive(Debug)]
pub struct Site {
    /// Its place in the list of objects.
    index: usize,
    /// Its shape; `None` for implicit surfaces.
    kind: Option<ShapeKind>,
    /// Canonical coordinates → world.
    to_world: Affine,
    /// The inverse, rounded from double-double.
    inverse: Affine,
    /// Opposite corners of the shape in canonical coordinates, if it has an end.
    corners: Option<[DVec3; 2]>,
    /// Its box, if it has an end.
    bounds: Option<Bounds>,
}

impl Site {
    /// `None` where the map has no inverse in f64.
    fn new(scene: &Scene, index: usize) -> Option<Self> {
        let object = &scene.objects[index].value;
        let to_world = about_camera(scene, object);
        let placed = Placed::new(ShapeKind::Plane, &to_world).ok()?;
        let inverse = placed.ladder.inverse();
        let finite = inverse.rows.iter().flatten().all(|x| x.is_finite());
        finite.then(|| Self {
            index,
            kind: object.shape.kind(),
            to_world,
            inverse,
            corners: object.shape.corners(),
            bounds: bounds(&object.shape, &to_world),
        })
    }

    /// Largest magnitude of a coordinate, for an infinite plane that of the part close to the camera.
    fn reach(&self) -> f64 {
        self.bounds
            .as_ref()
            .map_or_else(|| pixels::nearest(self, DVec3::ZERO), reach)
    }
}

/// All objects whose place has an inverse: the others are refused later, by name.
pub fn sites(scene: &Scene) -> Vec<Site> {
    let count = scene.objects.len();
    (0..count).filter_map(|k| Site::new(scene, k)).collect()
}

/// How far from the camera's position its rays begin.
fn start(scene: &Scene) -> f64 {
    let lens = scene.camera.lens.map_or(0.0, |lens| lens.radius);
    let projection = scene.camera.projection;
    if projection.kind.is_central() {
        return lens;
    }
    let [x, y] = scene.image.size.map(f64::from);
    lens + projection.height() / 2.0 * libm::hypot(x / y, 1.0)
}

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

/// Largest magnitude of a coordinate.
pub fn reach(bounds: &Bounds) -> f64 {
    bounds.low.abs().max(bounds.high.abs()).max_element()
}
