//! The general way of direct light in the loop, by the surface that only builds with the feature
//! `planted` have: `cargo test --release --features planted --test tests phong_pictures`.

use std::f64::consts::TAU;

use etalon::inside::material::Transport;
use etalon::inside::math::instructions::Precision;
use etalon::inside::stats::family::sidak;
use etalon::{Estimate, Render, Scene};
use etalon_doors::material::{C, Setting, Subject, evaluate_each};
use glam::DVec3;

fn mean(text: &str) -> Estimate {
    let scene = Scene::parse(text).unwrap();
    Render::new(scene).unwrap().run().mean_luminance()
}

/// A room of walls that are written in one way or the other, lit by a lamp and a point.
fn room(walls: &str) -> String {
    format!(
        "camera = {{ from = [0, 0, -0.9], to = [0, 0.2, 1], fov = 80 }}\n\
         image = {{ size = [16, 16], spp = 16, max_depth = 5, precision = \"f64\" }}\n\
         materials.walls = {walls}\n\
         materials.lamp = {{ emit = 1, sides = \"both\" }}\n\
         [[object]]\nshape = \"cube\"\nmaterial = \"walls\"\n\
         [[object]]\nshape = {{ sphere = {{ radius = 0.3 }} }}\nmaterial = \"walls\"\n\
         transform = [{{ translate = [0.3, -0.5, 0.4] }}]\n\
         [[object]]\nshape = {{ rectangle = {{ size = [0.5, 0.5] }} }}\nmaterial = \"lamp\"\n\
         transform = [{{ rotate_x = 80 }}, {{ translate = [0, 0.7, 0.2] }}]\n\
         [[light]]\npoint = {{ at = [-0.5, 0.5, 0], intensity = 0.1 }}\n"
    )
}

/// Without lobe and mirror the same random numbers make the same paths, up to rounding; before
/// roulette begins, nothing is decided by their weights.
#[test]
fn a_lambertian_room_is_lit_alike_by_both_ways() {
    let special = mean(&room("{ diffuse = 0.7 }"));
    let general = mean(&room("{ phong = [0.7, 0], lobe_share = 0 }"));
    let other = mean(&room("{ phong = [0.7, 0.001], lobe_share = 0 }"));
    assert!(special.value > 0.01, "{special:?}");
    let off = |other: Estimate| (other.value / special.value - 1.0).abs();
    assert!(off(general) < 1e-12, "{general:?} {special:?}");
    assert!(off(other) > 1e-6, "{other:?} {special:?}");
}

/// A plane seen at an angle, in light of radiance 1 from everywhere, whose albedo at that angle the
/// picture shows: light from infinity, which scattered rays alone find, and from a sphere around
/// everything, which is sampled too.
fn furnace(angle: f64, numbers: [f64; 3], sampled: bool) -> String {
    let (x, z) = (5.0 * angle.sin(), 5.0 * angle.cos());
    let [halvings, mirror, lobe] = numbers;
    let light = if sampled {
        "[[object]]\nshape = { sphere = { radius = 40 } }\nmaterial = \"sky\"\n"
    } else {
        ""
    };
    let environment = if sampled { "" } else { "environment = 1\n" };
    format!(
        "{environment}camera = {{ from = [{x:?}, 0.01, {z:?}], to = [0, 0, 0], orthographic = 0.01 }}\n\
         image = {{ size = [16, 16], spp = 1024 }}\n\
         materials.sky = {{ emit = 1, sides = \"back\" }}\n\
         materials.phong = {{ phong = [0.3, 0.5], halvings = {halvings}, mirror_share = {mirror:?}, \
         lobe_share = {lobe:?} }}\n\
         [[object]]\nshape = {{ disk = {{ radius = 1 }} }}\nmaterial = \"phong\"\n{light}"
    )
}

/// The same by integration over the hemisphere.
fn albedo(angle: f64, numbers: [f64; 3]) -> f64 {
    let setting = Setting {
        precision: Precision::Double,
        transport: Transport::Radiance,
        normal: DVec3::Z,
        front: true,
        wo: DVec3::new(angle.sin(), 0.0, angle.cos()),
        spectra: [[0.3; C], [0.5; C]],
        numbers,
        outside: [1.0; C],
        disperses: false,
        ended: false,
        hero: 0,
    };
    let side = 512;
    let cells = f64::from(side) * f64::from(side);
    let directions = (0..side * side).map(|i| {
        let z = (f64::from(i / side) + 0.5) / f64::from(side);
        let (sine, cosine) = (TAU * f64::from(i % side) / f64::from(side)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cosine, r * sine, z)
    });
    let directions: Vec<DVec3> = directions.collect();
    let values = evaluate_each(Subject::Phong, &setting, &directions);
    let values = values.iter().zip(&directions);
    let sum: f64 = values.map(|(own, wi)| own.value[0] * wi.z).sum();
    numbers[1] + sum * TAU / cells
}

#[test]
fn pictures_show_the_albedo_at_each_angle() {
    let mut wrong = Vec::new();
    let mut all = Vec::new();
    for angle in [5.0, 45.0, 75.0_f64] {
        for numbers in [[3.0, 0.0, 0.6], [4.0, 0.1, 0.5], [1.0, 0.2, 0.9]] {
            for sampled in [false, true] {
                let angle = angle.to_radians();
                let truth = albedo(angle, numbers);
                assert!(truth < 1.0);
                let mean = mean(&furnace(angle, numbers, sampled));
                let words = format!("{angle} {numbers:?} {sampled}: {mean:?} {truth}");
                all.push((truth, mean, words));
            }
        }
    }
    let level = sidak(1e-4, all.len());
    for (truth, mean, words) in &all {
        // The integral is off by less than 2e-5: cells of 1/512, lobes 0.25 and wider.
        if mean.p_value(*truth, 2e-5) < level {
            wrong.push(words);
        }
        let noticed = mean.p_value(1.01 * truth, 2e-5) < level;
        assert!(noticed, "one per cent unnoticed: {words}");
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
