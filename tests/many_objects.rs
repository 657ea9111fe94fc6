//! Many objects: the hierarchy gives the hits of the list, whoever shares the packet.

use etalon::inside::integrate::intersect::NOTHING;
use etalon::inside::integrate::model::{Many, Model};
use etalon::inside::math::lanes::Scalar;
use etalon::inside::plan::bounds::{about_camera, bounds};
use etalon::inside::plan::build::{LARGEST_LIST, build};
use etalon::inside::plan::choose::choose;
use etalon::inside::scene;
use etalon::inside::shape::Ray;
use etalon::inside::shape::hierarchy::Item;
use etalon::inside::spectrum::grid::WavelengthGrid;
use etalon::{Instructions, Scene};
use etalon_doors::Made;
use etalon_doors::models::{self, Answer, AnyModel, Asking, Question};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::lanes_support::{PRECISIONS, Precision, on_each};
use crate::shape_ladder::cubed;
use crate::support::object;

const HEAD: &str = r#"
camera = { from = [0, 0, 6], to = [0, 0, 0], fov = 40 }
image = { size = [8, 8], spp = 1 }
materials.white = { diffuse = 0.75 }
materials.lamp = { emit = 1 }

[[object]]
shape = { plane = {} }
material = "white"
transform = [{ rotate_x = -90 }, { translate = [0, -2, 0] }]

[[object]]
shape = { rectangle = { size = [1, 1] } }
material = "lamp"
transform = [{ rotate_x = 90 }, { translate = [0, 2, 0] }]
"#;

fn ball([x, y, z]: [f64; 3], radius: f64) -> String {
    let shape = format!("{{ sphere = {{ radius = {radius} }} }}");
    object(
        &shape,
        "white",
        &format!("{{ translate = [{x}, {y}, {z}] }}"),
    )
}

/// A cloud of balls, among them large, touching and overlapping ones, and `others` of other shapes.
fn cloud(balls: usize, others: usize) -> Scene {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut text = String::from(HEAD);
    for i in 0..balls {
        // On a grid of touching balls, every third one beside it.
        let grid = [i % 7, i / 7 % 7, i / 49].map(|k| (k as f64 - 3.0) / 2.0);
        let [x, y, z] = if i % 3 == 0 {
            (2.0 * cubed(&mut rng)).to_array()
        } else {
            grid
        };
        let radius = if i % 50 == 49 { 0.75 } else { 0.25 };
        text += &ball([x, y, z], radius);
    }
    for i in 0..others {
        let shape = [
            "{ cube = { side = 0.3 } }",
            "{ cylinder = { radius = 0.2, height = 0.4 } }",
            "{ disk = { radius = 0.3 } }",
            "{ rectangle = { size = [0.4, 0.3] } }",
            "{ sphere = { radius = 0.2 } }",
        ][i % 5];
        let [x, y, z] = (2.0 * cubed(&mut rng)).to_array();
        let angle = [0.0, 90.0, 360.0 * rng.random::<f64>()][i % 3];
        let place = format!("{{ scale = [1, 1, 1.5] }}, {{ translate = [{x}, {y}, {z}] }}");
        text += &object(
            shape,
            "white",
            &format!("{{ rotate_x = {angle} }}, {place}"),
        );
    }
    Scene::parse(&text).unwrap()
}

fn items(scene: &Scene) -> Vec<Item> {
    let with_bounds = |(k, object): (usize, &scene::Named<scene::Object>)| {
        let bounds = bounds(&object.value.shape, &about_camera(scene, &object.value))?;
        Some((k as u32, bounds))
    };
    let objects = scene.objects.iter().enumerate();
    objects.filter_map(with_bounds).collect()
}

/// How the objects are looked through.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    List,
    Hierarchy,
    /// With the last eighth of the objects forgotten.
    Broken,
    /// By packets of twice the width.
    Wide,
}

/// The tables of a scene in a precision.
fn model<T: Scalar>(scene: &Scene) -> Model<T> {
    let choices = choose(scene, false).unwrap();
    build(scene, &choices, &WavelengthGrid::default())
        .unwrap()
        .0
}

/// The same for one way.
fn model_for<T: Scalar>(scene: &Scene, way: Way) -> Model<T> {
    let mut model = model(scene);
    let mut items = items(scene);
    if way == Way::Broken {
        items.truncate(items.len() - items.len() / 8);
    }
    let many = || Many::new(&items, vec![0], &model.shapes, &model.occluders.objects);
    model.hierarchy = (way != Way::List).then(many);
    model
}

/// Answers on every instruction set.
fn asked(
    scene: &Scene,
    way: Way,
    precision: Precision,
    rays: &[Ray],
) -> Vec<(&'static str, Vec<Answer>)> {
    let ask = |model: AnyModel| on_each(|set| answers(set, model, way, rays));
    match precision {
        Precision::Single => ask(Made::Single(&model_for(scene, way))),
        Precision::Double => ask(Made::Double(&model_for(scene, way))),
    }
}

/// Anything, and along the axes through the grid of balls.
fn rays(count: usize) -> Vec<Ray> {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let mut ray = |i: usize| {
        if i.is_multiple_of(8) {
            let axis = rng.random_range(0..3);
            let mut origin = (4.0 * cubed(&mut rng)).round() / 4.0;
            origin[axis] = 4.0;
            let direction = -DVec3::AXES[axis];
            return Ray { origin, direction };
        }
        let origin = 4.0 * cubed(&mut rng);
        let direction = (2.0 * cubed(&mut rng) - origin).normalize();
        Ray { origin, direction }
    };
    (0..count).map(&mut ray).collect()
}

/// The answers for all rays, and then for as many that leave the objects hit, inward or outward.
fn answers(set: Instructions, model: AnyModel, way: Way, rays: &[Ray]) -> Vec<Answer> {
    let asking = Asking {
        twice: way == Way::Wide,
        limit: 2.5,
        except: 1,
    };
    let free = |&ray: &Ray| Question {
        ray,
        leaving: NOTHING,
        inward: false,
    };
    let first: Vec<Question> = rays.iter().map(free).collect();
    let mut all = models::answers(set, model, &first, asking);
    let leaves = |(i, (ray, answer)): (usize, (&Ray, &Answer))| {
        let hit = answer.t.is_finite();
        Question {
            ray: if hit { turned(ray, answer.t) } else { *ray },
            leaving: answer.object,
            inward: i.is_multiple_of(2),
        }
    };
    let second: Vec<Question> = rays.iter().zip(&all).enumerate().map(leaves).collect();
    all.extend(models::answers(set, model, &second, asking));
    all
}

/// From where a ray arrives, in another direction.
fn turned(ray: &Ray, t: f64) -> Ray {
    let v = ray.direction;
    Ray {
        origin: ray.origin + t * v,
        direction: DVec3::new(v.y, v.z, v.x),
    }
}

/// Both tiers are the same arithmetic on the same rays by either way. Only what stands for a rival
/// could differ: an object whose box lies beyond a hit that its enclosure reaches before. No ray
/// here meets one, so that all bits agree.
#[test]
fn hierarchy_and_list_see_the_same() {
    for (balls, others) in [(300, 0), (40, 60), (0, 40)] {
        let scene = cloud(balls, others);
        assert!(balls + 5 * others > LARGEST_LIST);
        for precision in PRECISIONS {
            let rays = rays(2000);
            let ask = |way| asked(&scene, way, precision, &rays);
            let list = ask(Way::List).swap_remove(0).1;
            let hits = list.iter().filter(|answer| answer.part != NOTHING);
            assert!(hits.count() > rays.len() / 2);
            assert!(list.iter().filter(|answer| answer.blocked).count() > rays.len() / 8);
            for way in [Way::Hierarchy, Way::Wide] {
                for (name, answers) in ask(way) {
                    for (i, (a, b)) in list.iter().zip(&answers).enumerate() {
                        assert_eq!(a, b, "{way:?} {precision:?} {name} ray {i}");
                    }
                    assert_eq!(list.len(), answers.len());
                }
            }
            assert_ne!(ask(Way::Broken).swap_remove(0).1, list);
        }
    }
}

const BALLS: u32 = 16;

/// Rays from farther away than the bounds of the quick question hold, each with a ball: `aimed`
/// through its inner nine tenths, or past all balls by a diameter.
fn from_afar(scene: &Scene, aimed: bool) -> Vec<(u32, Ray)> {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let mut ray = |_| {
        let ball = rng.random_range(0..BALLS);
        let rows = about_camera(scene, &scene.objects[ball as usize].value).rows;
        let centre = DVec3::new(rows[0][3], rows[1][3], rows[2][3]);
        let radius = rows[0][0];
        let offset = if aimed {
            0.9 * radius * cubed(&mut rng) / 3f64.sqrt()
        } else {
            DVec3::new(0.0, 0.0, 2.0 + 2.0 * radius)
        };
        let mut from = cubed(&mut rng).normalize();
        if !aimed {
            from.z = 0.0;
            from = from.normalize();
        }
        // Rounded numbers aim within 2 u of this distance, 2e-3 in single precision.
        let far = 10f64.powf(rng.random_range(2.0..4.0));
        let ray = Ray {
            origin: centre + offset + far * from,
            direction: -from,
        };
        (ball, ray)
    };
    (0..2000).map(&mut ray).collect()
}

/// The sets of balls that rays are said to come near, on every instruction set.
fn near(scene: &Scene, precision: Precision, rays: &[(u32, Ray)]) -> Vec<(&'static str, Vec<u32>)> {
    let objects: Vec<u32> = (0..BALLS).collect();
    let rays: Vec<Ray> = rays.iter().map(|(_, ray)| *ray).collect();
    let ask = |model: AnyModel| on_each(|set| models::balls_near(set, model, &objects, &rays));
    match precision {
        Precision::Single => ask(Made::Single(&model(scene))),
        Precision::Double => ask(Made::Double(&model(scene))),
    }
}

#[test]
fn balls_are_found_from_afar() {
    let mut text = String::from(&HEAD[..HEAD.find("[[object]]").unwrap()]);
    let mut rng = Pcg64Mcg::seed_from_u64(9);
    for _ in 0..BALLS {
        text += &ball(cubed(&mut rng).to_array(), rng.random_range(0.05..0.3));
    }
    let scene = Scene::parse(&text).unwrap();
    let [aimed, past] = [true, false].map(|aimed| from_afar(&scene, aimed));
    for precision in PRECISIONS {
        for (name, sets) in near(&scene, precision, &aimed) {
            for ((ball, _), near) in aimed.iter().zip(sets) {
                let found = near >> ball & 1 == 1;
                assert!(found, "{precision:?} {name}: ball {ball} of {near:b}");
            }
        }
        // No more is asked than comes near: rays past all balls ask none.
        for (name, sets) in near(&scene, precision, &past) {
            let asked = sets.iter().filter(|near| **near != 0).count();
            assert_eq!(asked, 0, "{precision:?} {name}");
        }
    }
}
