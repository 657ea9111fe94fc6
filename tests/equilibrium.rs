//! Rooms in thermal equilibrium: what reflects the share r of all light emits 1 − r itself, so that
//! everything has radiance 1 (G. Kirchhoff, "Über das Verhältniß zwischen dem Emissionsvermögen und
//! dem Absorptionsvermögen der Körper für Wärme und Licht", Annalen der Physik 185 (1860)). Rooms,
//! objects and cameras are invented, so that no corner of a shape's light is met by luck alone.

use etalon::inside::stats::family::sidak;
use etalon::{Estimate, Plan, Scene};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::support::{object, rendered};

const ROOMS: u64 = 300;
/// Probability of a false alarm of all of them together.
const LEVEL: f64 = 1e-4;

/// What rare paths may bring, which a few hundred samples cannot have an error bar for: of 1 000
/// rooms two were 2.5e-5 off, ten of their standard errors, and right with 65 536 paths a pixel.
const RARE: f64 = 1e-4;

fn number(rng: &mut Pcg64Mcg, low: f64, high: f64) -> f64 {
    // Few digits: places that rounding hits exactly, and others by half a step.
    (rng.random_range(low..high) * 20.0).round() / 20.0
}

fn triple(rng: &mut Pcg64Mcg, size: f64) -> String {
    triple_within([0.0; 3], rng, size)
}

fn triple_within(place: [f64; 3], rng: &mut Pcg64Mcg, size: f64) -> String {
    let [x, y, z] = place.map(|x| number(rng, x - size, x + size));
    format!("[{x}, {y}, {z}]")
}

fn turn(rng: &mut Pcg64Mcg) -> String {
    let axis = ["x", "y", "z"][rng.random_range(0..3)];
    let angle = [0, 90, 30, 45, 17][rng.random_range(0..5)];
    format!("{{ rotate_{axis} = {angle} }}")
}

/// A room around the origin, and objects at the corners of a cube about the camera, apart from each
/// other: in glass everything would have to emit n² times as much. `lost` is what
/// the walls fail to emit, of 1.
fn room(number_of_room: u64, lost: f64) -> Scene {
    let rng = &mut Pcg64Mcg::seed_from_u64(number_of_room);
    let reflectance = [0.2, 0.5, 0.8][rng.random_range(0..3)];
    let emission = 1.0 - reflectance - lost;
    let sky = rng.random_range(0..4) == 0;
    let wall = match rng.random_range(0..4) {
        0 | 1 => {
            let side = number(rng, 6.0, 12.0);
            format!("{{ cube = {{ side = {side} }} }}")
        }
        2 => format!("{{ sphere = {{ radius = {} }} }}", number(rng, 4.0, 8.0)),
        _ => {
            let (radius, height) = (number(rng, 4.0, 8.0), number(rng, 8.0, 12.0));
            format!("{{ cylinder = {{ radius = {radius}, height = {height} }} }}")
        }
    };
    let lean = [
        "",
        "{ scale = [1, 1.3, 0.9] }, ",
        "{ scale = [0.9, 1, 1.2] }, { shear = { xz = 0.3, yx = -0.2 } }, ",
    ][rng.random_range(0..3)];
    let place = format!(
        "{lean}{}, {{ translate = {} }}",
        turn(rng),
        triple(rng, 1.0)
    );
    let lens = ["", ", lens = { radius = 0.1, focus = 2 }"][rng.random_range(0..2)];
    let environment = if sky {
        format!("environment = {}", 1.0 - lost)
    } else {
        String::new()
    };
    let mut text = format!(
        r#"
{environment}
camera = {{ from = {}, to = {}, fov = 70{lens} }}
image = {{ size = [8, 8], spp = 256 }}
[materials]
wall = {{ diffuse = {reflectance}, emit = {emission}, sides = "back" }}
bright = {{ diffuse = 0.2, emit = 0.8, sides = "both" }}
dull = {{ diffuse = 0.9, emit = 0.1, sides = "both" }}
mirror = {{ mirror = {{ ideal = 1 }} }}
water = {{ glass = "water" }}
"#,
        triple(rng, 0.3),
        triple_within([1.0, 0.5, -1.0], rng, 0.2),
    );
    let ground = "{ rotate_x = -90 }, { translate = [0, -3, 0] }";
    text += &if sky {
        object("\"plane\"", "dull", ground)
    } else {
        object(&wall, "wall", &place)
    };
    for corner in 0..rng.random_range(0..8) {
        let shape = [
            "cube = { side = 0.5 }",
            "sphere = { radius = 0.3 }",
            "cylinder = { radius = 0.2, height = 0.4 }",
            "disk = { radius = 0.4 }",
            "rectangle = { size = [0.5, 0.3] }",
            "implicit = \"heart\", inside = [[-1.2, -0.75, -1.05], [1.2, 0.75, 1.3]]",
        ][rng.random_range(0..6)];
        let size = [1.0, 0.3][usize::from(shape.starts_with("implicit"))];
        let flat = shape.starts_with("disk") || shape.starts_with("rectangle");
        let materials = ["bright", "dull", "mirror", "water"];
        let material = materials[rng.random_range(0..if flat { 3 } else { 4 })];
        let stretch = [1.0, 1.5][rng.random_range(0..2)] * size;
        let place = [0, 1, 2].map(|bit| f64::from(corner >> bit & 1) * 2.0 - 1.0);
        let place = format!(
            "{{ scale = [{size}, {stretch}, {size}] }}, {}, {{ translate = {} }}",
            turn(rng),
            triple_within(place, rng, 0.2)
        );
        text += &object(&format!("{{ {shape} }}"), material, &place);
    }
    Scene::parse(&text).unwrap()
}

fn mean(scene: &Scene) -> Estimate {
    let plan = Plan::new(scene, false).unwrap();
    Estimate {
        // At least one for each of the 64 pixels, which are scrambled on their own.
        freedom: 64.0,
        ..rendered(scene, &plan).mean_luminance()
    }
}

/// The rooms whose walls fail to emit so much and that are told from radiance 1.
fn noticed(lost: f64) -> Vec<String> {
    let mut noticed = Vec::new();
    for number in 0..ROOMS {
        let mean = mean(&room(number, lost));
        let p = mean.p_value(1.0, RARE);
        if p < sidak(LEVEL, ROOMS as usize) {
            noticed.push(format!("room {number}: {mean:?}, p = {p:.1e}"));
        }
    }
    noticed
}

#[test]
fn in_equilibrium_nothing_can_be_told_from_anything() {
    let wrong = noticed(0.0);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_wall_that_emits_one_per_cent_too_little_is_noticed() {
    let caught = noticed(0.01).len();
    // Walls fill most of most pictures.
    assert!(10 * caught as u64 >= 9 * ROOMS, "{caught} of {ROOMS}");
}
