//! A path that is traced again, every vertex of it written down.

use glam::DVec3;

/// What happened where a path met a surface, or left the scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Vertex {
    /// Segments traced before this one.
    pub depth: u32,
    /// Start of the segment, scene units about the camera.
    pub origin: DVec3,
    /// Its unit direction.
    pub direction: DVec3,
    /// Its length, scene units; infinite where nothing was met.
    pub distance: f64,
    /// Index of the object that was met.
    pub object: Option<u32>,
    /// Where, scene units about the camera.
    pub point: DVec3,
    /// Unit outward normal.
    pub normal: DVec3,
    /// Whether the outward side was met.
    pub front: bool,
    /// Solid-angle density of the direction, sr⁻¹; `None` for a direction without alternative.
    pub arrival_pdf: Option<f64>,
    /// Weight of what the surface emits against light sampling, where it emits.
    pub emission_weight: Option<f64>,
    /// Throughput at each wavelength on arrival.
    pub throughput: Vec<f64>,
    /// The light that was sampled, if one was.
    pub light: Option<LightVertex>,
    /// Where the path goes on, unless it ended.
    pub scattered: Option<ScatteredVertex>,
    /// Radiance gathered so far at each wavelength.
    pub radiance: Vec<f64>,
}

/// A sampled light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightVertex {
    /// The emitting object; `None` for lights without a surface.
    pub object: Option<u32>,
    /// Unit direction towards it.
    pub direction: DVec3,
    /// Distance, scene units.
    pub distance: f64,
    /// cos/π · mis weight/(pdf · probability of the choice): what multiplies throughput × light.
    pub weight: f64,
    /// Whether something is in the way.
    pub blocked: bool,
}

/// A scattered direction.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatteredVertex {
    /// Unit direction.
    pub direction: DVec3,
    /// Solid-angle density, sr⁻¹; `None` for a direction without alternative.
    pub pdf: Option<f64>,
    /// Throughput at each wavelength of the path that goes on, roulette included.
    pub throughput: Vec<f64>,
}

/// A path that was replayed.
#[derive(Debug, Clone, PartialEq)]
pub struct Replayed {
    /// Wavelengths, nm.
    pub wavelengths: Vec<f64>,
    /// Index of the hero among them.
    pub hero: usize,
    pub vertices: Vec<Vertex>,
    /// What the sample adds to the picture: X, Y, Z.
    pub tristimulus: [f64; 3],
}
