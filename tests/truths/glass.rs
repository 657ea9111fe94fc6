//! Refraction: how much goes through, and where it goes.

use std::f64::consts::{FRAC_PI_2, PI};

use etalon::inside::spectrum::ior::named_glass;
use etalon::inside::spectrum::observer::{Y_INTEGRAL, xyz_bar};
use etalon::inside::spectrum::{NM_MAX, NM_MIN};
use glam::{DVec2, DVec3};

use super::agree;
use super::harness::Case;
use super::scenes::Text;
use crate::truth_file::{number, numbers, truth};

pub fn cases() -> Vec<Case> {
    let families = [slab(), slab_shift(), prism(), rainbow(), coated_diffuse()];
    families.into_iter().flatten().collect()
}

/// Unpolarised reflectance of a dielectric, η = n_transmitted/n_incident (Born & Wolf 1.5).
pub fn fresnel_dielectric(cosine: f64, eta: f64) -> f64 {
    let sine2 = (1.0 - cosine * cosine) / (eta * eta);
    if sine2 >= 1.0 {
        return 1.0;
    }
    let transmitted = (1.0 - sine2).sqrt();
    let rs = (cosine - eta * transmitted) / (cosine + eta * transmitted);
    let rp = (eta * cosine - transmitted) / (eta * cosine + transmitted);
    (rs * rs + rp * rp) / 2.0
}

/// X, Y, Z of a spectrum that is zero from `end` on (by the midpoint rule).
pub fn until(end: f64, radiance: impl Fn(f64) -> f64) -> [f64; 3] {
    let steps = 10_000;
    let step = (end - NM_MIN) / f64::from(steps);
    let mut sum = [0.0; 3];
    for i in 0..steps {
        let nm = NM_MIN + (f64::from(i) + 0.5) * step;
        let value = radiance(nm) * step / Y_INTEGRAL;
        for (sum, bar) in sum.iter_mut().zip(xyz_bar(nm)) {
            *sum += value * bar;
        }
    }
    sum
}

pub fn over_wavelengths(radiance: impl Fn(f64) -> f64) -> [f64; 3] {
    until(NM_MAX, radiance)
}

fn slab() -> Vec<Case> {
    let t = truth("slab");
    let name = t["setup"]["glass"].as_str().unwrap();
    let index = named_glass(name).unwrap();
    // A slab 0.01 thick and 100 wide, seen from 0.1 above; the lamp beyond it, or behind the
    // camera. At 89° a ray that bounces a hundred times inside is still over the slab.
    let scene = |glass: &str, theta: f64, lamp: f64| {
        let (sine, cosine) = theta.sin_cos();
        let towards = DVec3::new(sine, 0.0, -cosine);
        let from = DVec3::new(0.0, 0.0, 0.01) - towards * (0.1 / cosine);
        Text::orthographic(from, towards, 1e-2)
            .material("glass", &format!("glass = {glass}"))
            .material("lamp", "emit = 1, sides = \"both\"")
            .object("cube = { size = [100.0, 100.0, 0.01] }", "glass")
            .rectangle("lamp", 40.0 * DVec3::X, 40.0 * DVec3::Y, lamp * DVec3::Z)
    };
    let through = |r: f64| (1.0 - r) / (1.0 + r);
    let mut cases = Vec::new();
    for row in t.rows("rows") {
        let (nm, ior) = (number(&row["nm"]), number(&row["n"]));
        let degrees = number(&row["theta_deg"]);
        let theta = degrees.to_radians();
        agree(index.n(nm), ior);
        let r = fresnel_dielectric(theta.cos(), ior);
        agree(r, number(&row["R"]));
        agree(through(r), number(&row["T_scalar"]));
        let glass = format!("{{ ior = {ior:?} }}");
        let below = scene(&glass, theta, -0.1);
        for (key, scene) in [
            ("T_scalar", below.clone()),
            ("R_scalar", scene(&glass, theta, 0.3)),
            ("T1", below.depth(3)),
        ] {
            let name = format!("slab {nm} nm {degrees}° {key}");
            cases.push(Case::new(name, scene, number(&row[key])));
        }
    }
    let glass = format!("\"{name}\"");
    for degrees in numbers(&t["setup"]["theta_deg"]) {
        let theta = degrees.to_radians();
        let exact = over_wavelengths(|nm| through(fresnel_dielectric(theta.cos(), index.n(nm))));
        let name = format!("slab dispersive {degrees}°");
        cases.push(Case::new(name, scene(&glass, theta, -0.1), exact[1]));
    }
    cases
}

/// The lamp ends where the middle of the beam must arrive, so half of the beam finds it; a beam of
/// width w that arrives δ' instead of δ aside lights ½ + (δ' − δ)/w.
fn slab_shift() -> Vec<Case> {
    let t = truth("slab_shift");
    let [ior, thickness] = t.all(["n", "t"]);
    let angles = numbers(&t["setup"]["theta_deg"]);
    let shifts = numbers(&t["exact"]["delta"]);
    angles
        .into_iter()
        .zip(shifts)
        .map(|(degrees, shift)| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let inside = (ior * ior - sine * sine).sqrt();
            agree(thickness * sine * (1.0 - cosine / inside), shift);
            let towards = DVec3::new(sine, 0.0, -cosine);
            let aside = DVec3::new(-cosine, 0.0, -sine);
            let size = 0.05 * thickness;
            let edge = towards * (2.0 * thickness / cosine + thickness) + aside * shift;
            let width = 1e-3 * shift;
            let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
            let slab = [100.0 * thickness * x, thickness * y, thickness / 2.0 * z];
            let scene = Text::orthographic(-towards * (0.1 * thickness), towards, width)
                .depth(3)
                .double()
                .material("glass", &format!("glass = {{ ior = {ior:?} }}"))
                .material("lamp", "emit = 1, sides = \"both\"")
                .block("glass", slab, -slab[2])
                .rectangle("lamp", size * aside, size * DVec3::Y, edge + size * aside);
            let r = fresnel_dielectric(cosine, ior);
            let through = (1.0 - r).powi(2);
            let name = format!("slab_shift {degrees}°");
            Case::new(name, scene, shift).mapped((shift / width - 0.5) * through, width / through)
        })
        .collect()
}

/// A ray in the plane of the prism: into face 1, out of face 2.
struct PrismRay {
    /// Where the ray leaves, and where to.
    exit: DVec2,
    towards: DVec2,
    deviation: f64,
    transmittance: f64,
    /// Width of the beam that leaves over that of the beam that enters.
    widening: f64,
}

/// The prism's apex is the origin; its faces go down along `faces`, with outward `normals`.
struct Prism {
    apex: f64,
    faces: [DVec2; 2],
    normals: [DVec2; 2],
}

impl Prism {
    fn new(apex: f64) -> Self {
        let (sine, cosine) = (apex / 2.0).sin_cos();
        Self {
            apex,
            faces: [DVec2::new(-sine, -cosine), DVec2::new(sine, -cosine)],
            normals: [DVec2::new(-cosine, sine), DVec2::new(cosine, sine)],
        }
    }

    /// Point and direction of incidence at angle i, from below.
    fn entry(&self, i: f64) -> (DVec2, DVec2) {
        let towards = -i.cos() * self.normals[0] - i.sin() * self.faces[0];
        (0.3 * self.faces[0], towards)
    }

    fn trace(&self, i: f64, ior: f64) -> PrismRay {
        let (entry, _) = self.entry(i);
        let r = (i.sin() / ior).asin();
        let inside = -r.cos() * self.normals[0] - r.sin() * self.faces[0];
        let t = -entry.dot(self.normals[1]) / inside.dot(self.normals[1]);
        let r2 = self.apex - r;
        let e = (ior * r2.sin()).asin();
        let towards = e.cos() * self.normals[1] + e.sin() * self.faces[1];
        let first = fresnel_dielectric(i.cos(), ior);
        let second = fresnel_dielectric(r2.cos(), 1.0 / ior);
        PrismRay {
            exit: entry + t * inside,
            towards,
            deviation: i + e - self.apex,
            transmittance: (1.0 - first) * (1.0 - second),
            widening: r.cos() / i.cos() * e.cos() / r2.cos(),
        }
    }

    /// A beam of this width at incidence i, and a lamp at distance `far` that begins where light
    /// of index `ior` arrives and reaches over `size` towards larger deviations.
    fn scene(&self, glass: &str, i: f64, ior: f64, width: f64, [far, size]: [f64; 2]) -> Text {
        let space = |p: DVec2| DVec3::new(p.x, 0.0, p.y);
        let (entry, towards) = self.entry(i);
        let ray = self.trace(i, ior);
        // Deviation turns clockwise in (x, z).
        let aside = space(DVec2::new(ray.towards.y, -ray.towards.x));
        let edge = space(ray.exit + far * ray.towards);
        let [a, b] = self.faces.map(space);
        let half = size / 2.0 * aside;
        Text::upright(space(entry - towards), space(towards), DVec3::Y, width)
            .depth(3)
            .double()
            .material("glass", &format!("glass = {glass}"))
            .material("lamp", "emit = 1, sides = \"both\"")
            .block("glass", [0.5 * a, DVec3::Y, 0.5 * b], 0.5 * (a + b))
            .rectangle("lamp", half, size * DVec3::Y, edge + half)
    }
}

fn prism() -> Vec<Case> {
    let t = truth("prism");
    let setup = &t["setup"];
    let name = setup["glass"].as_str().unwrap();
    let index = named_glass(name).unwrap();
    let prism = Prism::new(t.of("apex_deg").to_radians());
    let incidence = t.of("i_deg");
    let mut cases = Vec::new();
    for row in t.rows("rows") {
        let (nm, ior) = (number(&row["nm"]), number(&row["n"]));
        agree(index.n(nm), ior);
        let minimum = number(&row["i_min_deg"]);
        for (key, degrees) in [("d_deg", incidence), ("dmin_deg", minimum)] {
            let Some(exact) = row[key].as_f64() else {
                continue;
            };
            let i = degrees.to_radians();
            let ray = prism.trace(i, ior);
            agree(ray.deviation.to_degrees(), exact);
            let (width, far) = (1e-3, 10.0);
            let glass = format!("{{ ior = {ior:?} }}");
            let scene = prism.scene(&glass, i, ior, width, [far, 0.2]);
            // Degrees at the lamp's distance over the width of the beam.
            let spread = (ray.widening * width / far).to_degrees();
            let name = format!("prism {nm} nm {key}");
            let offset = (exact / spread - 0.5) * ray.transmittance;
            let case = Case::new(name, scene, exact);
            cases.push(case.mapped(offset, spread / ray.transmittance));
        }
    }
    // With dispersion: shorter wavelengths than the one that the lamp begins at find it.
    let i = incidence.to_radians();
    for row in t.rows("rows") {
        let (nm, ior) = (number(&row["nm"]), number(&row["n"]));
        let scene = prism.scene(&format!("\"{name}\""), i, ior, 1e-6, [50.0, 30.0]);
        let lit = until(nm, |nm| prism.trace(i, index.n(nm)).transmittance);
        // At the violet end nothing but a thousandth of Y is left.
        if row["d_deg"].is_f64() && lit[1] > 0.01 {
            let name = format!("prism dispersive up to {nm} nm");
            cases.push(Case::new(name, scene, lit[1]));
        }
    }
    cases
}

/// One ray of the primary bow of the unit sphere, in the plane: in at height x, out at `exit`.
struct BowRay {
    exit: DVec2,
    towards: DVec2,
    weight: f64,
}

/// Coordinates (x, z); the ray comes along +z.
fn bow(x: f64, ior: f64) -> BowRay {
    let i = x.asin();
    let r = (x / ior).asin();
    let turned = |angle: f64, v: DVec2| {
        let (sine, cosine) = angle.sin_cos();
        DVec2::new(v.x * cosine - v.y * sine, v.x * sine + v.y * cosine)
    };
    // Every chord turns the point by π − 2r; refraction and reflection turn the ray by i − r,
    // π − 2r and i − r.
    let entry = DVec2::new(x, -(1.0 - x * x).sqrt());
    let exit = turned(2.0 * (PI - 2.0 * r), entry);
    let towards = turned(2.0 * (i - r) + PI - 2.0 * r, DVec2::Y);
    let outer = fresnel_dielectric(i.cos(), ior);
    let inner = fresnel_dielectric(r.cos(), 1.0 / ior);
    let weight = (1.0 - outer) * inner * (1.0 - inner);
    BowRay {
        exit,
        towards,
        weight,
    }
}

/// A lamp at distance `FAR` that covers deviations from `from` to `to`.
struct BowLamp {
    centre: DVec2,
    along: DVec2,
    half: f64,
}

const FAR: f64 = 1e4;

impl BowLamp {
    fn new(from: f64, to: f64) -> Self {
        let at = |d: f64| DVec2::new(-d.sin(), d.cos());
        let middle = (from + to) / 2.0;
        Self {
            centre: FAR * at(middle),
            along: at(middle + FRAC_PI_2),
            half: FAR * ((to - from) / 2.0).tan(),
        }
    }

    fn lit(&self, ray: &BowRay) -> bool {
        let normal = self.centre / FAR;
        let t = (self.centre - ray.exit).dot(normal) / ray.towards.dot(normal);
        let at = ray.exit + t * ray.towards - self.centre;
        t > 0.0 && at.dot(self.along).abs() <= self.half
    }
}

/// Impact parameters looked at, about that of the bow.
const BOW_WIDTH: f64 = 0.1;
/// The lamp ends this far beyond the bow, radians.
const BEYOND: f64 = 0.005;
/// Relative change of the mean with D, rad⁻¹, below which it says too little: half of what a
/// single wavelength's square root has. Where redder light has long filled the row it is less.
const SHARPEST: f64 = 0.25 / BEYOND;
/// Pixels along the row.
const ROW: u32 = 128;

/// A row of pixels across the impact parameters about `x`, on sphere and lamp.
pub fn bow_scene(glass: &str, x: f64, lamp: [f64; 2]) -> Text {
    let lamp = BowLamp::new(lamp[0], lamp[1]);
    let space = |p: DVec2| DVec3::new(p.x, 0.0, p.y);
    let from = DVec3::new(x, 0.0, -2.0);
    let (row, along) = (f64::from(ROW), lamp.half * space(lamp.along));
    Text::upright(from, DVec3::Z, DVec3::Y, BOW_WIDTH / row)
        .size([ROW, 1])
        .depth(4)
        .double()
        .material("glass", &format!("glass = {glass}"))
        .material("lamp", "emit = 1, sides = \"both\"")
        .object("sphere = {}", "glass")
        .rectangle("lamp", along, FAR * DVec3::Y, space(lamp.centre))
}

/// Incidence and deviation of the bow (Descartes).
pub fn descartes(ior: f64) -> (f64, f64) {
    let i = ((ior * ior - 1.0) / 3.0).sqrt().acos();
    (i, PI + 2.0 * i - 4.0 * (i.sin() / ior).asin())
}

/// Mean of the row by the midpoint rule.
fn bow_mean(ior: f64, x: f64, lamp: &BowLamp, steps: u32) -> f64 {
    let sum: f64 = (0..steps)
        .map(|i| x + BOW_WIDTH * ((f64::from(i) + 0.5) / f64::from(steps) - 0.5))
        .filter(|x| *x < 1.0)
        .map(|x| bow(x, ior))
        .filter(|ray| lamp.lit(ray))
        .map(|ray| ray.weight)
        .sum();
    sum / f64::from(steps)
}

/// Mean of the row through dispersing glass, n = a + b/λ² with λ in µm, in units of Y.
fn dispersed_bow_mean([a, b]: [f64; 2], x: f64, lamp: &BowLamp) -> f64 {
    const STEP: f64 = 2.0;
    let nodes: Vec<f64> = (0..=((NM_MAX - NM_MIN) / STEP) as u32)
        .map(|i| (NM_MIN + STEP * f64::from(i)) / 1000.0)
        .map(|micrometres| bow_mean(a + b / (micrometres * micrometres), x, lamp, 2000))
        .collect();
    over_wavelengths(|nm| {
        let position = (nm - NM_MIN) / STEP;
        let i = (position as usize).min(nodes.len() - 2);
        nodes[i] + (nodes[i + 1] - nodes[i]) * (position - i as f64)
    })[1]
}

/// Mean of the row for a lamp between two deviations.
type BowMean<'a> = dyn Fn([f64; 2]) -> f64 + 'a;

/// The lamp covers deviations from three degrees short of the bow, where nothing can go, to
/// [`BEYOND`] past it: the less of the row arrives there the larger the least deviation D, and by
/// the closed form the mean tells D in degrees. `robust` looks at the side where nothing can go.
fn rainbow() -> Vec<Case> {
    let t = truth("rainbow");
    let [a, b] = numbers(&t["setup"]["cauchy"])[..] else {
        panic!()
    };
    let mut cases = Vec::new();
    for row in t.rows("rows") {
        let (nm, ior) = (number(&row["nm"]), number(&row["n"]));
        agree(a + b / (nm / 1000.0).powi(2), ior);
        let (i, deviation) = descartes(ior);
        let exact = number(&row["D_deg"]);
        agree(i.to_degrees(), number(&row["i_deg"]));
        agree(deviation.to_degrees(), exact);
        let x = i.sin();
        let lamp = |shift: f64| [deviation - 0.05 + shift, deviation + BEYOND + shift];
        let plain = |[from, to]: [f64; 2]| bow_mean(ior, x, &BowLamp::new(from, to), 200_000);
        let dispersed =
            |[from, to]: [f64; 2]| dispersed_bow_mean([a, b], x, &BowLamp::new(from, to));
        let cauchy = format!("{{ cauchy = [{a:?}, {b:?}] }}");
        let kinds: [(&str, String, f64, &BowMean<'_>); 2] = [
            ("", format!("{{ ior = {ior:?} }}"), 5e-5, &plain),
            (" dispersive", cauchy, 2e-4, &dispersed),
        ];
        for (kind, glass, wanted, expected) in kinds {
            // Moving the lamp's end by ±h moves the mean as moving D by ∓h does.
            let h = 2e-4;
            let mean = expected(lamp(0.0));
            let slope = (expected(lamp(h)) - expected(lamp(-h))) / (2.0 * h).to_degrees();
            if slope.to_degrees() < SHARPEST * mean {
                continue;
            }
            let scene = bow_scene(&glass, x, lamp(0.0));
            let case = Case::new(format!("rainbow{kind} {nm} nm"), scene, exact)
                .mapped(-mean - exact * slope, -1.0 / slope)
                .wanted(wanted)
                .systematic(1e-5);
            cases.push(case);
        }
    }
    cases
}

fn coated_diffuse() -> Vec<Case> {
    let t = truth("coated_diffuse");
    let [ior, rho, lenv] = t.all(["n", "rho", "Lenv"]);
    let (outer, inner) = (t.exact("r_e"), t.exact("r_i"));
    agree(1.0 - (1.0 - outer) / (ior * ior), inner);
    // 4000 times as wide as high: light that leaves the base farther out than that by its first
    // way up and down is (1/4000)² of it.
    let look = |degrees: f64, rho: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let towards = DVec3::new(sine, 0.0, -cosine);
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        Text::orthographic(z - towards, towards, 0.1)
            .double()
            .material("glass", &format!("glass = {{ ior = {ior:?} }}"))
            .material("base", &format!("diffuse = {rho:?}"))
            .block("glass", [2000.0 * x, 2000.0 * y, 0.5 * z], 0.5 * z)
            .rectangle("base", 1999.0 * x, 1999.0 * y, 1e-3 * z)
            .environment(lenv)
    };
    let mut cases = Vec::new();
    let exact = numbers(&t["exact"]["L"]);
    for (degrees, exact) in numbers(&t["setup"]["theta_deg"]).into_iter().zip(exact) {
        let r = fresnel_dielectric(degrees.to_radians().cos(), ior);
        let base = rho * (1.0 - outer) / (ior * ior * (1.0 - rho * inner));
        agree(lenv * (r + (1.0 - r) * base), exact);
        let name = format!("coated_diffuse {degrees}°");
        cases.push(Case::new(name, look(degrees, rho), exact).systematic(1e-6));
        let name = format!("coated_diffuse white {degrees}°");
        cases.push(Case::new(name, look(degrees, 1.0), lenv).systematic(1e-5));
    }
    cases
}
