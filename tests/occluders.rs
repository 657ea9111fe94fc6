//! Shadow rays ask only what can hide a light.

#![allow(
    clippy::unwrap_used,
    reason = "the tests' own scenes are right, and what they hold is known"
)]

use std::path::Path;

use etalon::inside::integrate::list::List;
use etalon::inside::integrate::model::Model;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::plan::Tables;
use etalon::inside::render::{Request, Unwatched, render};
use etalon::inside::scene;
use etalon::{Overrides, Plan, Scene};

/// A room whose walls have everything on one side, with a lamp below its ceiling; objects 0 to 3.
const ROOM: &str = r#"
[camera]
from = [0, 0, 0.9]
to = [0, 0, 0]
fov = 80
[image]
size = [24, 24]
spp = 8
max_depth = 4
sampler = "independent"
[materials]
white = { diffuse = 0.75 }
silver = { mirror = "Ag" }
lamp = { diffuse = 0.1, emit = 1 }
[[object]]
shape = { rectangle = { size = [2, 2] } }
material = "white"
transform = [{ rotate_x = -90 }, { translate = [0, -1, 0] }]
[[object]]
shape = { rectangle = { size = [2, 2] } }
material = "white"
transform = [{ translate = [0, 0, -1] }]
[[object]]
shape = { rectangle = { size = [2, 2] } }
material = "white"
transform = [{ rotate_x = 90 }, { translate = [0, 1, 0] }]
[[object]]
shape = { rectangle = { size = [0.5, 0.5] } }
material = "lamp"
transform = [{ rotate_x = 90 }, { translate = [0, 0.99, 0] }]
"#;

/// A box in the room.
const CUBE: &str = r#"
[[object]]
shape = { cube = { side = 0.5 } }
material = "white"
transform = [{ translate = [-0.3, -0.75, -0.3] }]
"#;

fn scene_of(text: &str) -> Scene {
    scene::parse("room", text, Path::new("."), &Overrides::default()).unwrap()
}

fn occluders(text: &str) -> Vec<u32> {
    match Plan::new(&scene_of(text), false).unwrap().tables {
        Tables::Single(tables) => tables.0.occluders.objects,
        Tables::Double(tables) => tables.0.occluders.objects,
    }
}

/// An object with a material and a transform behind the room's own.
fn with(shape: &str, material: &str, transform: &str) -> String {
    format!(
        "{ROOM}\n[[object]]\nshape = {{ {shape} }}\nmaterial = \"{material}\"\ntransform = \
         [{transform}]\n"
    )
}

#[test]
fn walls_of_a_room_hide_nothing() {
    assert!(occluders(ROOM).is_empty());
    assert_eq!(occluders(&format!("{ROOM}{CUBE}")), [4]);
}

/// Whatever ends of shadow rays there are behind a wall, it hides the light from there: a diffuse
/// object poking through, one wholly behind, a lamp behind. What samples no light does not count.
#[test]
fn what_reaches_behind_a_wall_makes_it_count() {
    let through = with(
        "sphere = { radius = 0.25 }",
        "white",
        "{ translate = [0, 0, -1.1] }",
    );
    assert_eq!(occluders(&through), [1, 4]);
    let behind = with(
        "cube = { side = 0.2 }",
        "white",
        "{ translate = [0, 1.5, 0] }",
    );
    assert_eq!(occluders(&behind), [2, 4]);
    let below = with(
        "sphere = { radius = 0.1 }",
        "lamp",
        "{ translate = [0.2, -1.5, 0.1] }",
    );
    // Of two lamps, each can hide the other from what is on its far side: the ceiling is above one.
    assert_eq!(occluders(&below), [0, 3, 4]);
    let plane = with("plane = {}", "white", "{ translate = [0, 0, -1.5] }");
    assert_eq!(occluders(&plane), [0, 1, 2]);
    let mirror = with(
        "sphere = { radius = 0.25 }",
        "silver",
        "{ translate = [0, 0, -1.1] }",
    );
    assert_eq!(occluders(&mirror), [4]);
}

#[test]
fn lights_without_a_surface_count_as_ends() {
    let point = format!("{ROOM}\n[[light]]\npoint = [0, 2, 0]\nintensity = 1\n");
    assert_eq!(occluders(&point), [2, 3]);
    let inside = format!("{ROOM}\n[[light]]\npoint = [0, 0.5, 0]\nintensity = 1\n");
    assert_eq!(occluders(&inside), [3]);
    // Light from above and in front; the back wall and the floor cannot be in its way.
    let sun = format!("{ROOM}\n[[light]]\ndirection = [0, -1, -1]\nirradiance = 1\n");
    assert_eq!(occluders(&sun), [2, 3]);
}

/// The bits of a picture whose shadow rays ask `hiding`, or what the plan says.
fn bits(scene: &Scene, hiding: Option<&[u32]>) -> Vec<[u64; 3]> {
    let mut plan = Plan::new(scene, false).unwrap();
    if let Some(hiding) = hiding {
        fn ask_only<T: Scalar>(model: &mut Model<T>, hiding: &[u32]) {
            model.occluders = List::new(hiding.to_vec(), &model.shapes, &model.parts.first);
        }
        match &mut plan.tables {
            Tables::Single(tables) => ask_only(&mut tables.0, hiding),
            Tables::Double(tables) => ask_only(&mut tables.0, hiding),
        }
    }
    let request = Request::whole(scene.image.size, scene.image.spp);
    let estimates = render(&plan, &request, &mut Unwatched).xyz();
    estimates.iter().map(|e| e.mean.map(f64::to_bits)).collect()
}

/// Asking everything gives the same bits; asking nothing does not.
#[test]
fn what_is_left_out_cannot_show() {
    for precision in ["f32", "f64"] {
        let text = format!("{ROOM}{CUBE}")
            .replace("spp = 8", &format!("spp = 8\nprecision = \"{precision}\""));
        let scene = scene_of(&text);
        let planned = bits(&scene, None);
        assert_eq!(planned, bits(&scene, Some(&[0, 1, 2, 3, 4])), "{precision}");
        assert_ne!(planned, bits(&scene, Some(&[])), "{precision}");
    }
}
