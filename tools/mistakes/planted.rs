//! Deliberate mistakes, planted in the tables of a finished plan: the loop that ships runs unchanged.
//!
//! Where a mistake is a factor that depends on the direction, it is planted in a scene where all
//! directions are alike, so that the tables can hold exactly what the wrong code would compute: the
//! cosine under parallel light, the Fresnel term under one angle of incidence. With the feature `planted`
//! both are also planted in the loop itself, where scenes may have all directions.

use etalon::inside::camera::LaneCamera;
use etalon::inside::declare::Value;
use etalon::inside::integrate::model::{Appearance, Model};
use etalon::inside::integrate::needs::Needs;
use etalon::inside::integrate::parts::Parts;
use etalon::inside::light::{LightShape, Place, SmallLights};
use etalon::inside::material::{MaterialKind, fresnel};
use etalon::inside::math::lanes::Scalar;
use etalon::inside::plan::Tables;
#[cfg(feature = "planted")]
use etalon::inside::planted::Planted;
use etalon::inside::spectrum::grid::{CELLS, WavelengthGrid};
use etalon::inside::spectrum::{NM_MAX, NM_MIN};
use etalon::{Plan, Scene};
use glam::DMat3;

/// What can be wrong; [`MISTAKES`] has the words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mistake {
    Reflectance,
    Cosine,
    Polarisation,
    Wavelengths,
    Lens,
    Bounce,
    Normals,
    LightChoice,
    /// One in the loop itself.
    #[cfg(feature = "planted")]
    Loop(Planted),
}

pub const MISTAKES: &[(Mistake, &str)] = &[
    (
        Mistake::Reflectance,
        "a reflectance 0.5 % too high in one material",
    ),
    (Mistake::Cosine, "cosine forgotten in one lobe"),
    (
        Mistake::Polarisation,
        "Fresnel term with one polarisation counted twice",
    ),
    (Mistake::Wavelengths, "wavelength pdf off by a smooth 1 %"),
    (Mistake::Lens, "lens radius 1 % off"),
    (Mistake::Bounce, "one bounce too few"),
    (Mistake::Normals, "normals not renormalised under shear"),
    (
        Mistake::LightChoice,
        "lights chosen with another probability than believed",
    ),
    #[cfg(feature = "planted")]
    (
        Mistake::Loop(Planted::Cosine),
        "cosine forgotten in direct light, from all directions",
    ),
    #[cfg(feature = "planted")]
    (
        Mistake::Loop(Planted::Polarisation),
        "Fresnel term with one polarisation counted twice, at all angles",
    ),
];

/// Wavelengths per path of all scenes here.
const WAVELENGTHS: usize = 8;
/// Relative error of the wavelength density at its worst.
const DENSITY_ERROR: f64 = 0.01;
/// Angle of incidence of the scene with metal, degrees.
const INCIDENCE: f64 = 60.0;

/// Plants a mistake wherever the plan has a place for it; says whether it had.
pub fn plant(mistake: Mistake, scene: &Scene, plan: &mut Plan) -> bool {
    assert_eq!(plan.choices.wavelengths as usize, WAVELENGTHS);
    match &mut plan.tables {
        Tables::Single(tables) => planted(mistake, scene, &mut tables.0),
        Tables::Double(tables) => planted(mistake, scene, &mut tables.0),
    }
}

fn planted<T: Scalar>(mistake: Mistake, scene: &Scene, model: &mut Model<T>) -> bool {
    match mistake {
        Mistake::Reflectance => reflectance(model),
        Mistake::Cosine => cosine(scene, model),
        Mistake::Polarisation => polarisation(scene, model),
        Mistake::Wavelengths => wavelengths(model),
        Mistake::Lens => lens(scene, model),
        Mistake::Bounce => {
            let limited = model.max_depth != u32::MAX;
            model.max_depth -= u32::from(limited);
            limited
        }
        Mistake::Normals => normals(scene, model),
        Mistake::LightChoice => light_choice(model),
        #[cfg(feature = "planted")]
        Mistake::Loop(mistake) => {
            model.planted = Some(mistake);
            match mistake {
                Planted::Cosine => !model.lights.is_empty(),
                Planted::Polarisation => model.needs.materials.contains(MaterialKind::Conductor),
            }
        }
    }
}

/// A spectrum of the bank times a function of the wavelength in nm.
fn scaled<T: Scalar>(model: &mut Model<T>, start: u32, factor: impl Fn(f64) -> f64) -> u32 {
    let rows = CELLS / WAVELENGTHS;
    let table = model.spectra.rows::<WAVELENGTHS>();
    let value = |(cell, nm): (usize, f64)| {
        table[start as usize + cell % rows][cell / rows].to_f64() * factor(nm)
    };
    let values: Vec<f64> = middles().into_iter().enumerate().map(value).collect();
    model.spectra.push(&values)
}

/// Middles of the cells of the wavelength grid, nm. Scenes here have no spectra that jump.
fn middles() -> Vec<f64> {
    let grid = WavelengthGrid::default();
    let cells = (0..CELLS).map(|cell| grid.cell(cell));
    cells.map(|(low, high)| (low + high) / 2.0).collect()
}

/// The loop reads appearances by part.
fn refresh<T: Scalar>(model: &mut Model<T>) {
    model.parts = Parts::new(&model.shapes, &model.appearances);
    model.needs = Needs::new(&model.parts, &model.appearances, model.camera.has_lens());
}

fn reflectance<T: Scalar>(model: &mut Model<T>) -> bool {
    let diffuse = |a: &&Appearance<T>| a.surface.kind == MaterialKind::Diffuse;
    let Some(material) = model.appearances.iter().find(diffuse).map(|s| s.material) else {
        return false;
    };
    for object in 0..model.appearances.len() {
        let appearance = model.appearances[object];
        if appearance.material == material && diffuse(&&appearance) {
            let spectrum = appearance.surface.spectra[0];
            model.appearances[object].surface.spectra[0] = scaled(model, spectrum, |_| 1.005);
        }
    }
    refresh(model);
    true
}

/// The scene's only receiver lies in the plane y = 0, and `direction` has length 1.
fn cosine<T: Scalar>(scene: &Scene, model: &mut Model<T>) -> bool {
    let mut found = false;
    let [light] = scene.lights.as_slice() else {
        return false;
    };
    let Some(Place::Towards(towards)) = light.place(scene.camera.from) else {
        return false;
    };
    for k in 0..model.lights.len() {
        if matches!(model.lights[k].shape, LightShape::Directional(_)) {
            let spectrum = model.lights[k].spectrum;
            model.lights[k].spectrum = scaled(model, spectrum, |_| 1.0 / towards.y);
            found = true;
        }
    }
    found
}

/// All rays meet the metal, the scene's only object, at [`INCIDENCE`].
fn polarisation<T: Scalar>(scene: &Scene, model: &mut Model<T>) -> bool {
    let cosine = INCIDENCE.to_radians().cos();
    let mut found = false;
    if scene.objects.len() != 1 {
        return false;
    }
    for object in 0..model.appearances.len() {
        let material = &scene.materials[model.appearances[object].material as usize].value;
        let [Value::Index(index)] = material.surface.values.as_slice() else {
            continue;
        };
        if material.surface.kind != MaterialKind::Conductor {
            continue;
        }
        let reflectance = |nm: f64| {
            let (n, k) = index.n_k(nm);
            let [s, p] = fresnel::conductor_polarised(cosine, n, k);
            (2.0 * s + p) / 3.0
        };
        let values: Vec<f64> = middles().into_iter().map(reflectance).collect();
        let surface = &mut model.appearances[object].surface;
        surface.spectra[0] = model.spectra.push(&values);
        surface.kind = MaterialKind::Mirror;
        found = true;
    }
    if found {
        refresh(model);
    }
    found
}

/// Dividing by a density that is wrong multiplies every contribution by the ratio; each one is linear
/// in an emission.
fn wavelengths<T: Scalar>(model: &mut Model<T>) -> bool {
    let factor = |nm: f64| {
        let turns = (nm - NM_MIN) / (NM_MAX - NM_MIN);
        1.0 / (1.0 + DENSITY_ERROR * (2.0 * std::f64::consts::TAU * turns).sin())
    };
    if let Some(environment) = model.environment {
        model.environment = Some(scaled(model, environment, factor));
    }
    for k in 0..model.lights.len() {
        let spectrum = model.lights[k].spectrum;
        model.lights[k].spectrum = scaled(model, spectrum, factor);
    }
    for object in 0..model.appearances.len() {
        if let Some(emission) = model.appearances[object].emission {
            model.appearances[object].emission = Some(scaled(model, emission, factor));
        }
    }
    model.small_lights = SmallLights::new(&model.lights).map(Box::new);
    refresh(model);
    true
}

fn lens<T: Scalar>(scene: &Scene, model: &mut Model<T>) -> bool {
    let mut camera = scene.camera;
    if let Some(lens) = &mut camera.lens {
        lens.radius *= 1.01;
    }
    model.camera = LaneCamera::new(&camera, scene.image.size);
    camera.lens.is_some()
}

/// The normal of canonical z = 0 is the third row of the inverse, those of a cube's faces are all
/// three, each divided by its length; here they are not.
fn normals<T: Scalar>(scene: &Scene, model: &mut Model<T>) -> bool {
    let mut found = false;
    let parts = &mut model.parts;
    for (number, entry) in parts.entries.iter_mut().enumerate() {
        let object = &scene.objects[entry.object as usize].value;
        let [a, b, c] = object.to_world.columns();
        let inverse = DMat3::from_cols(a, b, c).inverse();
        let first = parts.first[entry.object as usize] as usize;
        let flat = parts
            .first
            .get(entry.object as usize + 1)
            .is_none_or(|next| *next == first as u32 + 1);
        let axis = if flat { 2 } else { number - first };
        // Sizes are no shear: canonical coordinates are those of the shape of size 1.
        let length = inverse.row(axis).length() * object.size[axis].abs();
        if (length - 1.0).abs() < 1e-12 {
            continue;
        }
        found = true;
        let longer = |x: T| T::from_f64(x.to_f64() * length);
        entry.vector = entry.vector.map(longer);
        entry.level = longer(entry.level);
        entry.half = longer(entry.half);
        if let Some(small) = &mut parts.small {
            for (column, x) in small.vector.iter_mut().zip(entry.vector) {
                column[number] = x;
            }
            small.level[number] = entry.level;
            small.half[number] = entry.half;
        }
    }
    found
}

fn light_choice<T: Scalar>(model: &mut Model<T>) -> bool {
    let count = model.lights.len();
    if count < 2 {
        return false;
    }
    for light in &mut model.lights {
        light.probability = T::from_f64(1.0 / count as f64);
    }
    model.small_lights = SmallLights::new(&model.lights).map(Box::new);
    true
}
