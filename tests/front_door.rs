//! The library as its users meet it: what the tour in `src/lib.rs` does not show.

use std::fs;
use std::path::Path;

use etalon::inside::scene::parse;
use etalon::{Attribute, Goal, Overrides, Progress, Render, Scene, Target, Window};

use crate::rooms::rust_files;
use crate::support::attribute;

const SCENE: &str = r#"
environment = 0.5
camera = { from = [0, 1, 6], to = [0, 0, 0], fov = 40 }
image = { size = [20, 18], spp = 8 }
materials.grey = { diffuse = 0.5 }
materials.lamp = { emit = 3 }

[[object]]
shape = "sphere"
material = "grey"

[[object]]
shape = "disk"
material = "lamp"
transform = [{ rotate_x = 90 }, { translate = [0, 3, 0] }]
"#;

#[test]
fn a_picture_holds_what_it_takes_to_make_it_again() {
    let mut scene = Scene::parse(SCENE).unwrap();
    scene.set_samples(4);
    let mut render = Render::new(scene).unwrap();
    render.reseed(7);
    let picture = render.picture(&render.run()).unwrap();
    let over = Overrides {
        set: Overrides::pairs(attribute(&picture, "settings")),
        ..Overrides::default()
    };
    let text = attribute(&picture, "sceneText");
    let scene = parse("again", text, Path::new(""), &over).unwrap();
    assert_eq!((scene.image.spp, scene.image.seed), (4, 7));
    let render = Render::new(scene).unwrap();
    let again = render.picture(&render.run()).unwrap();
    assert_eq!(again.channels, picture.channels);
}

#[test]
fn a_picture_says_where_it_comes_from_once() {
    let mirror = SCENE.replace("{ diffuse = 0.5 }", "{ mirror = \"Ag\" }");
    let lights = "[[light]]\npoint = [0, 9, 0]\nintensity = 1\n".repeat(2);
    let limited = SCENE.replace("spp = 8", "spp = 8, max_depth = 2");
    let [unlimited, limited] = [format!("{mirror}\n{lights}"), limited].map(|text| {
        let mut render = Render::new(Scene::parse(&text).unwrap()).unwrap();
        render.reseed(u64::MAX);
        let picture = render.picture(&render.run()).unwrap();
        picture.check().unwrap();
        picture
    });
    assert_eq!(attribute(&unlimited, "seed"), "18446744073709551615");
    assert_eq!(unlimited.attribute("spp"), Some(&Attribute::Int(8)));
    assert_eq!(unlimited.attribute("nanCount"), Some(&Attribute::Int(0)));
    assert_eq!(attribute(&unlimited, "maxDepth"), "unlimited");
    assert!(unlimited.attribute("energyCutByMaxDepth").is_none());
    let lights = [0, 1].map(|i| format!("point light {i} by way of mirrors and glass"));
    assert_eq!(attribute(&unlimited, "lightsLeftOut"), lights.join(", "));

    assert_eq!(limited.attribute("maxDepth"), Some(&Attribute::Int(2)));
    let cut = limited.attribute("energyCutByMaxDepth");
    assert!(
        matches!(cut, Some(Attribute::Double(share)) if (0.0..1.0).contains(share)),
        "{cut:?}"
    );
    assert_eq!(attribute(&limited, "lightsLeftOut"), "none");
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
    for (name, _) in &limited.attributes {
        assert!(name.chars().all(plain), "{name}");
    }
}

#[test]
fn means_over_regions_are_those_of_their_pixels() {
    let render = Render::new(Scene::parse(SCENE).unwrap()).unwrap();
    let whole = render.run();
    let mean = whole.mean(render.window()).unwrap();
    // The same sums in another order: 360 additions of at most an ulp each.
    let other = whole.mean_luminance();
    assert!((mean.luminance.value / other.value - 1.0).abs() < 360.0 * f64::EPSILON);
    let ratio = mean.luminance.standard_error / other.standard_error;
    assert!((ratio - 1.0).abs() < 360.0 * f64::EPSILON);

    // A part of a part is a part of the whole.
    let window = |[x0, x1]: [u32; 2], [y0, y1]: [u32; 2]| Window { x0, y0, x1, y1 };
    let part = window([5, 12], [4, 9]);
    let cropped = render.cropped(window([3, 19], [2, 17])).unwrap().run();
    assert_eq!(cropped.mean(part), whole.mean(part));
    for outside in [
        Window { x0: 2, ..part },
        Window { y1: 18, ..part },
        Window { x1: 5, ..part },
    ] {
        assert_eq!(cropped.mean(outside).unwrap_err().window, outside);
    }
}

/// Stops after the first pass.
struct Impatient;

impl Progress for Impatient {
    fn passed(&mut self, _: u32, _: u32, _: std::time::Duration, _: Option<f64>) -> bool {
        false
    }
}

#[test]
fn pilots_that_are_stopped_leave_everything_as_it_was() {
    let (target, error) = (Target::Image, 1e-4);
    let goal = Goal { target, error };
    for sampler in ["sobol", "stratified"] {
        let text = SCENE.replace("spp = 8", &format!("spp = 8, sampler = \"{sampler}\""));
        let mut render = Render::new(Scene::parse(&text).unwrap()).unwrap();
        let before = render.run().rgb();
        assert!(render.aim(goal, &mut Impatient).unwrap().is_none());
        assert!(render.goal().is_none());
        assert_eq!(render.run().rgb(), before, "{sampler}");
    }
}

/// A library's user has no terminal and no flags.
#[test]
fn words_of_the_library_know_no_command_line() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = rust_files(&root.join("src"));
    files.retain(|file| !file.starts_with(root.join("src/cli")));
    let flag = |rest: &str| rest.starts_with(|c: char| c.is_ascii_lowercase());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let mut code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
        let found = code.find(|l| l.contains("\"error:") || l.split("--").skip(1).any(flag));
        assert_eq!(found, None, "{}", file.display());
    }
}
