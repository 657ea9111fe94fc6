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
mod index;
mod materials;
mod objects;
mod overlay;
mod quantities;
mod spectra;
mod transform;
mod tree;

pub use error::{Diagnostic, Origin, SceneError};
pub use file::{LARGEST_FILE, Overrides, load, panel_names, parse, read};

use std::path::Path;

use glam::DVec3;

pub use crate::camera::{Camera, Lens, Projection, ProjectionKind};
pub use crate::light::{Place, Source as Light};
pub use crate::material::Surface;
use crate::math::affine::Affine;
pub use crate::sample::SamplerKind;
pub use crate::shape::Shape;
pub use crate::shape::implicit::{FinderChoice, Implicit};
use crate::spectrum::Spectrum;

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

/// The scene file's path and its own text, and what was laid over it, for messages and provenance.
#[derive(Debug, Clone, Default)]
pub struct Source {
    /// The path as it was given.
    pub path: String,
    /// The whole text of the file.
    pub text: String,
    /// What was laid over it besides the panel: dotted keys and TOML values, in this order.
    pub set: Vec<(String, String)>,
}

impl Scene {
    /// Reads the scene file at `path`.
    ///
    /// # Errors
    /// [`SceneError`] for a file that cannot be read or holds no valid scene; it says where and why.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::load_with(path, &Overrides::default())
    }

    /// Reads a scene file and lays a panel, settings, or a finder over it.
    ///
    /// # Errors
    /// As [`Scene::load`], and for what is laid over.
    pub fn load_with(path: impl AsRef<Path>, over: &Overrides) -> Result<Self, SceneError> {
        load(path.as_ref(), over)
    }

    /// Reads a scene from the text of a scene file; the files it names are looked for from the
    /// current directory.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        parse("scene", text, Path::new(""), &Overrides::default())
    }

    /// The names of the panels of a scene file, in its order.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn panels(path: impl AsRef<Path>) -> Result<Vec<String>, SceneError> {
        let path = path.as_ref();
        panel_names(&path.display().to_string(), &read(path)?)
    }

    /// Takes this many samples a pixel, as `image.spp` laid over the file would.
    pub fn set_samples(&mut self, spp: u32) {
        self.image.spp = spp;
        self.lay("image.spp", spp.to_string());
    }

    /// Takes this seed, as `image.seed` laid over the file would.
    pub fn set_seed(&mut self, seed: u64) {
        self.image.seed = seed;
        self.lay("image.seed", seed.to_string());
    }

    /// The material of one of the scene's objects.
    pub fn material_of(&self, object: &Object) -> &Material {
        &self.materials[object.material].value
    }

    fn lay(&mut self, key: &str, value: String) {
        self.source.set.retain(|(other, _)| other != key);
        self.source.set.push((key.to_owned(), value));
    }
}

/// A value with the name the file gives it.
#[derive(Debug, Clone)]
pub struct Named<T> {
    /// The name; objects without one are called by their shape and index.
    pub name: String,
    /// The value itself.
    pub value: T,
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

/// The precision that a scene asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrecisionChoice {
    /// Single where the plan can show that it suffices, else double.
    Auto,
    /// Single precision lanes.
    F32,
    /// Double precision lanes.
    F64,
}

impl PrecisionChoice {
    pub(crate) const ALL: [Self; 3] = [Self::Auto, Self::F32, Self::F64];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
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

/// What a surface does with light: it may reflect, and it may emit besides.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// How light is scattered.
    pub surface: Surface,
    /// Radiance emitted equally in all directions of the emitting sides.
    pub emission: Option<Emission>,
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

impl Sides {
    pub(crate) const ALL: [Self; 3] = [Self::Front, Self::Back, Self::Both];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Back => "back",
            Self::Both => "both",
        }
    }

    /// Whether front and back are among them.
    pub fn front_and_back(self) -> [bool; 2] {
        [self != Self::Back, self != Self::Front]
    }
}
