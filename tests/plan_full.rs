//! What the plan leaves out of the loop cannot show.

use etalon::inside::integrate::model::Model;
use etalon::inside::integrate::needs::Needs;
use etalon::inside::integrate::parts::Parts;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::plan::{Tables, explain::explain};
use etalon::{Plan, Scene};

use crate::support::{pixel_bits, rendered};

const SHAPES: [&str; 9] = [
    "\"sphere\"",
    "{ sphere = { center = [0.1, 0, 0] } }\ntransform = [{ scale = [1, 0.5, 1] }]",
    "\"cube\"\ntransform = [{ rotate_y = 30 }]",
    "\"cylinder\"\ntransform = [{ rotate_x = 60 }]",
    "\"disk\"\ntransform = [{ rotate_y = 20 }]",
    "\"rectangle\"\ntransform = [{ rotate_y = 200 }]",
    "\"plane\"\ntransform = [{ rotate_x = -60 }]",
    "{ implicit = \"torus\" }",
    "{ implicit = \"x^2 + y^2 + 0.3*sin(9*z) - 1/2\", inside = [[-1, -1, -1], [1, 1, 1]], closed = true }",
];

const MATERIALS: [&str; 10] = [
    "{ diffuse = 0.6 }",
    "{ mirror = \"Au\" }",
    "{ mirror = { ideal = 0.9 } }",
    "{ glass = { ior = 1.5 } }",
    "{ glass = \"N-SF11\" }",
    "{ checkerboard = [0.2, 0.7], cell = 0.25 }",
    "{ black = true }",
    "{ emit = 2 }",
    "{ emit = 2, sides = \"back\", diffuse = 0.3 }",
    "{ emit = 2, sides = \"both\", mirror = \"Ag\" }",
];

/// A scene of objects (shape, place in the list of materials), and what else is to be in it.
fn scene(precision: &str, objects: &[(String, usize)], more: &str) -> Scene {
    let mut text = format!(
        "environment = 0.3\n\
         image = {{ size = [8, 6], spp = 4, seed = 5, precision = \"{precision}\" }}\n{more}"
    );
    for (k, material) in MATERIALS.iter().enumerate() {
        text += &format!("materials.m{k} = {material}\n");
    }
    for (shape, material) in objects {
        text += &format!("[[object]]\nmaterial = \"m{material}\"\nshape = {shape}\n");
    }
    text += "[[light]]\npoint = [2, 3, 4]\nintensity = 5\n";
    Scene::parse(&text).unwrap()
}

const PINHOLE: &str = "camera = { from = [0.2, 0.3, 4], to = [0, 0, 0], fov = 40 }\n";
const LENS: &str = "camera = { from = [0.2, 0.3, 4], to = [0, 0, 0], fov = 40, \
                    lens = { radius = 0.1, focus = 3 } }\n";

fn bits(scene: &Scene, plan: &Plan) -> Vec<[[u64; 3]; 2]> {
    pixel_bits(&rendered(scene, plan))
}

fn left_out(plan: &Plan) -> usize {
    plan.needs().branches().filter(|(_, kept)| !kept).count()
}

/// That the reduced plan leaves something out, the full one nothing, and that they give the same bits.
fn assert_same(scene: &Scene, name: &str) {
    let [reduced, full] = [false, true].map(|full| Plan::new(scene, full).unwrap());
    assert!(left_out(&reduced) > 0, "{name}");
    assert_eq!(left_out(&full), 0, "{name}");
    assert_eq!(bits(scene, &reduced), bits(scene, &full), "{name}");
}

#[test]
fn a_full_plan_gives_the_bits_of_the_reduced_one() {
    for precision in ["f32", "f64"] {
        for shape in SHAPES {
            for material in 0..MATERIALS.len() {
                let scene = scene(precision, &[(shape.to_owned(), material)], PINHOLE);
                assert_same(&scene, &format!("{precision} {shape} {material}"));
            }
        }
    }
}

/// Few objects are asked one after the other and looked up in registers; many are in a hierarchy, and
/// their parts are gathered one by one.
#[test]
fn it_does_so_among_many_objects_and_behind_a_lens() {
    let cloud = |count: usize, material: usize| -> Vec<(String, usize)> {
        let ball = |k: usize| {
            let [x, y, z] = [k % 5, k / 5 % 5, k / 25].map(|i| i as f64 * 0.5 - 1.0);
            let shape = format!("{{ sphere = {{ radius = 0.2, center = [{x}, {y}, {z}] }} }}");
            (shape, (material + k % 2) % MATERIALS.len())
        };
        (0..count).map(ball).collect()
    };
    for precision in ["f32", "f64"] {
        for camera in [PINHOLE, LENS] {
            for material in 0..MATERIALS.len() {
                for count in [3, 20, 120] {
                    let scene = scene(precision, &cloud(count, material), camera);
                    assert_same(&scene, &format!("{precision} {camera} {material} {count}"));
                }
            }
        }
    }
}

/// The comparison would see a branch that is missing.
#[test]
fn a_branch_that_is_needed_and_left_out_shows() {
    fn strip<T: Scalar>(model: &mut Model<T>) {
        model.needs = Needs::new::<T>(&Parts::default(), &[], model.needs.lens);
    }
    for shape in SHAPES {
        let scene = scene("f32", &[(shape.to_owned(), 0)], PINHOLE);
        let mut plan = Plan::new(&scene, false).unwrap();
        let whole = bits(&scene, &plan);
        match &mut plan.tables {
            Tables::Single(tables) => strip(&mut tables.0),
            Tables::Double(tables) => strip(&mut tables.0),
        }
        assert_ne!(whole, bits(&scene, &plan), "{shape}");
    }
}

#[test]
fn info_says_what_the_loop_reads() {
    let scene = scene("auto", &[("\"cube\"".to_owned(), 8)], PINHOLE);
    let lines = |full| {
        let plan = Plan::new(&scene, full).unwrap();
        explain(&scene, &plan).join("\n")
    };
    let (reduced, full) = (lines(false), lines(true));
    let line =
        "in the loop: diffuse reflection, emission from backs, cubes, insides of closed shapes\n";
    assert!(reduced.contains(line), "{reduced}");
    assert!(reduced.contains("left out of the loop, as nothing here needs it: metals"));
    for (branch, _) in Needs::everything().branches() {
        let mut kept = full.lines().filter(|line| line.starts_with("in the loop"));
        let named = kept.any(|line| line.contains(branch));
        assert!(named, "{branch}: {full}");
    }
    assert!(full.contains("left out of the loop: nothing, as asked for"));
    assert!(!full.contains("shadow rays ask"), "{full}");
}
