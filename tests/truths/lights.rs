//! Light sampling against view factors.

use std::f64::consts::PI;

use glam::DVec3;

use super::agree;
use super::harness::Case;
use super::scenes::Text;
use crate::truth_file::{list, number, numbers, truth, vector};

pub fn cases() -> Vec<Case> {
    let families = [
        polygon("polygon_light"),
        polygon("polygon_light_horizon"),
        sphere(),
        disk(),
        point(),
        occluder(),
        mirror_image(),
        plates(),
        two_spheres(),
    ];
    families.into_iter().flatten().collect()
}

/// A small diffuse square about `p` seen from just above it, in a spot of 1e-4.
fn receiver(p: DVec3, normal: DVec3, rho: f64) -> Text {
    let a = super::scenes::across(normal);
    let b = normal.cross(a);
    Text::orthographic(p + 1e-3 * normal, -normal, 1e-4)
        .material("receiver", &format!("diffuse = {rho:?}"))
        .rectangle("receiver", 5e-3 * a, 5e-3 * b, p)
}

/// Irradiance of a uniform polygon (Lambert 1760), clipped by the receiver's plane.
fn polygon_irradiance(corners: &[DVec3], normal: DVec3, le: f64) -> f64 {
    let mut above = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (da, db) = (a.dot(normal), b.dot(normal));
        if da >= 0.0 {
            above.push(a);
        }
        if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
            above.push(a + (b - a) * (da / (da - db)));
        }
    }
    let edge = |i: usize| {
        let [u, w] = [i, i + 1].map(|i| above[i % above.len()].normalize());
        u.dot(w).clamp(-1.0, 1.0).acos() * u.cross(w).normalize().dot(normal)
    };
    let sum: f64 = (0..above.len()).map(edge).sum();
    le / 2.0 * sum.abs()
}

fn polygon(id: &str) -> Vec<Case> {
    let t = truth(id);
    let setup = &t["setup"];
    let (p, normal) = (vector(&setup["P"]), vector(&setup["N"]).normalize());
    let [le, rho] = t.all(["Le", "rho"]);
    let corners: Vec<DVec3> = list(&setup["V"]).iter().map(vector).collect();
    let exact = t.exact("L_o");
    let relative: Vec<DVec3> = corners.iter().map(|c| *c - p).collect();
    agree(polygon_irradiance(&relative, normal, le), t.exact("E"));
    let [a, b] = [1, 3].map(|i: usize| (corners[i] - corners[0]) / 2.0);
    let centre = (corners[0] + corners[2]) / 2.0;
    ["front", "back", "both"]
        .into_iter()
        .map(|sides| {
            // The front is the side of a × b: towards the receiver for "front", away for "back".
            let towards = a.cross(b).dot(p - centre) > 0.0;
            let (a, b) = match (sides, towards) {
                ("front", false) | ("back", true) => (b, a),
                _ => (a, b),
            };
            let scene = receiver(p, normal, rho)
                .material("lamp", &format!("emit = {le:?}, sides = \"{sides}\""))
                .rectangle("lamp", a, b, centre);
            Case::new(format!("{id} {sides}"), scene, exact)
        })
        .collect()
}

/// E/(π L) of a sphere of radius r at distance d, cos β = c, with the horizon.
fn sphere_factor(r: f64, d: f64, c: f64) -> f64 {
    let h = d / r;
    let sine = (1.0 - c * c).max(0.0).sqrt();
    if c * h >= 1.0 {
        return c / (h * h);
    }
    if c * h <= -1.0 {
        return 0.0;
    }
    let root = (h * h - 1.0).sqrt();
    let cut = (1.0 - h * h * c * c).sqrt();
    let first = c * (-c * root / sine).acos() - cut * root;
    (first / (h * h) + (cut / root).atan()) / PI
}

fn sphere() -> Vec<Case> {
    let t = truth("sphere_light");
    let [r, d, le, rho] = t.all(["r", "d", "Le", "rho"]);
    let rows = t.rows("per_angle");
    rows.iter()
        .map(|row| {
            let degrees = number(&row["beta_deg"]);
            let (sine, cosine) = degrees.to_radians().sin_cos();
            agree(PI * le * sphere_factor(r, d, cosine), number(&row["E"]));
            let scene = receiver(DVec3::ZERO, DVec3::Z, rho)
                .material("lamp", &format!("emit = {le:?}"))
                .sphere("lamp", r, DVec3::new(d * sine, 0.0, d * cosine));
            let name = format!("sphere_light {degrees}°");
            Case::new(name, scene, number(&row["L_o"]))
        })
        .collect()
}

fn disk() -> Vec<Case> {
    let t = truth("disk_light");
    let [r, h, le, rho] = t.all(["r", "h", "Le", "rho"]);
    let rows = t.rows("per_offset");
    rows.iter()
        .map(|row| {
            let a = number(&row["a"]);
            // The formula of the file, times a² above and below, so that a may be 0.
            let z = a * a + h * h + r * r;
            let factor = (1.0 - (z - 2.0 * r * r) / (z * z - 4.0 * r * r * a * a).sqrt()) / 2.0;
            agree(factor, number(&row["F"]));
            let scene = receiver(DVec3::ZERO, DVec3::Z, rho)
                .material("lamp", &format!("emit = {le:?}"))
                .disk("lamp", r, -DVec3::Z, DVec3::new(a, 0.0, h));
            Case::new(format!("disk_light a = {a}"), scene, number(&row["L_o"]))
        })
        .collect()
}

fn point() -> Vec<Case> {
    let t = truth("point_light");
    let [intensity, h, rho] = t.all(["I", "h", "rho"]);
    let rows = t.rows("per_point");
    rows.iter()
        .map(|row| {
            let x = number(&row["x"]);
            let irradiance = intensity * h / (h * h + x * x).powf(1.5);
            agree(rho * irradiance / PI, number(&row["L_o"]));
            let scene = receiver(DVec3::new(x, 0.0, 0.0), DVec3::Z, rho)
                .point_light(DVec3::new(0.0, 0.0, h), intensity);
            Case::new(format!("point_light x = {x}"), scene, number(&row["L_o"]))
        })
        .collect()
}

fn occluder() -> Vec<Case> {
    let t = truth("sphere_occluder_in_environment");
    let [r, h, rho, lenv] = t.all(["r", "h", "rho", "Lenv"]);
    let rows = t.rows("per_point");
    rows.iter()
        .map(|row| {
            let x = number(&row["x"]);
            let d = (h * h + x * x).sqrt();
            let visible = 1.0 - sphere_factor(r, d, h / d);
            agree(rho * lenv * visible, number(&row["L_o"]));
            let scene = Text::orthographic(DVec3::new(x, 0.0, 1e-3), -DVec3::Z, 1e-4)
                .material("floor", &format!("diffuse = {rho:?}"))
                .material("black", "black = true")
                .object("plane = {}", "floor")
                .sphere("black", r, DVec3::new(0.0, 0.0, h))
                .environment(lenv);
            let name = format!("sphere_occluder_in_environment x = {x}");
            Case::new(name, scene, number(&row["L_o"]))
        })
        .collect()
}

fn mirror_image() -> Vec<Case> {
    let t = truth("mirror_image_of_sphere_light");
    let setup = &t["setup"];
    let [r, reflectance, le, rho, x] = t.all(["r", "R", "Le", "rho", "mirror_x"]);
    let (p, centre) = (vector(&setup["P"]), vector(&setup["sphere"]));
    let irradiance = |c: DVec3| {
        let to = c - p;
        PI * le * sphere_factor(r, to.length(), to.z / to.length())
    };
    let image = DVec3::new(2.0 * x - centre.x, centre.y, centre.z);
    agree(irradiance(centre), t.exact("E_direct"));
    agree(reflectance * irradiance(image), t.exact("E_mirror"));
    let scene = receiver(p, DVec3::Z, rho)
        .material("lamp", &format!("emit = {le:?}"))
        .material("mirror", &format!("mirror = {{ ideal = {reflectance:?} }}"))
        .sphere("lamp", r, centre)
        .rectangle("mirror", 5.0 * DVec3::Y, 5.0 * DVec3::Z, x * DVec3::X);
    let exact = t.exact("L_o");
    // The receiver's own light by way of the mirror is below 1e-5 of it.
    vec![Case::new("mirror_image_of_sphere_light", scene, exact).systematic(1e-5)]
}

/// Howell C-11: opposed equal rectangles a × b at distance c.
fn opposed_factor(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (x1, y1) = (1.0 + x * x, 1.0 + y * y);
    let log = (x1 * y1 / (x1 + y1 - 1.0)).sqrt().ln();
    let terms =
        log + x * y1.sqrt() * (x / y1.sqrt()).atan() + y * x1.sqrt() * (y / x1.sqrt()).atan()
            - x * x.atan()
            - y * y.atan();
    2.0 / (PI * x * y) * terms
}

/// Howell C-41: coaxial disks.
fn disks_factor(r1: f64, r2: f64, h: f64) -> f64 {
    let (a, b) = (r1 / h, r2 / h);
    let s = 1.0 + (1.0 + b * b) / (a * a);
    (s - (s * s - 4.0 * (b / a).powi(2)).sqrt()) / 2.0
}

/// Parallel rays average uniformly over a plate: the picture's mean is the view factor.
fn plates() -> Vec<Case> {
    let t = truth("plate_view_factors");
    let [opposed, upright, disks] =
        ["opposed", "perpendicular", "disks"].map(|key| numbers(&t["setup"][key]));
    let exact = |key: &str| t.exact(key);
    let view = |centre: DVec3, side: f64| {
        Text::upright(centre + 1e-3 * DVec3::Z, -DVec3::Z, DVec3::Y, side)
            .size([16, 16])
            .depth(2)
            .material("plate", "diffuse = 1")
            .material("lamp", "emit = 1")
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);

    let [a, b, c] = opposed[..] else { panic!() };
    agree(opposed_factor(a, b, c), exact("F_opposed"));
    let side = a.max(b);
    let scene = view(DVec3::ZERO, side)
        .rectangle("plate", a / 2.0 * x, b / 2.0 * y, DVec3::ZERO)
        .rectangle("lamp", b / 2.0 * y, a / 2.0 * x, c * z);
    let case = Case::new("plate_view_factors opposed", scene, exact("F_opposed"));
    let mut cases = vec![case.mapped(0.0, side * side / (a * b))];

    let [w, h, l] = upright[..] else { panic!() };
    let side = w.max(l);
    let centre = w / 2.0 * x;
    let scene = view(centre, side)
        .rectangle("plate", w / 2.0 * x, l / 2.0 * y, centre)
        .rectangle("lamp", l / 2.0 * y, h / 2.0 * z, h / 2.0 * z);
    let name = "plate_view_factors perpendicular";
    let case = Case::new(name, scene, exact("F_perpendicular"));
    cases.push(case.mapped(0.0, side * side / (w * l)));

    let [r1, r2, h] = disks[..] else { panic!() };
    agree(disks_factor(r1, r2, h), exact("F_disks_12"));
    let scene = view(DVec3::ZERO, 2.0 * r1)
        .disk("plate", r1, z, DVec3::ZERO)
        .disk("lamp", r2, -z, h * z);
    let case = Case::new("plate_view_factors disks", scene, exact("F_disks_12"));
    cases.push(case.mapped(0.0, 4.0 / PI));
    cases
}

/// F12 is the mean over sphere 1 of the factor of its elements, and those are looked at.
fn two_spheres() -> Vec<Case> {
    let t = truth("two_sphere_view_factor");
    let [r1, r2, s] = t.all(["r1", "r2", "s"]);
    let element = |r1: f64, r2: f64, psi: f64| {
        let d = (r1 * r1 + s * s - 2.0 * r1 * s * psi.cos()).sqrt();
        sphere_factor(r2, d, (s * psi.cos() - r1) / d)
    };
    // The midpoint rule, whose error falls with the square of the step.
    let factor = |r1: f64, r2: f64| {
        let steps = 200_000;
        let step = PI / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|i| (f64::from(i) + 0.5) * step)
            .map(|psi| element(r1, r2, psi) * psi.sin())
            .sum();
        sum * step / 2.0
    };
    agree(factor(r1, r2), t.exact("F12"));
    agree(factor(r2, r1), t.exact("F21"));
    let largest = element(r1, r2, 0.0);
    (0..8)
        .map(|i| f64::from(i) * PI / 16.0)
        .filter(|psi| element(r1, r2, *psi) > 0.01 * largest)
        .map(|psi| {
            let outward = DVec3::new(psi.sin(), 0.0, psi.cos());
            let scene = Text::orthographic(outward * (r1 + 1e-3), -outward, 1e-4)
                .depth(2)
                .material("receiver", "diffuse = 1")
                .material("lamp", "emit = 1")
                .sphere("receiver", r1, DVec3::ZERO)
                .sphere("lamp", r2, s * DVec3::Z);
            let name = format!("two_sphere_view_factor element {:.2}°", psi.to_degrees());
            Case::new(name, scene, element(r1, r2, psi))
        })
        .collect()
}
