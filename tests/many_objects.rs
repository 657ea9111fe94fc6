//! Many objects: the hierarchy gives the hits of the list, whoever shares the packet.

#![allow(
    clippy::unwrap_used,
    reason = "the tests' own scenes are right, and what they hold is known"
)]

use std::path::Path;

use etalon::inside::integrate::intersect::{Leaving, NOTHING, Rungs, Shadow, nearest, occluded};
use etalon::inside::integrate::model::{Many, Model};
use etalon::inside::math::lanes::{Lanes, Mask, Scalar, WIDEST};
use etalon::inside::math::twice::Twice;
use etalon::inside::math::vec3::Vec3;
use etalon::inside::plan::bounds::{about_camera, bounds};
use etalon::inside::plan::build::{LARGEST_LIST, build};
use etalon::inside::plan::choose::choose;
use etalon::inside::scene;
use etalon::inside::shape::hierarchy::Item;
use etalon::inside::shape::lanes::LaneRay;
use etalon::inside::shape::lanes::balls::Balls;
use etalon::inside::spectrum::grid::WavelengthGrid;
use etalon::{Overrides, Scene};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::lanes_support::{Job, PRECISIONS, on_each};
use crate::shape_ladder::cubed;

const HEAD: &str = r#"
[camera]
from = [0, 0, 6]
to = [0, 0, 0]
fov = 40

[image]
size = [8, 8]
spp = 1

[materials]
white = { diffuse = 0.75 }
lamp = { emit = 1 }

[[object]]
shape = { plane = {} }
material = "white"
transform = [{ rotate_x = -90 }, { translate = [0, -2, 0] }]

[[object]]
shape = { rectangle = { size = [1, 1] } }
material = "lamp"
transform = [{ rotate_x = 90 }, { translate = [0, 2, 0] }]
"#;

/// A cloud of balls, among them large, touching and overlapping ones, and `others` of other shapes.
fn cloud(balls: usize, others: usize) -> Scene {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut text = String::from(HEAD);
    let mut object = |shape: String, placed: String| {
        text += &format!(
            "\n[[object]]\nshape = {{ {shape} }}\nmaterial = \"white\"\ntransform = [{placed}]\n"
        );
    };
    for i in 0..balls {
        // On a grid of touching balls, every third one beside it.
        let grid = [i % 7, i / 7 % 7, i / 49].map(|k| (k as f64 - 3.0) / 2.0);
        let [x, y, z] = if i % 3 == 0 {
            (2.0 * cubed(&mut rng)).to_array()
        } else {
            grid
        };
        let radius = if i % 50 == 49 { 0.75 } else { 0.25 };
        object(
            format!("sphere = {{ radius = {radius} }}"),
            format!("{{ translate = [{x}, {y}, {z}] }}"),
        );
    }
    for i in 0..others {
        let shape = [
            "cube = { side = 0.3 }",
            "cylinder = { radius = 0.2, height = 0.4 }",
            "disk = { radius = 0.3 }",
            "rectangle = { size = [0.4, 0.3] }",
            "sphere = { radius = 0.2 }",
        ][i % 5];
        let [x, y, z] = (2.0 * cubed(&mut rng)).to_array();
        let angle = [0.0, 90.0, 360.0 * rng.random::<f64>()][i % 3];
        object(
            shape.into(),
            format!(
                "{{ rotate_x = {angle} }}, {{ scale = [1, 1, 1.5] }}, {{ translate = [{x}, {y}, {z}] }}"
            ),
        );
    }
    scene::parse("cloud", &text, Path::new("."), &Overrides::default()).unwrap()
}

fn items(scene: &Scene) -> Vec<Item> {
    let with_bounds = |(k, object): (usize, &scene::Named<scene::Object>)| {
        let bounds = bounds(&object.value.shape, &about_camera(scene, &object.value))?;
        Some((k as u32, bounds))
    };
    scene
        .objects
        .iter()
        .enumerate()
        .filter_map(with_bounds)
        .collect()
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

/// One ray's answers: t, part, and whether a shadow ray of that direction is blocked.
type Answer = (f64, u32, bool);

struct Questions<'a> {
    scene: &'a Scene,
    way: Way,
    rays: usize,
}

impl Job for Questions<'_> {
    type Output = Vec<Answer>;
    fn run<L: Lanes>(&self, l: L) -> Vec<Answer> {
        let choices = choose(self.scene, false).unwrap();
        let (mut model, _) =
            build::<L::Scalar>(self.scene, &choices, &WavelengthGrid::default()).unwrap();
        let mut items = items(self.scene);
        if self.way == Way::Broken {
            items.truncate(items.len() - items.len() / 8);
        }
        let many = || Many::new(&items, vec![0], &model.shapes, &model.occluders.objects);
        model.hierarchy = (self.way != Way::List).then(many);
        let rays = rays(self.rays);
        if self.way == Way::Wide {
            answers(Twice(l), &model, &rays)
        } else {
            answers(l, &model, &rays)
        }
    }
}

/// Origins, directions: anything, and along the axes through the grid of balls.
fn rays(count: usize) -> Vec<[DVec3; 2]> {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let any = |rng: &mut Pcg64Mcg| {
        let from = 4.0 * cubed(rng);
        [from, (2.0 * cubed(rng) - from).normalize()]
    };
    (0..count)
        .map(|i| match i % 8 {
            0 => {
                let axis = rng.random_range(0..3);
                let mut from = (4.0 * cubed(&mut rng)).round() / 4.0;
                from[axis] = 4.0;
                [from, -DVec3::AXES[axis]]
            }
            _ => any(&mut rng),
        })
        .collect()
}

/// The answers for all rays, and then for as many that leave the objects hit, inward or outward.
fn answers<L: Lanes>(l: L, model: &Model<L::Scalar>, rays: &[[DVec3; 2]]) -> Vec<Answer> {
    let mut answers = [Vec::new(), Vec::new()];
    for (number, packet) in rays.chunks(L::COUNT).enumerate() {
        let mut leaving = [NOTHING; WIDEST];
        let mut rays = packet.to_vec();
        // Every other ray goes inward, however many there are to a packet.
        let every_other = 0x5555_5555_u32 << (number * L::COUNT % 2);
        for (answers, inward) in answers.iter_mut().zip([0, every_other]) {
            let found = ask(l, model, &rays, &leaving, inward);
            for (i, (t, part, _)) in found.iter().enumerate() {
                leaving[i] = model
                    .parts
                    .entries
                    .get(*part as usize)
                    .map_or(NOTHING, |part| part.object);
                if t.is_finite() {
                    let [from, direction] = rays[i];
                    rays[i] = [from + *t * direction, turned(direction)];
                }
            }
            answers.extend(found);
        }
    }
    answers.concat()
}

fn turned(v: DVec3) -> DVec3 {
    DVec3::new(v.y, v.z, v.x)
}

fn ask<L: Lanes>(
    l: L,
    model: &Model<L::Scalar>,
    rays: &[[DVec3; 2]],
    leaving: &[u32; WIDEST],
    inward: u32,
) -> Vec<Answer> {
    let column = |which: usize, axis: usize| {
        let mut column = [L::Scalar::from_f64(1.0); WIDEST];
        for (place, ray) in column.iter_mut().zip(rays) {
            *place = L::Scalar::from_f64(ray[which][axis]);
        }
        l.load(&column)
    };
    let vector = |which| Vec3::new(column(which, 0), column(which, 1), column(which, 2));
    let ray = LaneRay::new(l, vector(0), vector(1));
    let leaving = Leaving {
        object: l.load_int(leaving),
        inward: l.mask_from_bits(inward & (u32::MAX >> (WIDEST - L::COUNT))),
    };
    let active = l.mask_from_bits(u32::MAX >> (WIDEST - rays.len()));
    let mut rungs = Rungs::default();
    let found = nearest(l, model, &ray, &leaving, active, &mut rungs);
    let shadow = Shadow {
        ray,
        limit: l.real(2.5),
        except: l.int(1),
    };
    let blocked = occluded(l, model, &shadow, &leaving, active, &mut rungs).bits();
    (0..rays.len())
        .map(|i| {
            (
                l.lane(found.t, i).to_f64(),
                l.int_lane(found.part, i),
                blocked >> i & 1 == 1,
            )
        })
        .collect()
}

/// Both rungs are the same arithmetic on the same rays by either way. Only what stands for a rival
/// could differ: an object whose box lies beyond a hit that its enclosure reaches before. No ray
/// here meets one, so that all bits agree.
#[test]
fn hierarchy_and_list_see_the_same() {
    for (balls, others) in [(300, 0), (40, 60), (0, 40)] {
        let scene = cloud(balls, others);
        assert!(balls + 5 * others > LARGEST_LIST);
        for precision in PRECISIONS {
            let rays = 2000;
            let ask = |way| {
                let questions = Questions {
                    scene: &scene,
                    way,
                    rays,
                };
                on_each(precision, &questions)
            };
            let list = ask(Way::List).swap_remove(0).1;
            assert!(list.iter().filter(|answer| answer.1 != NOTHING).count() > rays / 2);
            assert!(list.iter().filter(|answer| answer.2).count() > rays / 8);
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

/// Rays from farther away than the bounds of the quick question hold: `aimed` through the inner
/// nine tenths of a ball each, or past all of them by a diameter.
struct FromAfar<'a> {
    scene: &'a Scene,
    aimed: bool,
}

const BALLS: u32 = 16;

impl Job for FromAfar<'_> {
    type Output = Vec<(u32, u32)>;
    /// The ball aimed at, and the set of balls that the ray is said to come near.
    fn run<L: Lanes>(&self, l: L) -> Self::Output {
        let choices = choose(self.scene, false).unwrap();
        let grid = WavelengthGrid::default();
        let (model, _) = build::<L::Scalar>(self.scene, &choices, &grid).unwrap();
        let objects: Vec<u32> = (0..BALLS).collect();
        let balls = Balls::new(&objects, &model.shapes).unwrap();
        let mut rng = Pcg64Mcg::seed_from_u64(11);
        let mut answers = Vec::new();
        for _ in 0..2000 {
            let ball = rng.random_range(0..BALLS);
            let (centre, radius) = self.ball(ball);
            let offset = if self.aimed {
                0.9 * radius * cubed(&mut rng) / 3f64.sqrt()
            } else {
                DVec3::new(0.0, 0.0, 2.0 + 2.0 * radius)
            };
            let mut from = cubed(&mut rng).normalize();
            if !self.aimed {
                from.z = 0.0;
                from = from.normalize();
            }
            // Rounded numbers aim within 2 u of this distance, 2e-3 in single precision.
            let far = 10f64.powf(rng.random_range(2.0..4.0));
            let ray = [centre + offset + far * from, -from];
            let vector = |which: usize| {
                let v: DVec3 = ray[which];
                let [x, y, z] = v.to_array().map(|x| l.real(x));
                Vec3::new(x, y, z)
            };
            let ray = LaneRay::new(l, vector(0), vector(1));
            let near = balls.near(l, &ray, [l.int(u32::MAX)], l.real(f64::INFINITY));
            answers.push((ball, l.int_lane(near, 0)));
        }
        answers
    }
}

impl FromAfar<'_> {
    fn ball(&self, object: u32) -> (DVec3, f64) {
        let map = about_camera(self.scene, &self.scene.objects[object as usize].value);
        let rows = map.rows;
        let centre = DVec3::new(rows[0][3], rows[1][3], rows[2][3]);
        (centre, rows[0][0])
    }
}

#[test]
fn balls_are_found_from_afar() {
    let mut text = String::from(&HEAD[..HEAD.find("[[object]]").unwrap()]);
    let mut rng = Pcg64Mcg::seed_from_u64(9);
    for _ in 0..BALLS {
        let [x, y, z] = cubed(&mut rng).to_array();
        let radius = rng.random_range(0.05..0.3);
        text += &format!(
            "[[object]]\nshape = {{ sphere = {{ radius = {radius} }} }}\nmaterial = \"white\"\n\
             transform = [{{ translate = [{x}, {y}, {z}] }}]\n"
        );
    }
    let scene = scene::parse("balls", &text, Path::new("."), &Overrides::default()).unwrap();
    for precision in PRECISIONS {
        for (name, answers) in on_each(
            precision,
            &FromAfar {
                scene: &scene,
                aimed: true,
            },
        ) {
            for (ball, near) in answers {
                assert!(
                    near >> ball & 1 == 1,
                    "{precision:?} {name}: ball {ball} of {near:b}"
                );
            }
        }
        // No more is asked than comes near: rays past all balls ask none.
        for (name, answers) in on_each(
            precision,
            &FromAfar {
                scene: &scene,
                aimed: false,
            },
        ) {
            let asked = answers.iter().filter(|(_, near)| *near != 0).count();
            assert_eq!(asked, 0, "{precision:?} {name}");
        }
    }
}
