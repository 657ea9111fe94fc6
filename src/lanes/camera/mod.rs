//! The camera: from pixel and lens positions to rays.
//!
//! All geometry of the loop is about the camera's position, so that the precision of a picture
//! does not depend on where in the world it is taken.

mod kind;
mod orthographic;
mod perspective;

use glam::DVec3;

use crate::declare::{Parameter, Quantity, Range, Usual, Value};
use crate::math::lanes::{Lanes, Scalar};
use crate::math::ray::Ray;
use crate::math::vec3::Vec3;
use crate::sample::sequence::CameraSample;
use crate::sample::warp::square_to_disk;

pub use kind::{Project, Projection, ProjectionKind};

/// Position, direction and optics of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position of the lens centre, scene units.
    pub from: DVec3,
    /// A point straight ahead.
    pub to: DVec3,
    /// The direction that is up in the picture; default +y.
    pub up: DVec3,
    /// What the image plane shows.
    pub projection: Projection,
    /// A thin lens; `None` is a pinhole.
    pub lens: Option<Lens>,
}

/// A thin lens, sharp on the plane at distance `focus` (along the view axis).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Radius of the circular aperture, scene units, > 0.
    pub radius: f64,
    /// Distance of the plane of focus, scene units, > 0.
    pub focus: f64,
}

impl Camera {
    /// Where it stands and looks.
    pub const VIEW: [Parameter; 3] = [
        Parameter::new("from", "position of the lens centre", Quantity::Point),
        Parameter::new("to", "a point straight ahead", Quantity::Point),
        Parameter::new("up", "what is up in the picture", Quantity::Direction)
            .usually(Usual::Direction(DVec3::Y)),
    ];
    /// Its lens.
    pub const LENS: Parameter = Parameter::new(
        "lens",
        "a thin lens",
        Quantity::Table(&[
            Parameter::new(
                "radius",
                "radius of the aperture",
                Quantity::number("scene units", Range::NOT_NEGATIVE),
            ),
            Parameter::new(
                "focus",
                "distance of the plane of focus",
                Quantity::number("scene units", Range::POSITIVE),
            ),
        ]),
    )
    .usually(Usual::Nothing);

    /// A camera of the values of [`Self::VIEW`] and [`Self::LENS`], in this order; a lens of radius 0 is
    /// a pinhole.
    pub fn new(values: &[Value], projection: Projection) -> Option<Self> {
        let vectors: Vec<DVec3> = values.iter().filter_map(Value::vector).collect();
        let numbers: Vec<f64> = values.iter().filter_map(Value::number).collect();
        let &[from, to, up] = vectors.as_slice() else {
            return None;
        };
        let lens = match *numbers.as_slice() {
            [radius, focus] if radius > 0.0 => Some(Lens { radius, focus }),
            _ => None,
        };
        Some(Self {
            from,
            to,
            up,
            projection,
            lens,
        })
    }
}

/// The camera's orthonormal axes in world space: right, up, forward.
pub fn axes(camera: &Camera) -> [DVec3; 3] {
    let forward = (camera.to - camera.from).normalize();
    let right = forward.cross(camera.up).normalize();
    [right, right.cross(forward), forward]
}

/// Size of a pixel on the plane at distance 1 (perspective) or in scene units (orthographic).
pub fn pixel_size(projection: &Projection, height: u32) -> f64 {
    projection.height() / f64::from(height)
}

/// The ray through the centre of pixel (x, y), y downwards, in world coordinates: from the pinhole
/// or the centre of the lens, whose ray goes straight on, or parallel to the view axis. Its
/// direction has the component 1 along the view axis, so t is the depth along that axis.
pub fn centre_ray(camera: &Camera, size: [u32; 2], [x, y]: [u32; 2]) -> Ray {
    let [right, up, forward] = axes(camera);
    let pixel = pixel_size(&camera.projection, size[1]);
    let across = (f64::from(x) + 0.5 - f64::from(size[0]) / 2.0) * pixel;
    let above = (f64::from(size[1]) / 2.0 - (f64::from(y) + 0.5)) * pixel;
    let in_plane = right * across + up * above;
    let kind = camera.projection.kind;
    let (origin, direction) = kind.ray(DVec3::ZERO, forward, in_plane);
    Ray {
        origin: camera.from + origin,
        direction,
    }
}

/// A camera as lanes use it; its position is the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneCamera<T> {
    axes: [[T; 3]; 3],
    pixel_size: T,
    centre: [T; 2],
    projection: ProjectionKind,
    /// Lens radius and focus distance.
    lens: Option<(T, T)>,
}

impl<T: Scalar> LaneCamera<T> {
    /// Rounds a camera for an image of the given size in pixels.
    pub fn new(camera: &Camera, size: [u32; 2]) -> Self {
        Self {
            axes: axes(camera).map(|v| v.to_array().map(T::from_f64)),
            pixel_size: T::from_f64(pixel_size(&camera.projection, size[1])),
            centre: size.map(|n| T::from_f64(f64::from(n) / 2.0)),
            projection: camera.projection.kind,
            lens: camera
                .lens
                .map(|lens| (T::from_f64(lens.radius), T::from_f64(lens.focus))),
        }
    }

    /// Whether there is a lens.
    pub fn has_lens(&self) -> bool {
        self.lens.is_some()
    }

    /// Origin and unit direction of the rays through pixels (x, y), y downwards.
    #[inline(always)]
    pub fn rays<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        x: L::Int,
        y: L::Int,
        sample: &CameraSample<L>,
    ) -> (Vec3<L::Real>, Vec3<L::Real>) {
        let axis = inlined!(|i: usize| {
            let [x, y, z] = self.axes[i];
            Vec3::new(l.splat(x), l.splat(y), l.splat(z))
        });
        let (right, up, forward) = (axis(0), axis(1), axis(2));
        let size = l.splat(self.pixel_size);
        let [u, v] = sample.pixel;
        let across = ((l.to_real(x) - l.splat(self.centre[0])) + u) * size;
        let above = ((l.splat(self.centre[1]) - l.to_real(y)) - v) * size;
        let zero = Vec3::splat(l, DVec3::ZERO);
        let in_plane = zero.along(right, across).along(up, above);
        let (origin, direction) = self.projection.ray(zero, forward, in_plane);
        let Some((radius, focus)) = self.lens else {
            return (origin, direction.normalized(l));
        };
        let (lens_x, lens_y) = square_to_disk(l, sample.lens[0], sample.lens[1]);
        let radius = l.splat(radius);
        let shift = zero
            .along(right, lens_x * radius)
            .along(up, lens_y * radius);
        // `direction` has a forward component of 1, so this is on the plane of focus.
        let to_focus = direction.scale(l.splat(focus)) - shift;
        (origin + shift, to_focus.normalized(l))
    }
}
