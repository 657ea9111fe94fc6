//! From a scene and its choices to the tables of the loop.

use std::f64::consts::PI;

use glam::DVec3;

use super::PlanError;
use super::bounds::{self, about_camera};
use super::choose::Choices;
use super::occluders::occluders;
use crate::camera::LaneCamera;
use crate::declare::Value;
use crate::integrate::develop::Spectrometer;
use crate::integrate::list::List;
use crate::integrate::model::{Appearance, Many, Model};
use crate::integrate::needs::Needs;
use crate::integrate::parts::Parts;
use crate::light::{Emitting, LaneLight, LightShape, SmallLights};
use crate::math::affine::Affine;
use crate::math::lanes::Scalar;
use crate::sample::sequence::Sequence;
use crate::scene::{Light, Scene, Shape};
use crate::shape::hierarchy::Bounds;
use crate::shape::lanes::LaneShape;
use crate::shape::lanes::implicit::LaneImplicit;
use crate::shape::resolve::Resolver;
use crate::shape::{Emitter, Placed, ShapeKind};
use crate::spectrum::Spectrum;
use crate::spectrum::cells;
use crate::spectrum::grid::{SpectrumBank, WavelengthGrid};
use crate::spectrum::ior::RefractiveIndex;
use crate::spectrum::observer::spectrum_to_xyz;

/// What a list of objects may cost at most; beyond, boxes are sorted into a hierarchy. In the same
/// unit, a ball costs 1 and another shape 5. Measured on clouds of one cross-section over a floor
/// (AVX-512): a hierarchy takes as long as a list of about 85 balls, or of 20 objects of which two
/// thirds are cubes and cylinders.
pub const LARGEST_LIST: usize = 80;
/// What a shape that is no ball costs in a list.
const OTHER: usize = 5;

/// Builds model and spectrometer.
///
/// # Errors
/// [`PlanError::NotInvertible`] for a transform whose inverse leaves the range of f64.
pub fn build<T: Scalar>(
    scene: &Scene,
    choices: &Choices,
    grid: &WavelengthGrid,
) -> Result<(Model<T>, Spectrometer<T>), PlanError> {
    let mut builder = Builder::<T>::new(choices.wavelengths as usize, grid, scene);
    for (index, object) in scene.objects.iter().enumerate() {
        let placed = builder.place(scene, index);
        let maps = placed.ok_or_else(|| PlanError::NotInvertible {
            name: object.name.clone(),
        })?;
        builder.appearance(scene, index, &maps);
    }
    for light in &scene.lights {
        builder.source(light, scene.camera.from);
    }
    let environment = scene.environment.as_ref();
    let environment = environment.map(|spectrum| builder.spectrum(spectrum));
    let lights = builder.pick();
    let all: Vec<u32> = (0..scene.objects.len() as u32).collect();
    let occluders = if choices.full {
        all.clone()
    } else {
        let lit: Vec<u32> = lights.iter().map(|light| light.object).collect();
        occluders(scene, &lit, T::ROUNDOFF)
    };
    let parts = Parts::new(&builder.shapes, &builder.appearances);
    let camera = LaneCamera::new(&scene.camera, scene.image.size);
    let bounded = builder.bounded.iter();
    let costs = bounded.map(|(k, _)| match builder.shapes[*k as usize].ball() {
        Some(_) => 1,
        None => OTHER,
    });
    let many = costs.sum::<usize>() > LARGEST_LIST;
    let model = Model {
        hierarchy: many.then(|| {
            Many::new(
                &builder.bounded,
                builder.unbounded,
                &builder.shapes,
                &occluders,
            )
        }),
        needs: if choices.full {
            Needs::everything()
        } else {
            Needs::new(&parts, &builder.appearances, camera.has_lens())
        },
        camera,
        sequence: Sequence::new(
            scene.image.sampler,
            scene.image.seed,
            scene.image.spp,
            choices.replicates,
        ),
        max_depth: scene.image.max_depth.unwrap_or(u32::MAX),
        list: List::new(all, &builder.shapes, &parts.first),
        occluders: List::new(occluders, &builder.shapes, &parts.first),
        parts,
        shapes: builder.shapes,
        implicits: builder.implicits,
        appearances: builder.appearances,
        small_lights: SmallLights::new(&lights).map(Box::new),
        lights,
        environment,
        spectra: builder.bank,
        resolver: builder.resolver,
        planted: None,
    };
    Ok((model, Spectrometer::new(grid, choices.wavelengths as usize)))
}

struct Builder<'a, T> {
    bank: SpectrumBank<T>,
    grid: &'a WavelengthGrid,
    known: Vec<(Spectrum, u32)>,
    known_indices: Vec<(RefractiveIndex, [u32; 2])>,
    shapes: Vec<LaneShape<T>>,
    implicits: Vec<(u32, LaneImplicit<T>)>,
    appearances: Vec<Appearance<T>>,
    lights: Vec<(LaneLight<T>, f64)>,
    resolver: Resolver,
    bounded: Vec<(u32, Bounds)>,
    unbounded: Vec<u32>,
    reach: f64,
}

impl<'a, T: Scalar> Builder<'a, T> {
    fn new(wavelengths: usize, grid: &'a WavelengthGrid, scene: &Scene) -> Self {
        let bounds = scene.objects.iter().filter_map(|object| {
            let to_world = about_camera(scene, &object.value);
            bounds::bounds(&object.value.shape, &to_world)
        });
        Self {
            bank: SpectrumBank::new(wavelengths),
            grid,
            known: Vec::new(),
            known_indices: Vec::new(),
            shapes: Vec::new(),
            implicits: Vec::new(),
            appearances: Vec::new(),
            lights: Vec::new(),
            resolver: Resolver::default(),
            bounded: Vec::new(),
            unbounded: Vec::new(),
            reach: bounds.map(|b| bounds::reach(&b)).fold(0.0, f64::max),
        }
    }

    /// Start of a spectrum's cell means in the bank, shared by equal spectra.
    fn spectrum(&mut self, spectrum: &Spectrum) -> u32 {
        if let Some((_, start)) = self.known.iter().find(|(s, _)| s == spectrum) {
            return *start;
        }
        let start = self.bank.push(&cells::means(spectrum, self.grid.edges()));
        self.known.push((spectrum.clone(), start));
        start
    }

    /// Starts of n and k: at the lower ends of the cells, to be interpolated, for what refracts,
    /// and in the middle of the cells for what only reflects.
    fn refractive_index(&mut self, index: &RefractiveIndex) -> [u32; 2] {
        if let Some((_, starts)) = self.known_indices.iter().find(|(i, _)| i == index) {
            return *starts;
        }
        let edges = self.grid.edges();
        let (n, k): (Vec<f64>, Vec<f64>) = match index {
            RefractiveIndex::Complex { .. } => {
                let middles = edges.windows(2).map(|cell| (cell[0] + cell[1]) / 2.0);
                middles.map(|nm| index.n_k(nm)).unzip()
            }
            _ => edges.iter().map(|&nm| index.n_k(nm)).unzip(),
        };
        let starts = [self.bank.push(&n), self.bank.push(&k)];
        self.known_indices.push((index.clone(), starts));
        starts
    }

    /// Places object `index` for the lanes and for the ladder; its map to the world about the camera,
    /// and the inverse.
    fn place(&mut self, scene: &Scene, index: usize) -> Option<[Affine; 2]> {
        let object = &scene.objects[index].value;
        let to_world = about_camera(scene, object);
        let kind = object.shape.kind();
        let placed = Placed::new(kind.unwrap_or(ShapeKind::Cube), &to_world).ok()?;
        let inverse = placed.inverse();
        if !inverse.rows.iter().flatten().all(|x| x.is_finite()) {
            return None;
        }
        let start = START * self.reach;
        self.shapes
            .push(LaneShape::new(kind, &to_world, &inverse, start));
        match &object.shape {
            Shape::Implicit(implicit) => {
                let lanes = LaneImplicit::new(implicit, &to_world, &inverse).ok()?;
                self.implicits.push((index as u32, lanes));
            }
            Shape::Canonical(_) => {
                let surface = &scene.material_of(object).surface;
                let priority = u8::from(surface.kind.refracts());
                self.resolver.push(index as u32, placed, priority);
            }
        }
        match object.shape.corners() {
            Some([low, high]) => {
                let bounds = Bounds::around_image(&to_world, low, high);
                self.bounded.push((index as u32, bounds));
            }
            None => self.unbounded.push(index as u32),
        }
        Some([to_world, inverse])
    }

    /// Gives object `index` its appearance, and makes a light of it if it can be sampled.
    fn appearance(&mut self, scene: &Scene, index: usize, maps: &[Affine; 2]) {
        let object = &scene.objects[index].value;
        let material = scene.material_of(object);
        let surface = material.surface.record(object.size, |value| match value {
            Value::Spectrum(spectrum) => vec![self.spectrum(spectrum)],
            Value::Index(index) => self.refractive_index(index).into(),
            Value::Number(_) | Value::Point(_) | Value::Direction(_) => Vec::new(),
        });
        let mut appearance = Appearance {
            surface,
            emission: None,
            emits: [false; 2],
            light: None,
            material: object.material as u32,
        };
        if let Some(emission) = &material.emission {
            appearance.emission = Some(self.spectrum(&emission.radiance));
            appearance.emits = emission.sides.front_and_back();
            let light = LightShape::of_shape(&Emitting {
                form: object
                    .shape
                    .kind()
                    .map_or(Emitter::Unsampled, ShapeKind::emitter),
                to_world: &maps[0],
                inverse: &maps[1],
                emits: appearance.emits,
            });
            if let Some((shape, area)) = light {
                let power = area * PI * strength(&emission.radiance);
                appearance.light = self.light(shape, power, &emission.radiance, index as u32);
            }
        }
        self.appearances.push(appearance);
    }

    /// Lists a light of some power and returns its number.
    fn light(
        &mut self,
        shape: LightShape<T>,
        power: f64,
        spectrum: &Spectrum,
        object: u32,
    ) -> Option<u32> {
        (power > 0.0).then(|| {
            let light = LaneLight {
                shape,
                probability: T::default(),
                below: T::default(),
                spectrum: self.spectrum(spectrum),
                object,
            };
            self.lights.push((light, power));
            self.lights.len() as u32 - 1
        })
    }

    /// Lists a light without a surface.
    fn source(&mut self, light: &Light, camera: DVec3) -> Option<u32> {
        let spectrum = light.spectrum()?;
        // Planes alone have no size to tell what parallel light falls on.
        let area = if self.reach > 0.0 {
            self.reach * self.reach
        } else {
            1.0
        };
        let power = light.kind.power(area) * strength(spectrum);
        let shape = LightShape::of_source(light, camera)?;
        self.light(shape, power, spectrum, u32::MAX)
    }

    /// Probabilities of the lights: half in equal parts, half by power, so that a weak light close
    /// by is not starved.
    fn pick(&mut self) -> Vec<LaneLight<T>> {
        let total: f64 = self.lights.iter().map(|(_, power)| power).sum();
        let count = self.lights.len() as f64;
        let mut below = T::default();
        let mut sum = 0.0;
        let lights = std::mem::take(&mut self.lights);
        let last = lights.len().saturating_sub(1);
        let lights = lights.into_iter().enumerate();
        let picked = lights.map(|(i, (mut light, power))| {
            sum += 0.5 / count + 0.5 * power / total;
            let end = if i == last { 1.0 } else { sum };
            light.below = below;
            // Uniform numbers are multiples of the step in either precision: among such bounds the
            // probability is exactly their distance.
            let next = T::from_f64((end / PROBABILITY_STEP).round() * PROBABILITY_STEP);
            light.probability = T::from_f64(next.to_f64() - below.to_f64());
            below = next;
            light
        });
        picked.collect()
    }
}

/// How far rays usually start, over the largest coordinate of a bounded object: nearly all points
/// that a camera sees of an infinite floor are within that.
const START: f64 = 8.0;

/// Step of the probabilities of lights: that of uniform numbers in single precision, 2⁻²⁴.
const PROBABILITY_STEP: f64 = 1.0 / (1 << 24) as f64;

/// How much a spectrum counts when lights are chosen: its luminance, and a little of its largest value
/// so that light outside of the visible is still sampled.
fn strength(spectrum: &Spectrum) -> f64 {
    spectrum_to_xyz(spectrum)[1] + 1e-3 * spectrum.max_value()
}
