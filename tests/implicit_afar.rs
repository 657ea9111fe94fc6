//! Paths that leave implicit surfaces: after a long way to them, and at any scale.

use etalon::inside::integrate::chunk;
use etalon::inside::plan::explain;
use etalon::inside::render::{Instructions, replay};
use etalon::{Plan, Scene};
use glam::DVec3;

use crate::support::{pixel_bits, rendered};

fn plan(text: &str) -> (Plan, Scene) {
    let scene = Scene::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    (Plan::new(&scene, false).unwrap(), scene)
}

/// Where the sphere is, about the camera: behind it.
const CENTRE: f64 = 3.0;

/// A unit sphere as an implicit surface behind the camera, seen in a mirror at some distance.
fn seen_from_afar(distance: f64, material: &str) -> Plan {
    let mirror = -distance;
    let text = format!(
        "environment = 1\n\
         camera = {{ from = [0, 0, 0], to = [0, 0, -1], up = [0, 1, 0], orthographic = 1.9 }}\n\
         image = {{ size = [16, 16], spp = 4, max_depth = 8 }}\n\
         materials = {{ mirror = {{ mirror = {{ ideal = 1 }} }}, skin = {{ {material} }} }}\n\
         [[object]]\nshape = \"plane\"\nmaterial = \"mirror\"\n\
         transform = [{{ translate = [0, 0, {mirror:?}] }}]\n\
         [[object]]\nmaterial = \"skin\"\n\
         shape = {{ implicit = \"x^2 + y^2 + z^2 - 1\", inside = [[-2, -2, -2], [2, 2, 2]] }}\n\
         transform = [{{ translate = [0, 0, {CENTRE:?}] }}]\n"
    );
    plan(&text).0
}

/// Segments that begin on the sphere, and those of them that end where they cannot.
fn departures(plan: &Plan) -> [usize; 2] {
    let [mut all, mut wrong] = [0; 2];
    let level = Instructions::best();
    for k in 0..16 * 16 * 4 {
        let (pixel, sample) = (k / 4, k % 4);
        let (x, y) = (pixel % 16, pixel / 16);
        let path = replay(plan, level, chunk::Request { x, y, sample });
        for pair in path.vertices.windows(2) {
            let [from, to] = [&pair[0], &pair[1]];
            if from.object != Some(1) {
                continue;
            }
            all += 1;
            // A chord of a unit sphere; a ray that leaves it outward does not meet it again.
            let start = from.point - DVec3::new(0.0, 0.0, CENTRE);
            let chord = -2.0 * start.dot(to.direction);
            let inward = from.normal.dot(to.direction) < 0.0;
            let near = (to.distance - chord).abs() < 1e-5;
            let right = (to.object == Some(1)) == inward && (near || !inward);
            wrong += usize::from(!right);
        }
    }
    [all, wrong]
}

/// A hit at distance t is off by roundings of t, more than its own coordinates would tell: 1e-9 at 1e7,
/// where they say 5e-15. Without a step onto the surface half of the paths would start on its wrong
/// side.
#[test]
fn rays_from_afar_leave_surfaces_as_others_do() {
    for material in ["diffuse = 0.9", "mirror = \"Ag\"", "glass = { ior = 1.5 }"] {
        for distance in [10.0, 1e4, 1e7] {
            let [all, wrong] = departures(&seen_from_afar(distance, material));
            println!("{material}, {distance:e}: {wrong} of {all} wrong");
            // The disk that a radius of 1 covers of the square of 1.9.
            assert!(all > 16 * 16 * 3, "{material} at {distance:e}: {all}");
            assert_eq!(wrong, 0, "{material} at {distance:e} of {all}");
        }
    }
}

/// A scene with lens, lamp, glass and implicit surfaces of both kinds, all lengths times a scale.
fn scaled(scale: f64) -> Vec<[[u64; 3]; 2]> {
    let s = |x: f64| format!("{:?}", x * scale);
    let at = |x: f64, y: f64, z: f64| format!("[{}, {}, {}]", s(x), s(y), s(z));
    let placed = |x: f64, z: f64| {
        let shift = at(x, 0.0, z);
        format!(
            "transform = [{{ rotate_y = 25 }}, {{ scale = {scale:?} }}, {{ translate = {shift} }}]"
        )
    };
    let (from, to, light) = (at(0.5, 2.0, 9.0), at(0.0, 0.0, 0.0), at(1.0, 4.0, 3.0));
    let (radius, focus, floor) = (s(0.05), s(9.0), at(0.0, -1.5, 0.0));
    let [middle, left, right] = [placed(0.0, 0.0), placed(-2.6, 0.5), placed(2.6, 0.0)];
    let text = format!(
        "environment = 0.2\n\
         [camera]\nfrom = {from}\nto = {to}\nfov = 40\n\
         lens = {{ radius = {radius}, focus = {focus} }}\n\
         [image]\nsize = [40, 24]\nspp = 8\nmax_depth = 8\n\
         [materials]\nred = {{ diffuse = 0.6 }}\nglass = {{ glass = \"N-BK7\" }}\n\
         floor = {{ diffuse = 0.5 }}\nlamp = {{ emit = 20 }}\n\
         [[object]]\nshape = \"plane\"\nmaterial = \"floor\"\n\
         transform = [{{ rotate_x = -90 }}, {{ translate = {floor} }}]\n\
         [[object]]\nshape = {{ implicit = \"heart\" }}\nmaterial = \"red\"\n{middle}\n\
         [[object]]\nshape = {{ implicit = \"torus\" }}\nmaterial = \"glass\"\n{left}\n\
         [[object]]\nmaterial = \"red\"\n\
         shape = {{ implicit = \"sin(3*x) + sin(3*y) + sin(3*z)\", \
                    inside = [[-1, -1, -1], [1, 1, 1]], closed = true }}\n{right}\n\
         [[object]]\nshape = {{ sphere = {{ radius = {} }} }}\nmaterial = \"lamp\"\n\
         transform = [{{ translate = {light} }}]\n",
        s(0.5)
    );
    let (plan, scene) = plan(&text);
    pixel_bits(&rendered(&scene, &plan))
}

/// Nothing in the program is a length of its own: powers of two change no digit.
#[test]
fn powers_of_two_change_no_bit() {
    let one = scaled(1.0);
    assert!(one.iter().filter(|[mean, _]| mean[1] != 0).count() > 900);
    for scale in [1024.0, 1.0 / 128.0] {
        let other = scaled(scale);
        let different = one.iter().zip(&other).filter(|(a, b)| a != b).count();
        assert_eq!(different, 0, "pixels at {scale}");
    }
    // A length that is no power of two rounds otherwise.
    assert!(scaled(1.0 + f64::EPSILON) != one);
}

/// Single precision that was asked for is taken, but not in silence where the plan would not have.
#[test]
fn doubts_about_single_precision_are_said() {
    let doubt = |precision: &str, shape: &str, gap: f64| {
        let text = format!(
            "environment = 1\ncamera = {{ from = [0, 0, 5], to = [0, 0, 0], fov = 40 }}\n\
             image = {{ size = [64, 64], spp = 1, precision = \"{precision}\" }}\n\
             materials.white = {{ diffuse = 0.5 }}\n\
             [[object]]\nmaterial = \"white\"\nshape = {shape}\n\
             [[object]]\nmaterial = \"white\"\nshape = {{ sphere = {{ radius = {:?} }} }}\n",
            1.0 + gap
        );
        explain::doubt(&plan(&text).0)
    };
    // Two shells as far apart as those of the rays' oracle, as one field.
    let shells = "{ implicit = \"(x^2 + y^2 + z^2 - 1)^2 - 2^-40\", \
                    inside = [[-2, -2, -2], [2, 2, 2]] }";
    assert!(doubt("f32", shells, 1.0).is_some_and(|text| text.contains("sheets")));
    assert_eq!(doubt("f64", shells, 1.0), None);
    assert_eq!(doubt("auto", shells, 1.0), None);
    assert!(doubt("f32", "\"sphere\"", 1e-6).is_some_and(|text| text.contains("gap")));
    assert_eq!(doubt("f32", "\"sphere\"", 0.5), None);
}
