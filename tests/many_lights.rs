//! Many lights are chosen by a search, few by comparisons: both must light the same.

use etalon::inside::plan::Tables;
use etalon::inside::render::{Request, Unwatched, render};
use etalon::{Estimate, Plan, Scene};

use crate::support::object;

const HEAD: &str = r#"
camera = { from = [0, 1, 3], to = [0, 0, 0], fov = 50 }
image = { size = [8, 8], spp = 64, max_depth = 2 }
materials.floor = { diffuse = 0.5 }
materials.lamp = { emit = 1 }
materials.bright = { emit = 4 }
"#;

/// A floor under a lamp of 2 × 2 in so many tiles to a side, a third of which shine four times as
/// bright: how the lamp is cut decides how many lights there are to choose from.
fn scene(tiles: u32) -> Scene {
    let floor = "{ rectangle = { size = [4, 4] } }";
    let mut text = HEAD.to_owned() + &object(floor, "floor", "{ rotate_x = -90 }");
    let side = 2.0 / f64::from(tiles);
    for i in 0..tiles * tiles {
        let place = |k: u32| (f64::from(k) + 0.5) * side - 1.0;
        let (x, z) = (place(i % tiles), place(i / tiles));
        // Bright are the places on the left, a third of the lamp in any number of tiles.
        let material = ["lamp", "bright"][usize::from(3 * (i % tiles) < tiles)];
        let shape = format!("{{ rectangle = {{ size = [{side}, {side}] }} }}");
        let place = format!("{{ rotate_x = 90 }}, {{ translate = [{x}, 2, {z}] }}");
        text += &object(&shape, material, &place);
    }
    Scene::parse(&text).unwrap()
}

fn mean(scene: &Scene, seed: u64, disturb: impl Fn(&mut Plan)) -> Estimate {
    let mut scene = scene.clone();
    scene.image.seed = seed;
    let mut plan = Plan::new(&scene, false).unwrap();
    disturb(&mut plan);
    let request = Request::whole(scene.image.size, 4096);
    let rendered = render(&plan, &request, &mut Unwatched);
    assert_eq!(rendered.not_a_number, 0);
    Estimate {
        // Thousands of degrees of freedom: 64 pixels of many replicates.
        freedom: f64::INFINITY,
        ..rendered.mean_luminance()
    }
}

/// Of each of three tests: one false alarm in ten thousand.
const LEVEL: f64 = 1e-4;

#[test]
fn a_lamp_in_many_tiles_lights_as_one_in_few() {
    let few = mean(&scene(3), 1, |_| {});
    for tiles in [6, 12] {
        let many = mean(&scene(tiles), 2, |_| {});
        let difference = many.minus(&few);
        let p = difference.p_value(0.0, 0.0);
        assert!(p > LEVEL, "{tiles}: {few:?} {many:?}, p = {p}");
        assert!(difference.standard_error < 1e-3 * few.value, "{tiles}");
    }
}

#[test]
fn a_light_chosen_with_another_probability_than_it_is_divided_by_is_noticed() {
    let few = mean(&scene(3), 1, |_| {});
    let many = mean(&scene(6), 2, |plan| {
        let lights = match &mut plan.tables {
            Tables::Single(tables) => &mut tables.0.lights,
            Tables::Double(_) => panic!("single precision does for this scene"),
        };
        assert!(lights.len() > 16);
        // One of the twelve bright tiles, 1/18 of all light, counts 11 % too much.
        lights[0].probability *= 0.9;
    });
    let p = many.minus(&few).p_value(0.0, 0.0);
    assert!(p < LEVEL, "{few:?} {many:?}, p = {p}");
}
