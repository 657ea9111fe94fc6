//! Enclosures and uniform surroundings, whose answers are geometric series.

use std::f64::consts::PI;

use etalon::inside::spectrum::ior::named_glass;
use glam::DVec3;

use super::agree;
use super::glass::{fresnel_dielectric, over_wavelengths};
use super::harness::Case;
use super::scenes::Text;
use crate::truth_file::{number, numbers, truth};

pub fn cases() -> Vec<Case> {
    let families = [
        closed(),
        open_diffuse(),
        glass(),
        metal_sphere(),
        mirror_sphere_interior(),
        integrating_sphere(),
        off_centre_light(),
        concentric_spheres(),
        parallel_plates(),
        facing_mirrors(),
    ];
    families.into_iter().flatten().collect()
}

/// Unpolarised reflectance of n + ik at a cosine of incidence (Born & Wolf 14.2, in the real form
/// a² + b², a of the square root of η² − sin²).
pub fn fresnel_conductor(cosine: f64, n: f64, k: f64) -> f64 {
    let sine2 = 1.0 - cosine * cosine;
    let t0 = n * n - k * k - sine2;
    let a2b2 = (t0 * t0 + 4.0 * n * n * k * k).sqrt();
    let a = ((a2b2 + t0) / 2.0).max(0.0).sqrt();
    let rs =
        (a2b2 + cosine * cosine - 2.0 * a * cosine) / (a2b2 + cosine * cosine + 2.0 * a * cosine);
    let first = cosine * cosine * a2b2 + sine2 * sine2;
    let second = 2.0 * a * cosine * sine2;
    let rp = rs * (first - second) / (first + second);
    (rs + rp) / 2.0
}

fn closed() -> Vec<Case> {
    let t = truth("furnace_closed");
    let [rho, le] = t.all(["rho", "Le"]);
    let whole = t.exact("L");
    agree(le / (1.0 - rho), whole);
    let scene = |shape: &str, sides: &str| {
        let from = DVec3::new(0.3, 0.2, -0.1);
        Text::perspective(from, DVec3::new(0.2, 0.5, 0.8), 90.0)
            .material("wall", &emitting(rho, le, sides))
            .object(shape, "wall")
    };
    let both = scene("sphere = {}", "both");
    let mut cases = vec![Case::new("furnace_closed sphere both", both, whole)];
    for shape in ["sphere", "cube", "cylinder"] {
        let scene = scene(&format!("{shape} = {{}}"), "back");
        let name = format!("furnace_closed {shape}");
        cases.push(Case::new(name, scene.clone(), whole));
        let limited = numbers(&t["exact"]["L_m"]);
        for (m, limited) in numbers(&t["setup"]["m"]).into_iter().zip(limited) {
            agree(le * (1.0 - rho.powf(m + 1.0)) / (1.0 - rho), limited);
            let scene = scene.clone().depth(m as u32 + 1);
            let name = format!("furnace_closed {shape}, m = {m}");
            cases.push(Case::new(name, scene, limited));
        }
    }
    cases
}

fn open_diffuse() -> Vec<Case> {
    let t = truth("furnace_open_diffuse");
    let [rho, lenv] = t.all(["rho", "Lenv"]);
    let (convex, white) = (t.exact("L_convex"), t.exact("L_white"));
    agree(rho * lenv, convex);
    let from = DVec3::new(3.0, 4.0, 5.0);
    let scene = |albedo: f64, height: f64| {
        Text::orthographic(from, -from, height)
            .material("body", &format!("diffuse = {albedo:?}"))
            .environment(lenv)
    };
    let mut cases: Vec<Case> = ["sphere", "cube", "cylinder"]
        .into_iter()
        .map(|shape| {
            let scene = scene(rho, 0.5).object(&format!("{shape} = {{}}"), "body");
            Case::new(format!("furnace_open_diffuse {shape}"), scene, convex)
        })
        .collect();
    let heap = scene(1.0, 6.0)
        .size([16, 16])
        .object("sphere = {}", "body")
        .sphere("body", 0.8, DVec3::new(1.5, 0.9, 0.4))
        .rectangle("body", 3.0 * DVec3::X, 3.0 * DVec3::Y, -DVec3::Z);
    cases.push(Case::new("furnace_open_diffuse white heap", heap, white));
    cases
}

/// R + (1 − R)² (1 + R + … + R^(e−1)).
fn ways_out(r: f64, exits: f64) -> f64 {
    1.0 - (1.0 - r) * r.powf(exits)
}

fn glass() -> Vec<Case> {
    let t = truth("furnace_glass");
    let setup = &t["setup"];
    let [lenv, theta] = t.all(["Lenv", "theta_deg"]);
    let name = setup["glass"].as_str().unwrap();
    let index = named_glass(name).unwrap();
    let theta = theta.to_radians();
    let exits = numbers(&setup["exits"]);
    let spot = |glass: &str| {
        let from = DVec3::new(theta.sin(), 0.0, 3.0);
        Text::orthographic(from, -DVec3::Z, 1e-4)
            .material("glass", &format!("glass = {glass}"))
            .object("sphere = {}", "glass")
            .environment(lenv)
    };
    let whole = |glass: &str| {
        Text::orthographic(DVec3::new(0.0, 0.0, 3.0), -DVec3::Z, 2.5)
            .material("glass", &format!("glass = {glass}"))
            .object("sphere = {}", "glass")
            .object("cube = { side = 0.5 }", "glass")
            .environment(lenv)
    };
    let mut cases = Vec::new();
    for row in t.rows("per_wavelength") {
        let (nm, ior) = (number(&row["nm"]), number(&row["n"]));
        agree(index.n(nm), ior);
        let r = fresnel_dielectric(theta.cos(), ior);
        agree(r, number(&row["R_unpolarised"]));
        let glass = format!("{{ ior = {ior:?} }}");
        let name = format!("furnace_glass {nm} nm");
        cases.push(Case::new(name, whole(&glass), number(&row["L"])));
        let limited = numbers(&row["L_depth"]);
        for (e, limited) in exits.iter().zip(limited) {
            agree(lenv * ways_out(r, *e), limited);
            let scene = spot(&glass).depth(*e as u32 + 2);
            let name = format!("furnace_glass {nm} nm, {e} exits");
            cases.push(Case::new(name, scene, limited));
        }
    }
    let glass = format!("\"{name}\"");
    for (channel, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
        let flat = over_wavelengths(|_| lenv)[channel];
        let name = format!("furnace_glass dispersive {letter}");
        cases.push(Case::new(name, whole(&glass), flat).channel(channel));
    }
    for e in &exits {
        let out = |nm| lenv * ways_out(fresnel_dielectric(theta.cos(), index.n(nm)), *e);
        let limited = over_wavelengths(out);
        let scene = spot(&glass).depth(*e as u32 + 2);
        let name = format!("furnace_glass dispersive, {e} exits");
        cases.push(Case::new(name, scene, limited[1]));
    }
    cases
}

fn metal_sphere() -> Vec<Case> {
    let t = truth("furnace_metal_mirror_sphere");
    let setup = &t["setup"];
    let [index, k] = t.all(["n", "k"]);
    let lenv = t.of("Lenv");
    let scene = |x: f64, height: f64| {
        Text::orthographic(DVec3::new(x, 0.0, 3.0), -DVec3::Z, height)
            .material("metal", &format!("mirror = {{ n = {index:?}, k = {k:?} }}"))
            .object("sphere = {}", "metal")
            .environment(lenv)
    };
    let mut cases = Vec::new();
    let at = numbers(&t["exact"]["L_at_theta"]);
    for (degrees, exact) in numbers(&setup["theta_deg"]).into_iter().zip(at) {
        let theta = degrees.to_radians();
        agree(lenv * fresnel_conductor(theta.cos(), index, k), exact);
        // θ changes by height/cos θ over the spot.
        let scene = scene(theta.sin(), 1e-4 * theta.cos().powi(2));
        let name = format!("furnace_metal_mirror_sphere {degrees}°");
        cases.push(Case::new(name, scene, exact));
    }
    let exact = t.exact("L_disc_mean");
    let scene = scene(0.0, 2.0).size([16, 16]);
    let around = lenv * (1.0 - PI / 4.0);
    let case = Case::new("furnace_metal_mirror_sphere disc", scene, exact);
    cases.push(case.mapped(-around, 4.0 / PI));
    cases
}

fn mirror_sphere_interior() -> Vec<Case> {
    let t = truth("mirror_sphere_interior");
    let [index, k, r, a, le, m] = t.all(["n", "k", "r", "a", "Le", "m"]);
    let mut cases = Vec::new();
    for row in t.rows("per_direction") {
        let degrees = number(&row["psi_deg"]);
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let incidence = (1.0 - (a / r * sine).powi(2)).sqrt();
        let reflectance = fresnel_conductor(incidence, index, k);
        agree(le / (1.0 - reflectance), number(&row["L"]));
        let metal = format!("mirror = {{ n = {index:?}, k = {k:?} }}");
        let scene = Text::orthographic(a * DVec3::Z, DVec3::new(sine, 0.0, cosine), 1e-4 * r)
            .material("wall", &format!("{metal}, emit = {le:?}, sides = \"back\""))
            .sphere("wall", r, DVec3::ZERO);
        let name = format!("mirror_sphere_interior {degrees}°");
        let limited = scene.clone().depth(m as u32 + 1);
        cases.push(Case::new(name.clone(), scene, number(&row["L"])));
        let name = format!("{name}, m = {m}");
        cases.push(Case::new(name, limited, number(&row["L_m"])));
    }
    cases
}

fn integrating_sphere() -> Vec<Case> {
    let t = truth("integrating_sphere");
    let [r, rho, intensity] = t.all(["r", "rho", "I"]);
    let half_angle = t.of("port_half_angle_deg").to_radians();
    let port = (1.0 - half_angle.cos()) / 2.0;
    let wall = t.exact("L_wall");
    let once = rho * intensity / (PI * r * r);
    agree(once / (1.0 - rho * (1.0 - port)), wall);
    // The port is a black disk across its chord; its rim may stand out of the sphere.
    let (height, rim) = (r * half_angle.cos(), 1.01 * r * half_angle.sin());
    let scene = Text::perspective(DVec3::new(0.0, 0.0, 0.9 * height), -DVec3::Z, 40.0)
        .material("wall", &format!("diffuse = {rho:?}"))
        .material("port", "black = true")
        .sphere("wall", r, DVec3::ZERO)
        .disk("port", rim, DVec3::Z, height * DVec3::Z)
        .point_light(DVec3::ZERO, intensity);
    let mut cases = vec![Case::new("integrating_sphere", scene.clone(), wall)];
    for (m, limited) in t["exact"]["L_m"].as_object().unwrap() {
        let scene = scene.clone().depth(m.parse::<u32>().unwrap() + 1);
        let name = format!("integrating_sphere m = {m}");
        cases.push(Case::new(name, scene, number(limited)));
    }
    cases
}

fn off_centre_light() -> Vec<Case> {
    let t = truth("sphere_off_centre_light");
    let [r, c, intensity, rho] = t.all(["r", "c", "I", "rho"]);
    let rows = t.rows("per_point");
    rows.iter()
        .map(|row| {
            let degrees = number(&row["psi_deg"]);
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let outward = DVec3::new(sine, 0.0, cosine);
            let light = DVec3::new(0.0, 0.0, c);
            let to = outward * r - light;
            let direct = intensity * to.normalize().dot(outward) / to.length_squared();
            let indirect = rho / (1.0 - rho) * intensity / (r * r);
            agree(rho / PI * (direct + indirect), number(&row["L"]));
            let scene = Text::orthographic(outward * (0.999 * r), outward, 1e-4 * r)
                .material("wall", &format!("diffuse = {rho:?}"))
                .sphere("wall", r, DVec3::ZERO)
                .point_light(light, intensity);
            let name = format!("sphere_off_centre_light {degrees}°");
            Case::new(name, scene, number(&row["L"]))
        })
        .collect()
}

/// Radiances of two concentric spheres that reflect and emit.
pub fn two_bodies(ratio: f64, rho: [f64; 2], le: [f64; 2]) -> [f64; 2] {
    let f21 = ratio * ratio;
    // B2 (1 − rho2 F22 − rho2 F21 rho1) = E2 + rho2 F21 E1.
    let outer =
        (le[1] + rho[1] * f21 * le[0]) / (1.0 - rho[1] * (1.0 - f21) - rho[1] * f21 * rho[0]);
    [le[0] + rho[0] * outer, outer]
}

/// A diffuse surface that emits.
fn emitting(rho: f64, le: f64, sides: &str) -> String {
    format!("diffuse = {rho:?}, emit = {le:?}, sides = \"{sides}\"")
}

/// A view from between two concentric spheres, inward or outward.
pub fn between(r: [f64; 2], rho: [f64; 2], le: [f64; 2], inward: bool) -> Text {
    let out = DVec3::new(0.6, 0.0, 0.8);
    let towards = if inward { -out } else { out };
    let from = out * ((r[0] + r[1]) / 2.0);
    Text::perspective(from, towards, 20.0)
        .material("inner", &emitting(rho[0], le[0], "front"))
        .material("outer", &emitting(rho[1], le[1], "back"))
        .sphere("inner", r[0], DVec3::ZERO)
        .sphere("outer", r[1], DVec3::ZERO)
}

fn concentric_spheres() -> Vec<Case> {
    let t = truth("concentric_spheres");
    let [r, rho, le] = ["r", "rho", "Le"].map(|key| [1, 2].map(|i| t.of(&format!("{key}{i}"))));
    let exact = ["L_inner", "L_outer"].map(|key| t.exact(key));
    let own = two_bodies(r[0] / r[1], rho, le);
    let case = |i: usize| {
        agree(own[i], exact[i]);
        let name = format!("concentric_spheres {}", ["inner", "outer"][i]);
        Case::new(name, between(r, rho, le, i == 0), exact[i])
    };
    [0, 1].map(case).into()
}

fn parallel_plates() -> Vec<Case> {
    let t = truth("parallel_plates");
    let (rho, le) = (t.all(["rho1", "rho2"]), t.all(["Le1", "Le2"]));
    let exact = ["L1", "L2"].map(|key| t.exact(key));
    let mut cases = Vec::new();
    // Plates without end, and squares whose side is 5000 times their distance: (2 g/s)² = 1.6e-7.
    for (shape, size) in [("plane", 1.0), ("rectangle", 2500.0)] {
        for below in [true, false] {
            let towards = if below { -DVec3::Z } else { DVec3::Z };
            let axes = [size * DVec3::X, size * DVec3::Y, DVec3::Z];
            let scene = Text::orthographic(DVec3::new(0.0, 0.0, 0.5), towards, 0.1)
                .material("lower", &emitting(rho[0], le[0], "front"))
                .material("upper", &emitting(rho[1], le[1], "back"))
                .placed(&format!("{shape} = {{}}"), "lower", axes, DVec3::ZERO)
                .placed(&format!("{shape} = {{}}"), "upper", axes, DVec3::Z);
            let (i, j) = if below { (0, 1) } else { (1, 0) };
            agree((le[i] + rho[i] * le[j]) / (1.0 - rho[0] * rho[1]), exact[i]);
            let name = format!("parallel_plates {shape} {}", i + 1);
            cases.push(Case::new(name, scene, exact[i]).systematic(1e-5));
        }
    }
    cases
}

fn facing_mirrors() -> Vec<Case> {
    let t = truth("facing_mirrors");
    let [index, k, le] = t.all(["n", "k", "Le"]);
    let theta = t.of("theta_deg").to_radians();
    let r = t.exact("R");
    agree(fresnel_conductor(theta.cos(), index, k), r);
    let metal = format!("mirror = {{ n = {index:?}, k = {k:?} }}");
    let from = DVec3::new(0.0, 0.0, 0.5);
    let towards = DVec3::new(theta.sin(), 0.0, -theta.cos());
    let look = Text::orthographic(from, towards, 1e-2);
    let mut cases = Vec::new();
    let images = numbers(&t["exact"]["L_image"]);
    for (j, exact) in numbers(&t["setup"]["j"]).into_iter().zip(images) {
        agree(le * r.powf(j), exact);
        // Half a step to the first reflection, one more to each of the others; the mirrors end
        // half a step after the last, and the lamp is the world beyond.
        let end = theta.tan() * j;
        let half = (end + 10.0) / 2.0;
        let centre = DVec3::new(end - half, 0.0, 0.0);
        let scene = look
            .clone()
            .material("metal", &metal)
            .rectangle("metal", half * DVec3::X, DVec3::Y, centre)
            .rectangle("metal", half * DVec3::X, DVec3::Y, centre + DVec3::Z)
            .environment(le);
        cases.push(Case::new(format!("facing_mirrors j = {j}"), scene, exact));
    }
    let exact = t.exact("L_emitting");
    let upper = format!("{metal}, emit = {le:?}, sides = \"back\"");
    let scene = look
        .material("lower", &format!("{metal}, emit = {le:?}"))
        .material("upper", &upper)
        .object("plane = {}", "lower")
        .placed("plane = {}", "upper", DVec3::AXES, DVec3::Z);
    cases.push(Case::new("facing_mirrors emitting", scene, exact));
    cases
}
