//! Shadow rays ask only what can hide a light.

use etalon::inside::integrate::list::List;
use etalon::inside::integrate::model::Model;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::plan::Tables;
use etalon::{Plan, Scene};

use crate::support::{object, pixel_bits, rendered};

/// A room whose walls have everything on one side, with a lamp below its ceiling; objects 0 to 3.
const ROOM: &str = r#"
camera = { from = [0, 0, 0.9], to = [0, 0, 0], fov = 80 }
image = { size = [24, 24], spp = 8, max_depth = 4, sampler = "independent" }
materials.white = { diffuse = 0.75 }
materials.silver = { mirror = "Ag" }
materials.lamp = { diffuse = 0.1, emit = 1 }
"#;

/// Its scene file, with more than is in it.
fn room(more: &str) -> String {
    let wall = |place: &str| object("{ rectangle = { size = [2, 2] } }", "white", place);
    let lamp = "{ rotate_x = 90 }, { translate = [0, 0.99, 0] }";
    let objects = [
        wall("{ rotate_x = -90 }, { translate = [0, -1, 0] }"),
        wall("{ translate = [0, 0, -1] }"),
        wall("{ rotate_x = 90 }, { translate = [0, 1, 0] }"),
        object("{ rectangle = { size = [0.5, 0.5] } }", "lamp", lamp),
    ];
    format!("{ROOM}{}{more}", objects.concat())
}

/// With a box in it, object 4.
fn room_and_cube() -> String {
    let place = "{ translate = [-0.3, -0.75, -0.3] }";
    room(&object("{ cube = { side = 0.5 } }", "white", place))
}

fn occluders(text: &str) -> Vec<u32> {
    match Plan::new(&Scene::parse(text).unwrap(), false)
        .unwrap()
        .tables
    {
        Tables::Single(tables) => tables.0.occluders.objects,
        Tables::Double(tables) => tables.0.occluders.objects,
    }
}

#[test]
fn walls_of_a_room_hide_nothing() {
    assert!(occluders(&room("")).is_empty());
    assert_eq!(occluders(&room_and_cube()), [4]);
}

/// Whatever ends of shadow rays there are behind a wall, it hides the light from there: a diffuse
/// object poking through, one wholly behind, a lamp behind. What samples no light does not count.
#[test]
fn what_reaches_behind_a_wall_makes_it_count() {
    let ball = "{ sphere = { radius = 0.25 } }";
    for (shape, material, at, hiding) in [
        (ball, "white", "[0, 0, -1.1]", &[1, 4][..]),
        ("{ cube = { side = 0.2 } }", "white", "[0, 1.5, 0]", &[2, 4]),
        // Of two lamps, each can hide the other from what is on its far side: the ceiling is above one.
        (
            "{ sphere = { radius = 0.1 } }",
            "lamp",
            "[0.2, -1.5, 0.1]",
            &[0, 3, 4],
        ),
        ("\"plane\"", "white", "[0, 0, -1.5]", &[0, 1, 2]),
        (ball, "silver", "[0, 0, -1.1]", &[4]),
    ] {
        let thing = object(shape, material, &format!("{{ translate = {at} }}"));
        let found = occluders(&room(&thing));
        assert_eq!(found, hiding, "{shape} of {material} at {at}");
    }
}

#[test]
fn lights_without_a_surface_count_as_ends() {
    for (light, hiding) in [
        ("point = [0, 2, 0]\nintensity = 1", &[2, 3][..]),
        ("point = [0, 0.5, 0]\nintensity = 1", &[3]),
        // Light from above and in front; the back wall and the floor cannot be in its way.
        ("direction = [0, -1, -1]\nirradiance = 1", &[2, 3]),
    ] {
        let found = occluders(&room(&format!("[[light]]\n{light}\n")));
        assert_eq!(found, hiding, "{light}");
    }
}

/// The bits of a picture whose shadow rays ask `hiding`, or what the plan says.
fn bits(scene: &Scene, hiding: Option<&[u32]>) -> Vec<[[u64; 3]; 2]> {
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
    pixel_bits(&rendered(scene, &plan))
}

/// Asking everything gives the same bits; asking nothing does not.
#[test]
fn what_is_left_out_cannot_show() {
    for precision in ["f32", "f64"] {
        let text =
            room_and_cube().replace("spp = 8", &format!("spp = 8, precision = \"{precision}\""));
        let scene = Scene::parse(&text).unwrap();
        let planned = bits(&scene, None);
        assert_eq!(planned, bits(&scene, Some(&[0, 1, 2, 3, 4])), "{precision}");
        assert_ne!(planned, bits(&scene, Some(&[])), "{precision}");
    }
}
