//! Cameras and silhouettes.

use std::f64::consts::PI;

use etalon::Window;
use etalon::inside::math::affine::Affine;
use etalon::inside::shape::{Placed, Ray, ShapeKind, Start, Tally};
use etalon_doors::shapes::crossings;
use glam::{DMat3, DVec3};

use super::agree;
use super::harness::Case;
use super::scenes::Text;
use crate::truth_file::{Truth, list, number, numbers, truth, vector};

pub fn cases() -> Vec<Case> {
    let families = [lens_edge(), sphere_area(), ellipsoid()];
    families.into_iter().flatten().collect()
}

/// Columns of the picture; the circle of confusion is [`BLUR`] of them wide.
const COLUMNS: u32 = 65_536;
const BLUR: f64 = 60_000.0;

fn lens_edge() -> Vec<Case> {
    let t = truth("thin_lens_edge");
    let [d, focus, s, le] = t.all(["D", "s_f", "s", "Le"]);
    let blur = d * (s - focus).abs() / s;
    agree(blur, t.exact("c_f"));
    let profile = |u: f64| le * (0.5 + (u * (1.0 - u * u).sqrt() + u.asin()) / PI);
    let pixel = blur / BLUR;
    let rows = 8;
    let fov = 2.0 * (f64::from(rows) * pixel / 2.0 / focus).atan().to_degrees();
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    // right = forward × up: with up = y and forward = −z, right is x.
    let scene = Text::lens(DVec3::ZERO, -z, y, fov, [d / 2.0, focus])
        .size([COLUMNS, rows])
        .material("lamp", &format!("emit = {le:?}"))
        .rectangle("lamp", 100.0 * s * x, 100.0 * s * y, 100.0 * s * x - s * z);
    let exact = numbers(&t["exact"]["L"]);
    numbers(&t["setup"]["u"])
        .into_iter()
        .zip(exact)
        .map(|(u, exact)| {
            agree(profile(u), exact);
            let middle = (f64::from(COLUMNS) / 2.0 + u * BLUR / 2.0).round();
            let x0 = middle as u32 - 4;
            // The window's own centre, half a pixel at most from u.
            let own = (middle - f64::from(COLUMNS) / 2.0) * 2.0 / BLUR;
            let window = Window {
                x0,
                y0: 0,
                x1: x0 + 8,
                y1: rows,
            };
            let name = format!("thin_lens_edge u = {u}");
            Case::new(name, scene.clone(), profile(own)).window(window)
        })
        .collect()
}

fn sphere_area() -> Vec<Case> {
    let t = truth("perspective_sphere_area");
    let setup = &t["setup"];
    let [r, fov] = t.all(["r", "fov_deg"]);
    let centre = vector(&setup["centre"]);
    let sine2 = r * r / centre.length_squared();
    let cosine2 = (centre.z / centre.length()).powi(2);
    let major = (sine2 * (1.0 - sine2)).sqrt() / (cosine2 - sine2);
    let minor = (sine2 / (cosine2 - sine2)).sqrt();
    let half = (fov / 2.0).to_radians().tan();
    let exact = t.exact("fraction");
    agree(PI * major * minor / (4.0 * half * half), exact);
    let scene = Text::perspective(DVec3::ZERO, DVec3::Z, fov)
        .size([32, 32])
        .material("lamp", "emit = 1")
        .sphere("lamp", r, centre);
    vec![Case::new("perspective_sphere_area", scene, exact)]
}

/// The matrix and the direction that it is seen along.
fn sheared() -> (Truth, DMat3, DVec3) {
    let t = truth("sheared_ellipsoid");
    let rows: Vec<DVec3> = list(&t["setup"]["M"]).iter().map(vector).collect();
    let matrix = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    let u = vector(&t["setup"]["u"]);
    (t, matrix, u)
}

fn ellipsoid() -> Vec<Case> {
    let (t, matrix, u) = sheared();
    let u = u.normalize();
    let area = t.exact("silhouette_area");
    let shrunk = (matrix.inverse() * u).length();
    agree(PI * matrix.determinant().abs() * shrunk, area);
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let reach = columns.iter().map(|c| c.length()).sum::<f64>();
    let height = 2.0 * reach;
    let view = || Text::orthographic(2.0 * reach * u, -u, height).size([32, 32]);
    let whole = height * height;
    let lamp =
        view()
            .material("lamp", "emit = 1")
            .placed("sphere = {}", "lamp", columns, DVec3::ZERO);
    // Lit and seen along u, radiance 1/π × irradiance π × cosine.
    let lit = view()
        .depth(2)
        .material("body", "diffuse = 1")
        .placed("sphere = {}", "body", columns, DVec3::ZERO)
        .directional(-u, PI);
    let cosine = t.exact("mean_cos");
    vec![
        Case::new("sheared_ellipsoid silhouette", lamp, area).mapped(0.0, whole),
        Case::new("sheared_ellipsoid mean cosine", lit, cosine).mapped(0.0, whole / area),
    ]
}

#[test]
fn a_sheared_sphere_is_hit_where_and_how_it_must() {
    let (t, matrix, _) = sheared();
    let rows = [0, 1, 2].map(|i| matrix.row(i).extend(0.0).to_array());
    let placed = Placed::new(ShapeKind::Sphere, &Affine { rows }).unwrap();
    let ray = Ray {
        origin: vector(&t["setup"]["ray_o"]),
        direction: vector(&t["setup"]["ray_d"]),
    };
    let crossings = crossings(&placed, &ray).unwrap();
    let length = ray.direction.length();
    let exact = numbers(&t["exact"]["t_hit"]);
    for (hit, exact) in crossings.iter().zip(exact) {
        // A rounding of t, one of the file's number, and those of the direction's length.
        let error = (hit.t * length / exact - 1.0).abs();
        assert!(error <= 4.0 * f64::EPSILON, "{} for {exact}", hit.t);
    }
    let normal = vector(&t["exact"]["hit_normal"]);
    assert!((crossings[0].normal - normal).length() <= 4.0 * f64::EPSILON);
    // The normal carried by the matrix itself, instead of its inverse transposed, is another.
    let wrong = (matrix * crossings[0].local).normalize();
    assert!((wrong - normal).length() > 1e-3);
}

#[test]
fn spheres_are_hit_far_away_and_near_the_limb() {
    let t = truth("far_grazing_sphere");
    for row in t.rows("rows") {
        let [r, b, d, exact] = ["r", "b", "D", "t"].map(|key| number(&row[key]));
        agree(d - (r * r - b * b).sqrt(), exact);
        let placed = Placed::new(ShapeKind::Sphere, &Affine::scale(DVec3::splat(r))).unwrap();
        let ray = Ray {
            origin: DVec3::new(b, 0.0, -d),
            direction: DVec3::Z,
        };
        let hit = placed
            .first_hit(&ray, 0.0, Start::Free, &mut Tally::default())
            .unwrap();
        // Near the limb the file's decimal b is another number than its f64: t moves by b/√(r² − b²)
        // times half a unit in the last place of b.
        let read = b / (r * r - b * b).sqrt() * b * f64::EPSILON / 2.0;
        let allowed = 1e-15 * exact + read;
        assert!((hit.t - exact).abs() <= allowed, "{row}: {}", hit.t);
    }
}
