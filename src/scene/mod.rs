//! The scene as written: plain, checked values with units, and nothing clever.
//!
//! Angles are in degrees, wavelengths in nm, lengths in scene units, spectral
//! radiance in W·m⁻²·sr⁻¹·nm⁻¹. A [`Scene`] that exists is valid: every check of
//! values happens while the file is read (see [`parse`]).

mod build;
mod error;
mod fields;
mod file;
mod implicit;
mod materials;
mod names;
mod objects;
mod overlay;
mod spectra;
mod transform;
mod tree;

pub use error::{Diagnostic, SceneError};
pub use file::{LARGEST_FILE, Overrides, load, panel_names, parse, read};
pub use objects::PLAIN;

use std::sync::Arc;

use glam::DVec3;

use crate::field::expression::Expression;
use crate::math::affine::Affine;
use crate::spectrum::Spectrum;
use crate::spectrum::ior::RefractiveIndex;

/// A complete, validated scene description (one panel of a scene file).
#[derive(Debug, Clone)]
pub struct Scene {
    /// Where the text came from, kept for provenance.
    pub source: Source,
    /// The panel that was chosen, if the file has panels and one was asked for.
    pub panel: Option<String>,
    /// The camera.
    pub camera: Camera,
    /// Image size, sample counts and the choices of the estimator.
    pub image: Image,
    /// Materials, in the order of the file.
    pub materials: Vec<Named<Material>>,
    /// Objects, in the order of the file; the index is the object's identity.
    pub objects: Vec<Named<Object>>,
    /// Lights without a surface, in the order of the file.
    pub lights: Vec<Light>,
    /// Radiance that arrives from everywhere at infinity; absent means black.
    pub environment: Option<Spectrum>,
    /// Radiance that every pixel is known to have, where the answer is known in closed form.
    pub truth: Option<Spectrum>,
}

/// The scene file's path and text (after `--set` and the panel were laid over it, the text is
/// still the file's own), for messages and provenance.
#[derive(Debug, Clone)]
pub struct Source {
    /// Path as given on the command line.
    pub path: String,
    /// The whole text of the file.
    pub text: String,
}

/// A value with the name the file gives it.
#[derive(Debug, Clone)]
pub struct Named<T> {
    /// The name; objects without one are called by their shape and index.
    pub name: String,
    /// The value itself.
    pub value: T,
}

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

/// How image points become directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Central projection with this full *vertical* opening angle in degrees.
    Perspective {
        /// Full vertical opening angle, degrees, in (0, 180).
        fov: f64,
    },
    /// Parallel projection showing this height of the scene, in scene units.
    Orthographic {
        /// Height of the picture in scene units.
        height: f64,
    },
}

/// A thin lens, sharp on the plane at distance `focus` (along the view axis).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Radius of the circular aperture, scene units, > 0.
    pub radius: f64,
    /// Distance of the plane of focus, scene units, > 0.
    pub focus: f64,
}

/// Image size, sample counts and the choices of the estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Camera paths per pixel.
    pub spp: u32,
    /// Longest path in segments, counted as Mitsuba counts (1 emitted light only, 2 direct
    /// light); `None` is no limit.
    pub max_depth: Option<u32>,
    /// Which points the estimator uses.
    pub sampler: SamplerKind,
    /// Independent scrambles per pixel; `None` lets the plan choose from `spp`.
    pub replicates: Option<u32>,
    /// Seed of all randomness.
    pub seed: u64,
    /// Arithmetic of the path loop.
    pub precision: PrecisionChoice,
    /// Wavelengths per path; `None` lets the plan choose.
    pub wavelengths: Option<u32>,
}

/// The samplers by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SamplerKind {
    /// Every number drawn on its own.
    Independent,
    /// Strata visited in a random order per pixel.
    Stratified,
    /// Owen-scrambled Sobol' points.
    Sobol,
    /// One ray through the pixel's centre.
    Center,
}

impl SamplerKind {
    /// All of them, the usual one first.
    pub const ALL: [Self; 4] = [
        Self::Sobol,
        Self::Independent,
        Self::Stratified,
        Self::Center,
    ];

    /// The name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Stratified => "stratified",
            Self::Sobol => "sobol",
            Self::Center => "center",
        }
    }
}

/// What the user says about precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrecisionChoice {
    /// Single where the plan can show that it suffices, else double.
    Auto,
    /// Single precision lanes.
    F32,
    /// Double precision lanes.
    F64,
}

/// A placed shape with its material.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// The shape in its own coordinates.
    pub shape: Shape,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Size of the shape: object coordinates are canonical coordinates × `size`, so a cube of
    /// side 3 has 1.5 in each component. Only textures need it; `to_world` contains it already.
    pub size: DVec3,
    /// Canonical coordinates → world; the composed matrix *is* the object.
    pub to_world: Affine,
}

/// A shape in canonical object coordinates; sizes live in [`Object::to_world`].
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// x² + y² + z² = 1.
    Sphere,
    /// [-1, 1]³.
    Cube,
    /// x² + y² = 1 for |z| ≤ 1, with both caps.
    Cylinder,
    /// z = 0, x² + y² ≤ 1.
    Disk,
    /// z = 0, |x| ≤ 1, |y| ≤ 1.
    Rectangle,
    /// z = 0.
    Plane,
    /// f(x, y, z) = 0 inside a box.
    Implicit(Implicit),
}

/// The zeros of a field within a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Implicit {
    /// The named surface it is, if it is one.
    pub name: Option<&'static str>,
    /// The field, negative inside, in object coordinates.
    pub field: Arc<Expression>,
    /// The clip box in object coordinates: lower and upper corner.
    pub inside: [DVec3; 2],
    /// Where the box cuts the inside of the surface, its faces belong to the surface.
    pub closed: bool,
    /// How its hits are found.
    pub finder: FinderChoice,
    /// Steps along the clipped ray, for the finder that steps.
    pub steps: u32,
}

/// How hits on an implicit surface are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FinderChoice {
    /// What the plan chooses.
    #[default]
    Auto,
    /// Equal steps, a change of sign, bisection: the report's method, which proves nothing.
    SignChange,
    /// Steps as long as a proved Lipschitz bound allows.
    SphereTrace,
    /// Interval enclosures, for any field.
    Interval,
    /// Isolation of the roots of a polynomial along the ray.
    Polynomial,
}

impl FinderChoice {
    /// All finders by the names they have in scene files.
    pub const NAMES: &'static [(&'static str, Self)] = &[
        ("auto", Self::Auto),
        ("sign-change", Self::SignChange),
        ("sphere-trace", Self::SphereTrace),
        ("interval", Self::Interval),
        ("polynomial", Self::Polynomial),
    ];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        let known = Self::NAMES.iter().find(|(_, finder)| *finder == self);
        known.map_or("auto", |(name, _)| name)
    }
}

/// What a surface does with light: it may reflect, and it may emit besides.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// How light is scattered.
    pub surface: Surface,
    /// Radiance emitted equally in all directions of the emitting sides.
    pub emission: Option<Emission>,
}

/// How light is scattered.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// Nothing is reflected.
    Black,
    /// Lambertian reflection with this albedo, on both sides.
    Diffuse(Spectrum),
    /// Smooth conductor with n + ik, unpolarised Fresnel reflectance, on both sides.
    Conductor(RefractiveIndex),
    /// Mirror of constant (angle-independent) reflectance, on both sides.
    IdealMirror(Spectrum),
    /// Smooth dielectric; the object's inside has this index, its outside is vacuum.
    Glass(RefractiveIndex),
    /// Lambertian checkerboard of two albedos in object coordinates.
    Checkerboard {
        /// Albedo of cells whose index sum is even, and of the others.
        albedo: [Spectrum; 2],
        /// Edge of a cell in object coordinates (canonical coordinates × [`Object::size`]).
        cell: f64,
    },
}

/// Emitted radiance and the sides it leaves from.
#[derive(Debug, Clone, PartialEq)]
pub struct Emission {
    /// Spectral radiance.
    pub radiance: Spectrum,
    /// Sides that emit.
    pub sides: Sides,
}

/// Sides of a surface; front is outward of closed shapes, +z of flat ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// The outward or +z side.
    Front,
    /// The other side.
    Back,
    /// Both.
    Both,
}

/// A light that has no surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// Isotropic point source.
    Point {
        /// Position, scene units.
        at: DVec3,
        /// Radiant intensity, W·sr⁻¹·nm⁻¹.
        intensity: Spectrum,
    },
    /// Parallel light from infinity.
    Directional {
        /// Direction in which the light travels (unit).
        direction: DVec3,
        /// Irradiance on a surface facing the light, W·m⁻²·nm⁻¹.
        irradiance: Spectrum,
    },
}
