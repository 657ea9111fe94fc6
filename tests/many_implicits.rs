//! Many implicit surfaces: their hits are those of each asked alone, and a ray asks a few of them.

use etalon::inside::shape::Ray;
use etalon::{First, Plan, Scene, Tracer};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::shape_ladder::cubed;
use crate::support::{object, rendered};

const HEAD: &str = r#"
camera = { from = [0, 0, 9], to = [0, 0, 0], fov = 30 }
image = { size = [32, 32], spp = 4, max_depth = 4, sampler = "independent" }
materials.white = { diffuse = 0.75 }
materials.lamp = { emit = 1 }

[[object]]
shape = { rectangle = { size = [4, 4] } }
material = "lamp"
transform = [{ rotate_x = 90 }, { translate = [0, 6, 0] }]
"#;

/// Small tori and balls, turned anyhow, in a cube of side 4; every `ball_every`-th is a ball.
fn cloud(objects: usize, ball_every: usize) -> Scene {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let mut text = String::from(HEAD);
    // A constant share of the lines through the cube meets something, however many there are.
    let size = 1.5 / (objects as f64).sqrt();
    for i in 0..objects {
        let [x, y, z] = (2.0 * cubed(&mut rng)).to_array();
        let [a, b]: [f64; 2] = rng.random();
        let is_ball = usize::from(i % ball_every == 0);
        let shape = ["{ implicit = \"torus\" }", "\"sphere\""][is_ball];
        let [a, b] = [360.0 * a, 360.0 * b];
        let turns = format!("{{ rotate_x = {a} }}, {{ rotate_y = {b} }}");
        let place = format!("{{ scale = {size} }}, {turns}, {{ translate = [{x}, {y}, {z}] }}");
        text += &object(shape, "white", &place);
    }
    Scene::parse(&text).unwrap()
}

/// Rays from outside towards places in the cloud, and from within it.
fn rays(count: usize) -> Vec<Ray> {
    let mut rng = Pcg64Mcg::seed_from_u64(12);
    let mut ray = |i: usize| {
        let to = 2.0 * cubed(&mut rng);
        let from = if i.is_multiple_of(2) { 9.0 } else { 2.0 } * cubed(&mut rng);
        Ray {
            origin: from,
            direction: to - from,
        }
    };
    (0..count).map(&mut ray).collect()
}

/// The first hit, as object and t.
fn hit(tracer: &Tracer, ray: Ray) -> Option<(usize, f64)> {
    match tracer.first(ray) {
        First::Hit(hit) => Some((hit.object, hit.t)),
        First::Nothing => None,
        First::Undecided(finder) => panic!("{finder} is undecided on {ray:?}"),
    }
}

#[test]
fn the_first_hit_among_many_is_the_first_of_the_single_ones() {
    let scene = cloud(120, 4);
    let many = Tracer::new(&scene).unwrap();
    let alone = |k: usize| {
        let mut alone = scene.clone();
        alone.objects = vec![scene.objects[k].clone()];
        Tracer::new(&alone).unwrap()
    };
    let single: Vec<Tracer> = (0..scene.objects.len()).map(alone).collect();
    let mut hits = 0;
    for ray in rays(400) {
        let each = single.iter().enumerate();
        let each = each.filter_map(|(k, tracer)| Some((k, hit(tracer, ray)?.1)));
        let first = each.min_by(|a, b| a.1.total_cmp(&b.1));
        assert_eq!(hit(&many, ray), first, "{ray:?}");
        hits += usize::from(first.is_some());
    }
    assert!(hits > 100, "{hits} hits show nothing");
}

/// A ray that misses every box meets nothing, whatever its direction's components are.
#[test]
fn rays_along_the_axes_ask_the_index_too() {
    let scene = cloud(120, 4);
    let tracer = Tracer::new(&scene).unwrap();
    let along = |[x, y, z]: [f64; 3], direction| {
        let origin = DVec3::new(x, y, z);
        hit(&tracer, Ray { origin, direction })
    };
    assert_eq!(along([-50.0, 40.0, 0.0], DVec3::X), None);
    assert_eq!(along([0.5, 50.0, 0.5], -DVec3::Y), Some((0, 44.0)));
}

/// Questions about implicit surfaces for each ray of a small render, all bounces and shadows.
fn questions_a_ray(objects: usize) -> f64 {
    let scene = cloud(objects, usize::MAX);
    let plan = Plan::new(&scene, false).unwrap();
    let tiers = rendered(&scene, &plan).tiers;
    tiers.implicit.rays() as f64 / tiers.rays as f64
}

/// A list asks 64 of 64 and 1 000 of 1 000. In a cloud of constant total cross-section a line runs
/// through boxes whose number grows with the cube root of theirs, 2.5 between these two; twice that is
/// far from the 16 of a list.
#[test]
fn a_ray_asks_few_of_a_thousand_tori() {
    let (few, many) = (questions_a_ray(64), questions_a_ray(1000));
    println!("questions a ray: {few:.2} of 64 tori, {many:.2} of 1 000");
    assert!(many < 5.0 * few && many < 20.0, "{few} and {many}");
}
