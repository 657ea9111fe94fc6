//! Geometry that leaks no light, at any scale and place.

use glam::DVec3;

use super::furnaces::{between, two_bodies};
use super::glass::{bow_scene, descartes, fresnel_dielectric};
use super::harness::{Case, holm, judge, mean, measure_all, render};
use super::scenes::Text;
use crate::truth_file::{number, truth};
use etalon::Estimate;

/// Camera paths of a pixel.
const FEW: u32 = 256;

/// Every pixel is zero, exactly.
fn assert_black(name: &str, text: &Text, spp: u32) {
    let rendered = render(text, spp, 5, None);
    let lit = rendered.xyz().iter().filter(|e| e.mean[1] != 0.0).count();
    assert_eq!(lit, 0, "{name}: {lit} pixels see light");
}

/// The first so many of the six squares that make a box and share their edges.
fn squares(text: &Text, count: usize) -> Text {
    let [x, y, z] = DVec3::AXES;
    let faces = [x, y, z, -x, -y, -z].into_iter().take(count);
    faces.fold(text.clone(), |text, face| {
        let a = super::scenes::across(face);
        text.rectangle("wall", a, face.cross(a), face)
    })
}

/// A box of one cube, and a box of six squares.
fn boxes(text: &Text) -> [(&'static str, Text); 2] {
    let cube = text.clone().object("cube = {}", "wall");
    [("cube", cube), ("squares", squares(text, 6))]
}

#[test]
fn a_closed_box_lets_no_light_out() {
    let from = DVec3::new(3.0, 2.0, -4.0);
    let text = Text::perspective(from, -from, 40.0)
        .size([32, 32])
        .material("wall", "diffuse = 0.9")
        .material("lamp", "emit = 100")
        .sphere("lamp", 0.4, DVec3::new(0.3, 0.1, -0.2))
        .point_light(DVec3::new(-0.5, 0.5, 0.5), 100.0);
    for (name, text) in boxes(&text) {
        assert_black(name, &text, FEW);
    }
    // Without a lid it does.
    let rendered = render(&squares(&text, 5), FEW, 5, None);
    assert!(rendered.xyz().iter().any(|e| e.mean[1] != 0.0));
}

#[test]
fn a_closed_box_lets_no_light_in() {
    let from = DVec3::new(0.3, -0.2, 0.4);
    for material in ["black = true", "diffuse = 0.9", "mirror = { ideal = 0.9 }"] {
        let text = Text::perspective(from, DVec3::new(1.0, 1.0, 0.9), 120.0)
            .size([32, 32])
            .material("wall", material)
            .environment(100.0);
        for (name, text) in boxes(&text) {
            assert_black(&format!("{name} {material}"), &text, FEW);
        }
    }
}

/// Camera paths of a pixel that bounce about a closed room ten times each: of 20 million bounces a few
/// go along a wall so closely that rounding would put their start outside.
const MANY: u32 = 512;

#[test]
fn many_bounces_along_its_walls_find_no_way_out_of_a_room() {
    let maps = [
        [10.0 * DVec3::X, 10.0 * DVec3::Y, 9.0 * DVec3::Z],
        [7.0 * DVec3::X, 10.0 * DVec3::Y, 12.0 * DVec3::Z],
        [
            DVec3::new(9.0, 1.0, 0.0),
            DVec3::new(-3.0, 8.0, 2.0),
            DVec3::new(0.5, 1.0, 11.0),
        ],
    ];
    let light = Text::perspective(DVec3::new(0.3, -0.2, 5.0), DVec3::NEG_Z, 50.0)
        .size([64, 64])
        .material("wall", "diffuse = 0.9")
        .image("precision = \"f32\"")
        .environment(100.0)
        .directional(DVec3::new(0.5, 0.3, 0.8), 100.0);
    for shape in ["sphere = {}", "cube = {}", "cylinder = {}"] {
        for map in maps {
            let text = light.clone().placed(shape, "wall", map, DVec3::ZERO);
            assert_black(&format!("{shape} {map:?}"), &text, MANY);
        }
    }
}

#[test]
fn nothing_arrives_short_of_the_rainbow() {
    let t = truth("rainbow");
    for row in t.rows("rows") {
        let ior = number(&row["n"]);
        let (i, deviation) = descartes(ior);
        // The point of exit is not the centre: an angle of 1/10⁴ at the lamp.
        let lamp = [deviation - 0.05, deviation - 2e-4];
        let scene = bow_scene(&format!("{{ ior = {ior:?} }}"), i.sin(), lamp);
        assert_black("rainbow", &scene, FEW);
    }
}

/// Concentric surfaces apart by 4e-5 of their radius stay two.
fn shells() -> Vec<Case> {
    let (near, far) = (1.0, 1.00004);
    let (rho, le) = ([0.3, 0.6], [1.0, 0.25]);
    let [inner, outer] = two_bodies(near / far, rho, le);
    let shell = |(inward, exact)| {
        let text = between([near, far], rho, le, inward);
        Case::new(format!("shells inward {inward}"), text, exact)
    };
    let mut cases = Vec::from([(true, inner), (false, outer)].map(shell));
    let look = Text::orthographic(DVec3::new(0.0, 0.0, 3.0), -DVec3::Z, 0.1);
    let outside = look
        .clone()
        .material("lamp", "emit = 100, sides = \"both\"")
        .material("skin", "diffuse = 0.5")
        .sphere("lamp", near, DVec3::ZERO)
        .sphere("skin", far, DVec3::ZERO)
        .environment(1.0);
    cases.push(Case::new("diffuse skin over a lamp", outside, 0.5));
    // A black core under a skin of glass: only what the skin reflects comes back.
    let ior = 1.5;
    let coated = look
        .material("core", "black = true")
        .material("skin", &format!("glass = {{ ior = {ior:?} }}"))
        .sphere("core", near, DVec3::ZERO)
        .sphere("skin", far, DVec3::ZERO)
        .environment(1.0);
    let exact = fresnel_dielectric(1.0, ior);
    cases.push(Case::new("glass skin over a black core", coated, exact).systematic(1e-5));
    cases
}

#[test]
fn shells_close_together_stay_two() {
    let measured = measure_all(shells());
    let judge = |bias| judge(measured.iter().map(|(case, m)| (case, m)), bias);
    let rejected = judge(1.0);
    assert!(rejected.is_empty(), "{rejected:#?}");
    let rejected = judge(1.005);
    assert_eq!(rejected.len(), measured.len(), "{rejected:#?}");
}

/// A still life, scaled and then moved.
fn still_life(scale: f64, shift: DVec3, albedo: f64) -> Text {
    let at = |p: DVec3| p * scale + shift;
    let (x, y, z) = (scale * DVec3::X, scale * DVec3::Y, scale * DVec3::Z);
    let towards = DVec3::new(0.0, -0.4, -1.0) * scale;
    let beside = at(DVec3::new(-1.0, 0.5, 0.3));
    Text::perspective(at(DVec3::new(0.0, 3.0, 6.0)), towards, 40.0)
        .size([16, 16])
        .material("floor", &format!("diffuse = {albedo:?}"))
        .material("clear", "glass = \"N-BK7\"")
        .material("lamp", "emit = 4")
        .material("silver", "mirror = \"Ag\"")
        .rectangle("floor", 4.0 * x, -4.0 * z, at(DVec3::ZERO))
        .rectangle("lamp", x, 0.5 * z, at(DVec3::new(0.0, 5.0, 0.0)))
        .sphere("clear", 0.7 * scale, at(DVec3::new(1.0, 0.7, 0.0)))
        .placed("cube = { side = 1 }", "silver", [x, y, z], beside)
        .environment(0.5)
}

/// Samples a pixel where blocks are compared.
const SAMPLES: u32 = 2048;
/// Edge of the blocks of pixels that are compared.
const BLOCK: usize = 4;

/// Means of blocks of pixels.
fn blocks(text: &Text, seed: u64) -> Vec<Estimate> {
    let estimates = render(text, SAMPLES, seed, None).xyz();
    let width = text.size[0] as usize;
    let across = width / BLOCK;
    (0..across * across)
        .map(|block| {
            let (x, y) = (block % across * BLOCK, block / across * BLOCK);
            let pixels: Vec<[f64; 2]> = (0..BLOCK * BLOCK)
                .map(|i| (y + i / BLOCK) * width + x + i % BLOCK)
                .map(|i| [estimates[i].mean[1], estimates[i].standard_error[1]])
                .collect();
            mean(&pixels, SAMPLES)
        })
        .collect()
}

/// Blocks that differ, by Welch's test and Holm's procedure.
fn different(pictures: &[(String, Vec<Estimate>)], first: &[Estimate]) -> Vec<String> {
    let mut all = Vec::new();
    for (name, picture) in pictures {
        for (block, (a, b)) in picture.iter().zip(first).enumerate() {
            let p = a.minus(b).p_value(0.0, 0.0);
            let words = format!("{name}, block {block}: {} and {}", a.value, b.value);
            all.push((p, words));
        }
    }
    holm(&all)
}

#[test]
fn scale_and_place_do_not_show() {
    let first = blocks(&still_life(1.0, DVec3::ZERO, 0.6), 11);
    let direction = DVec3::new(0.6, -0.5, 0.7);
    let mut pictures = Vec::new();
    for scale in [1e-6, 1e-3, 1e3, 1e6] {
        for diameters in [0.0, 1e6] {
            // Twelve units from corner to corner of the floor.
            let shift = direction * (diameters * 12.0 * scale);
            let seed = 20 + pictures.len() as u64;
            let picture = blocks(&still_life(scale, shift, 0.6), seed);
            pictures.push((format!("scale {scale:e}, moved by {diameters:e}"), picture));
        }
    }
    let rejected = different(&pictures, &first);
    assert!(rejected.is_empty(), "{rejected:#?}");
    // Half a per cent of the floor's albedo would have been seen.
    let darker = blocks(&still_life(1.0, DVec3::ZERO, 0.6 * 0.995), 12);
    let rejected = different(&[("darker".to_owned(), darker)], &first);
    assert!(!rejected.is_empty());
}

/// Rays in the planes of faces, along edges, along axes and through corners; `render` looks for
/// what is not a number.
#[test]
fn rays_in_faces_and_along_edges_are_numbers() {
    let materials = ["diffuse = 0.8", "glass = { ior = 1.5 }", "mirror = \"Ag\""];
    for material in materials {
        let add = |text: Text| {
            text.material("body", material)
                .material("lamp", "emit = 2, sides = \"both\"")
                .object("cube = {}", "body")
                .placed("cylinder = {}", "body", DVec3::AXES, 4.0 * DVec3::Z)
                .sphere("body", 1.0, DVec3::new(0.0, 0.0, -4.0))
                .rectangle("lamp", DVec3::X, DVec3::Z, DVec3::new(0.0, 1.5, 0.0))
                .environment(1.0)
        };
        // Pixel centres of 5 × 5 on a square of 2.5: −1, −0.5, 0, 0.5, 1, all of them exact.
        for (from, up) in [
            (DVec3::new(0.0, 0.0, 8.0), DVec3::Y),
            (DVec3::new(0.0, 8.0, 0.0), DVec3::Z),
            (DVec3::new(8.0, 0.0, 1.0), DVec3::Y),
        ] {
            let text = Text::upright(from, -from.normalize(), up, 2.5)
                .size([5, 5])
                .image("sampler = \"center\"");
            render(&add(text), 64, 6, None);
            // From a corner and from the middle of a face, into all directions.
            for start in [DVec3::ONE, DVec3::X, DVec3::ZERO] {
                let text = Text::perspective(start, -from, 150.0)
                    .size([9, 9])
                    .image("sampler = \"center\"");
                render(&add(text), 64, 7, None);
            }
        }
    }
}
