//! Lights: directions follow their densities, densities integrate to 1 over what can be seen, both
//! strategies see the same density to the bit, and irradiances match closed forms.
//!
//! False alarms: this module's random tests share the family level 1e-4 (Šidák over the number
//! made), seeds are fixed and nothing is tried twice.

use std::f64::consts::PI;

use etalon::Instructions;
use etalon::inside::light::{
    CubeLight, CylinderLight, LightShape, MappedLight, PlanarLight, PointLight, RectangleLight,
    SphereLight, WithoutSurface,
};
use etalon::inside::math::affine::Affine;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::shape::{Placed, Ray, ShapeKind, Start, Tally};
use etalon::inside::stats::family::sidak;
use etalon_doors::Made;
use etalon_doors::lights::{AnyLight, LightSample, light_densities, light_samples};
use glam::{DMat3, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::lanes_support::{PRECISIONS, Precision, on_each, same_bits};
use crate::sampling::{evenness, turn};
use crate::statistics_support::{chi_square, moments, t_test};
use crate::truth_file::{number, truth, vector};

/// Level of all random tests of this module together.
const FAMILY: f64 = 1e-4;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Rectangle,
    Parallelogram,
    Disk,
    Sphere,
    Cube,
    Cylinder,
    Ellipsoid,
    /// A cylinder under any map.
    Barrel,
    Point,
}

/// A canonical shape, of half width or radius 1, whose axes are mapped to these.
#[derive(Debug, Clone, Copy)]
struct Light {
    kind: Kind,
    centre: DVec3,
    axes: [DVec3; 3],
}

impl Light {
    fn new(kind: Kind, centre: DVec3, axes: [DVec3; 3]) -> Self {
        Self { kind, centre, axes }
    }

    fn flat(kind: Kind, centre: DVec3, [a, b]: [DVec3; 2]) -> Self {
        Self::new(kind, centre, [a, b, a.cross(b).normalize()])
    }

    fn sphere(centre: DVec3, radius: f64) -> Self {
        Self::new(Kind::Sphere, centre, DVec3::AXES.map(|axis| radius * axis))
    }

    fn shape(&self) -> ShapeKind {
        match self.kind {
            Kind::Rectangle | Kind::Parallelogram => ShapeKind::Rectangle,
            Kind::Disk => ShapeKind::Disk,
            Kind::Sphere | Kind::Ellipsoid | Kind::Point => ShapeKind::Sphere,
            Kind::Cube => ShapeKind::Cube,
            Kind::Cylinder | Kind::Barrel => ShapeKind::Cylinder,
        }
    }

    fn build<T: Scalar>(&self) -> LightShape<T> {
        let (centre, both) = (self.centre, [true, true]);
        let [a, b, c] = self.axes;
        match self.kind {
            Kind::Rectangle => LightShape::Rectangle(RectangleLight::new(centre, [a, b], c, both)),
            Kind::Parallelogram => {
                LightShape::Planar(PlanarLight::new(centre, [a, b], c, false, both))
            }
            Kind::Disk => LightShape::Planar(PlanarLight::new(centre, [a, b], c, true, both)),
            Kind::Sphere => LightShape::Sphere(SphereLight::new(centre, a.length(), both)),
            Kind::Cube => {
                let normals = cube_normals(self.axes);
                LightShape::Cube(CubeLight::new(centre, self.axes, normals, both))
            }
            Kind::Cylinder => LightShape::Cylinder(CylinderLight::new(centre, [a, b], c, both)),
            Kind::Ellipsoid => {
                LightShape::Mapped(MappedLight::ellipsoid(centre, self.linear(), both))
            }
            Kind::Barrel => LightShape::Mapped(MappedLight::cylinder(centre, self.linear(), both)),
            Kind::Point => LightShape::Point(PointLight::new(centre)),
        }
    }

    fn linear(&self) -> DMat3 {
        let [a, b, c] = self.axes;
        DMat3::from_cols(a, b, c)
    }

    /// What comes of it in a precision.
    fn ask<R>(&self, precision: Precision, ask: impl Fn(AnyLight) -> R) -> R {
        match precision {
            Precision::Single => ask(Made::Single(&self.build())),
            Precision::Double => ask(Made::Double(&self.build())),
        }
    }

    /// The same surface as rays meet it.
    fn placed(&self) -> Placed {
        let [a, b, c] = self.axes;
        let row = |i: usize| [a[i], b[i], c[i], self.centre[i]];
        let rows = [0, 1, 2].map(row);
        Placed::new(self.shape(), &Affine { rows }).unwrap()
    }

    /// The outward normal at the light's point nearest to `at`, roughly: which face of a cube.
    fn normal_near(&self, at: DVec3) -> DVec3 {
        let inverse = self.linear().inverse();
        let q = inverse * (at - self.centre);
        let normal = match self.shape() {
            ShapeKind::Sphere => q,
            ShapeKind::Cylinder if q.truncate().length() > q.z.abs() => q.with_z(0.0),
            ShapeKind::Cylinder => DVec3::Z * q.z.signum(),
            ShapeKind::Cube => {
                let axis = q.abs().max_position();
                DVec3::AXES[axis] * q[axis].signum()
            }
            _ => DVec3::Z,
        };
        (inverse.transpose() * normal).normalize()
    }
}

/// The first crossing of a ray: distance and outward normal.
fn hit(placed: &Placed, origin: DVec3, direction: DVec3) -> Option<(f64, DVec3)> {
    let ray = Ray { origin, direction };
    let hit = placed.first_hit(&ray, 0.0, Start::Free, &mut Tally::default())?;
    Some((hit.t, hit.normal))
}

fn cube_normals(half: [DVec3; 3]) -> [DVec3; 3] {
    [0, 1, 2].map(|i| {
        let n = half[(i + 1) % 3].cross(half[(i + 2) % 3]).normalize();
        n * n.dot(half[i]).signum()
    })
}

fn rounded(precision: Precision, v: DVec3) -> DVec3 {
    v.to_array().map(|x| precision.rounded(x)).into()
}

/// Samples of a light from p.
fn draw(
    set: Instructions,
    precision: Precision,
    (light, p): (Light, DVec3),
    variates: &[[f64; 2]],
) -> Vec<LightSample> {
    // Below 1 in this precision, too.
    let most = 1.0 - 2.0 * precision.roundoff();
    let variates: Vec<_> = variates.iter().map(|uv| uv.map(|x| x.min(most))).collect();
    light.ask(precision, |light| light_samples(set, light, p, &variates))
}

/// The same on the best instruction set.
fn best(precision: Precision, from: (Light, DVec3), variates: &[[f64; 2]]) -> Vec<LightSample> {
    draw(Instructions::best(), precision, from, variates)
}

/// The densities that scattered rays of the very directions of samples would be given, their hits'
/// normals being some units of roundoff off.
fn asked(
    set: Instructions,
    precision: Precision,
    (light, p): (Light, DVec3),
    samples: &[LightSample],
) -> Vec<f64> {
    let start = rounded(precision, p);
    let hit = |sample: &LightSample| {
        // Found in f64 for the rounded direction.
        let near = start + sample.distance * sample.direction;
        let normal = light.normal_near(near) * (1.0 + 3.0 * precision.roundoff());
        (sample.direction, normal)
    };
    let hits: Vec<_> = samples.iter().map(hit).collect();
    light.ask(precision, |light| light_densities(set, light, p, &hits))
}

/// Jittered n × n variates.
fn variates(rng: &mut Pcg64Mcg, n: usize) -> Vec<[f64; 2]> {
    let cells = (0..n * n).map(|k| [k / n, k % n]);
    cells
        .map(|cell| cell.map(|i| (i as f64 + rng.random::<f64>()) / n as f64))
        .collect()
}

fn independent(rng: &mut Pcg64Mcg, n: usize) -> Vec<[f64; 2]> {
    (0..n).map(|_| rng.random()).collect()
}

/// Lights with receivers: near, far, grazing, on the axis, in the plane's neighbourhood, inside.
fn settings() -> Vec<(Light, Vec<DVec3>)> {
    let centre = DVec3::new(0.3, -0.2, 0.5);
    let half = [DVec3::new(1.2, 0.3, 0.1), DVec3::new(-0.2, 0.7, 0.3)];
    let upright = half[1] - half[0] * half[0].dot(half[1]) / half[0].length_squared();
    let normal = half[0].cross(half[1]).normalize();
    let flat = vec![
        centre + 0.4 * normal,
        centre - 1.5 * normal + 0.5 * half[0],
        centre + 0.05 * normal + 0.9 * half[1],
        // Beyond the edge and hardly above the plane.
        centre + 0.02 * normal + 2.0 * half[0],
        centre + 1e-3 * normal - 1.5 * half[1],
        centre + 40.0 * normal + 10.0 * half[0],
        centre - 3.0 * normal + 2.5 * half[1],
    ];
    let radius = 0.7;
    let sphere = [1.02, 1.5, 4.0, 60.0, 0.0, 0.3, 0.9, 0.99]
        .map(|d| centre + d * radius * DVec3::new(0.6, -0.48, 0.64))
        .to_vec();
    let sides = [
        DVec3::new(0.5, 0.1, 0.0),
        DVec3::new(-0.1, 0.8, 0.2),
        DVec3::new(0.05, -0.1, 0.3),
    ];
    let at =
        |[x, y, z]: [f64; 3], axes: [DVec3; 3]| centre + x * axes[0] + y * axes[1] + z * axes[2];
    // Seen: one face, two, three; from far; grazing; from inside.
    let cube = [
        [0.2, 0.1, 3.0],
        [2.5, 0.1, 2.0],
        [2.0, 2.0, 2.0],
        [-30.0, 20.0, 10.0],
        [1.01, 2.5, 0.0],
        [0.3, -0.2, 0.6],
        [0.0, 0.0, 0.98],
    ];
    let cube = cube.map(|place| at(place, sides)).to_vec();
    let long = 0.6 * normal.cross(half[0]).normalize();
    let round = [0.4 * half[0].normalize(), 0.4 * normal, long];
    // Seen: the side, a cap, both; from far; grazing a cap; from inside, and on the axis.
    let about_a_tube = |axes: [DVec3; 3], above: f64| {
        let places = [
            [2.0, 1.0, 0.3],
            [0.3, -0.2, -2.5],
            [-1.5, 2.0, 1.8],
            [30.0, -50.0, 40.0],
            [2.5, 0.3, above],
            [0.4, 0.5, -0.6],
            [0.0, 0.0, 0.9],
        ];
        places.map(|place| at(place, axes)).to_vec()
    };
    let ellipsoid = [1.05, 1.5, 4.0, 60.0, 0.0, 0.3, 0.9, 0.98]
        .map(|d| at([0.6 * d, -0.48 * d, 0.64 * d], sides))
        .to_vec();
    let flat_light = |kind, half| Light::flat(kind, centre, half);
    let light = |kind, axes| Light::new(kind, centre, axes);
    let upright = [half[0], upright];
    vec![
        (flat_light(Kind::Rectangle, upright), flat.clone()),
        (flat_light(Kind::Parallelogram, half), flat.clone()),
        (flat_light(Kind::Disk, half), flat),
        (Light::sphere(centre, radius), sphere),
        (light(Kind::Cube, sides), cube),
        (light(Kind::Cylinder, round), about_a_tube(round, 1.01)),
        (light(Kind::Ellipsoid, sides), ellipsoid),
        (light(Kind::Barrel, sides), about_a_tube(sides, 1.02)),
    ]
}

/// The same, a receiver at a time.
fn pairs() -> impl Iterator<Item = (Light, DVec3)> {
    let settings = settings().into_iter();
    settings.flat_map(|(light, receivers)| receivers.into_iter().map(move |p| (light, p)))
}

#[test]
fn both_strategies_see_the_same_density() {
    let mut rng = Pcg64Mcg::seed_from_u64(21);
    for precision in PRECISIONS {
        for (light, p) in pairs() {
            let variates = variates(&mut rng, 64);
            let drawn = best(precision, (light, p), &variates);
            let asked = asked(Instructions::best(), precision, (light, p), &drawn);
            for (sample, asked) in drawn.iter().zip(asked) {
                assert!(sample.valid && sample.pdf > 0.0, "{light:?} {p} {sample:?}");
                // Not within 1e-5 of each other but equal: they are the same function.
                let same = same_bits(sample.pdf, asked);
                assert!(same, "{precision:?} {light:?} {p} {sample:?} {asked}");
            }
        }
    }
}

#[test]
fn densities_are_those_of_the_geometry() {
    let mut rng = Pcg64Mcg::seed_from_u64(22);
    for precision in PRECISIONS {
        let u = precision.roundoff();
        let mut worst = 0.0_f64;
        for (light, p) in pairs() {
            // The others have tests of their own integrals.
            let area = match light.kind {
                Kind::Parallelogram => 4.0,
                Kind::Disk => PI,
                _ => continue,
            } * light.axes[0].cross(light.axes[1]).length();
            let (placed, p) = (light.placed(), rounded(precision, p));
            let variates = variates(&mut rng, 32);
            for sample in best(precision, (light, p), &variates) {
                let Some((t, normal)) = hit(&placed, p, sample.direction.normalize()) else {
                    // Rounded past the edge.
                    continue;
                };
                let cosine = normal.dot(sample.direction).abs();
                let expected = t * t / cosine / area;
                // Rounding a direction by u moves cos by as much; the height of a plane is good to
                // u of the distance.
                let allowed = 20.0 * u * (1.0 + 4.0 / cosine);
                let error = (sample.pdf / expected - 1.0).abs();
                worst = worst.max(error / allowed);
                let off = (sample.distance / t - 1.0).abs();
                assert!(off <= allowed, "{sample:?} {t}");
            }
        }
        println!("{precision:?}: densities within {worst} of what is allowed");
        assert!(worst <= 1.0);
    }
}

/// Equal-area bins of the sphere of directions about an axis.
struct Bins {
    axis: [DVec3; 3],
    /// 1 − cos of the cone covered.
    height: f64,
}

impl Bins {
    /// Rows, and columns of each.
    const SIDE: usize = 12;

    fn about(axis: DVec3, height: f64) -> Self {
        let z = axis.normalize();
        let x = z.any_orthonormal_vector();
        let axis = [x, z.cross(x), z];
        Self { axis, height }
    }

    fn of(&self, direction: DVec3) -> Option<usize> {
        let [x, y, z] = self.axis.map(|a| a.dot(direction));
        let h = (x * x + y * y) / (1.0 + z);
        let row = (h / self.height * Self::SIDE as f64).floor();
        if row >= Self::SIDE as f64 {
            return None;
        }
        let column = ((turn(x, y) * Self::SIDE as f64) as usize).min(Self::SIDE - 1);
        Some(row as usize * Self::SIDE + column)
    }

    /// A direction by equal-area coordinates in [0, 1)².
    fn direction(&self, u: f64, v: f64) -> DVec3 {
        let h = u * self.height;
        let sine = (h * (2.0 - h)).max(0.0).sqrt();
        let angle = (v - 0.5) * 2.0 * PI;
        self.axis[0] * (sine * libm::cos(angle))
            + self.axis[1] * (sine * libm::sin(angle))
            + self.axis[2] * (1.0 - h)
    }
}

/// The integral of the density over solid-angle bins, by an n × n midpoint rule in each, and the
/// p-value of χ² of drawn directions against it, whose density may have been bent by `bend`.
fn verdict(
    (light, p): (Light, DVec3),
    rng: &mut Pcg64Mcg,
    precision: Precision,
    bend: impl Fn([f64; 2]) -> [f64; 2],
) -> (f64, f64) {
    let samples: Vec<[f64; 2]> = independent(rng, 40_000).into_iter().map(bend).collect();
    let drawn = best(precision, (light, p), &samples);
    let axis: DVec3 = drawn.iter().map(|s| s.direction).sum();
    let axis = axis.try_normalize().unwrap_or(DVec3::Z);
    // A cone that covers every direction to the light.
    let cosines = drawn.iter().map(|s| s.direction.dot(axis));
    let farthest = cosines.fold(1.0, f64::min);
    let bins = Bins::about(axis, ((1.0 - farthest) * 1.05 + 1e-6).min(2.0));
    let fine = 40;
    let side = Bins::SIDE * fine;
    let placed = light.placed();
    let cell = |k: usize| {
        let (i, j) = (k / side, k % side);
        let middle = |i: usize| (i as f64 + 0.5) / side as f64;
        let direction = bins.direction(middle(i), middle(j));
        let (_, normal) = hit(&placed, p, direction)?;
        let place = i / fine * Bins::SIDE + j / fine;
        Some((place, (direction, normal)))
    };
    let cells = (0..side * side).into_par_iter().filter_map(cell);
    let (places, directions): (Vec<usize>, Vec<(DVec3, DVec3)>) = cells.unzip();
    let densities = light.ask(Precision::Double, |light| {
        light_densities(Instructions::best(), light, p, &directions)
    });
    let area = 2.0 * PI * bins.height / (side * side) as f64;
    let mut expected = vec![0.0; Bins::SIDE * Bins::SIDE];
    for (&place, &pdf) in places.iter().zip(&densities) {
        expected[place] += pdf * area;
    }
    let integral: f64 = expected.iter().sum();
    let mut counts = vec![0; expected.len()];
    for bin in drawn.iter().filter_map(|sample| bins.of(sample.direction)) {
        counts[bin] += 1;
    }
    let total: u64 = counts.iter().sum();
    for e in &mut expected {
        // The quadrature may miss a sliver at the outline.
        *e = (*e * total as f64 / integral).max(1e-9);
    }
    let sum: f64 = expected.iter().sum();
    for e in &mut expected {
        *e *= total as f64 / sum;
    }
    (integral, chi_square(&counts, &expected))
}

/// Receivers for which the density is smooth enough for midpoint quadrature: not within a tenth
/// of a size of the light's plane, where 1/cos³ spans decades.
fn tame() -> Vec<(Light, DVec3)> {
    let tame = |(light, receivers): (Light, Vec<DVec3>)| {
        let grazing = match light.shape() {
            ShapeKind::Sphere => 0..0,
            ShapeKind::Cube | ShapeKind::Cylinder => 4..5,
            _ => 2..5,
        };
        let receivers = receivers.into_iter().enumerate();
        receivers.filter_map(move |(i, p)| (!grazing.contains(&i)).then_some((light, p)))
    };
    settings().into_iter().flat_map(tame).collect()
}

#[test]
fn directions_follow_their_densities_which_integrate_to_one() {
    let mut rng = Pcg64Mcg::seed_from_u64(23);
    let settings = tame();
    let level = sidak(FAMILY / 2.0, 2 * settings.len());
    for precision in PRECISIONS {
        for &(light, p) in &settings {
            let (integral, p_value) = verdict((light, p), &mut rng, precision, |uv| uv);
            println!("{precision:?} {light:?} {p}: ∫ = {integral:.5}, p = {p_value:.3}");
            // The outline cuts cells of the quadrature: about 480 steps across.
            assert!((integral - 1.0).abs() < 0.01, "{light:?} {p}: {integral}");
            assert!(p_value > level, "{light:?} {p}: {p_value:e}");
        }
    }
}

#[test]
fn a_bent_map_is_noticed() {
    let mut rng = Pcg64Mcg::seed_from_u64(24);
    for (light, receivers) in settings() {
        // A density tilted by ±10 % from one edge to the other.
        let bend = |[u, v]: [f64; 2]| [u, v + 0.1 * v * (1.0 - v)];
        let (_, p) = verdict((light, receivers[0]), &mut rng, Precision::Double, bend);
        println!("{light:?}: bent p = {p:e}");
        assert!(p < 1e-5, "{light:?}");
    }
}

#[test]
fn grazing_receivers_see_all_of_a_flat_light_alike() {
    let mut rng = Pcg64Mcg::seed_from_u64(27);
    // By area, the points themselves are uniform, however grazing the view.
    let level = sidak(FAMILY / 10.0, 40);
    for precision in PRECISIONS {
        for (light, p) in pairs() {
            if !matches!(light.kind, Kind::Parallelogram | Kind::Disk) {
                continue;
            }
            let inverse = light.linear().inverse();
            let variates = independent(&mut rng, 20_000);
            let drawn = best(precision, (light, p), &variates);
            let places = drawn.iter().map(|sample| {
                let at = p + sample.distance * sample.direction - light.centre;
                let [x, y, _] = (inverse * at).to_array();
                match light.kind {
                    Kind::Disk => (x * x + y * y, turn(x, y)),
                    _ => ((x + 1.0) / 2.0, (y + 1.0) / 2.0),
                }
            });
            let p_value = evenness::<12>(places);
            assert!(p_value > level, "{light:?} {p}: {p_value:e}");
        }
    }
}

/// The solid angle of a rectangle by van Oosterom and Strackee's formula for two triangles.
fn solid_angle(p: DVec3, centre: DVec3, half: [DVec3; 2]) -> f64 {
    let corner = |x: f64, y: f64| centre + x * half[0] + y * half[1] - p;
    let triangle = |a: DVec3, b: DVec3, c: DVec3| {
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let bottom = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
        2.0 * libm::atan2(a.dot(b.cross(c)).abs(), bottom)
    };
    let (a, c) = (corner(-1.0, -1.0), corner(1.0, 1.0));
    triangle(a, corner(1.0, -1.0), c) + triangle(a, c, corner(-1.0, 1.0))
}

#[test]
fn a_rectangle_knows_its_solid_angle() {
    let mut rng = Pcg64Mcg::seed_from_u64(25);
    // What the threshold in rectangle.rs promises: four angles to a quarter unit of 1 each.
    for (precision, allowed) in [(Precision::Single, 7.5e-5), (Precision::Double, 2e-13)] {
        let mut worst = 0.0_f64;
        let mut near = 0;
        for _ in 0..4_000 {
            let half = [DVec3::X, DVec3::Y].map(|axis| axis * rng.random_range(0.05..2.0));
            let centre = DVec3::ZERO;
            let p = DVec3::new(
                rng.random_range(-3.0..3.0),
                rng.random_range(-3.0..3.0),
                libm::exp2(rng.random_range(-12.0..2.0)),
            );
            let p = rounded(precision, p);
            let half = half.map(|h| rounded(precision, h));
            let light = Light::flat(Kind::Rectangle, centre, half);
            // Two directions of different area density tell whether it is uniform.
            let directions = [
                ((centre - p).normalize(), DVec3::Z),
                ((centre + half[0] + half[1] - p).normalize(), DVec3::Z),
            ];
            let pdf = light.ask(precision, |light| {
                light_densities(Instructions::best(), light, p, &directions)
            });
            if pdf[0] != pdf[1] {
                continue;
            }
            near += 1;
            worst = worst.max((pdf[0] * solid_angle(p, centre, half) - 1.0).abs());
        }
        println!("{precision:?}: solid angle within {worst:e} of {near} receivers");
        assert!(near > 1_000 && worst <= allowed, "{worst:e}");
    }
}

/// Estimates of the irradiance at p with normal n from 64 replicates of jittered samples.
fn irradiances(light: Light, (p, n): (DVec3, DVec3), precision: Precision, seed: u64) -> Vec<f64> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut estimate = || {
        let drawn = best(precision, (light, p), &variates(&mut rng, 48));
        let valid = drawn.iter().filter(|s| s.valid);
        let sum: f64 = valid.map(|s| s.direction.dot(n).max(0.0) / s.pdf).sum();
        sum / drawn.len() as f64
    };
    (0..64).map(|_| estimate()).collect()
}

/// Every closed form: light, receiver with normal, irradiance for radiance 1.
fn closed_forms() -> Vec<(String, Light, (DVec3, DVec3), f64)> {
    let mut all = Vec::new();
    let upward = (DVec3::ZERO, DVec3::Z);
    for id in ["polygon_light", "polygon_light_horizon"] {
        let t = truth(id);
        let setup = &t["setup"];
        let v = [0, 1, 3].map(|i| vector(&setup["V"][i]));
        let half = [(v[1] - v[0]) / 2.0, (v[2] - v[0]) / 2.0];
        let centre = v[0] + half[0] + half[1];
        let at = (vector(&setup["P"]), vector(&setup["N"]));
        let irradiance = t.exact("E") / t.of("Le");
        assert!(half[0].dot(half[1]).abs() < 1e-12);
        // The same light as two far smaller ones would be is left to the picture's own tests.
        for kind in [Kind::Parallelogram, Kind::Rectangle] {
            let light = Light::flat(kind, centre, half);
            all.push((format!("{id}, {kind:?}"), light, at, irradiance));
        }
    }
    let t = truth("sphere_light");
    for row in t.rows("per_angle") {
        let beta = number(&row["beta_deg"]).to_radians();
        let centre = t.of("d") * DVec3::new(libm::sin(beta), 0.0, libm::cos(beta));
        let light = Light::sphere(centre, t.of("r"));
        let irradiance = number(&row["E"]) / t.of("Le");
        let name = format!("sphere_light {}°", row["beta_deg"]);
        all.push((name, light, upward, irradiance));
    }
    let t = truth("disk_light");
    for row in t.rows("per_offset") {
        let centre = DVec3::new(number(&row["a"]), 0.0, t.of("h"));
        let half = [DVec3::X, DVec3::Y].map(|axis| axis * t.of("r"));
        let irradiance = number(&row["E"]) / t.of("Le");
        let name = format!("disk_light {}", row["a"]);
        let light = Light::flat(Kind::Disk, centre, half);
        all.push((name, light, upward, irradiance));
    }
    // Inside a closed light of radiance 1: π, for any shape.
    let lean = (DVec3::ZERO, DVec3::new(0.6, 0.0, 0.8));
    let block = [
        DVec3::X,
        DVec3::new(0.3, 1.0, 0.0),
        DVec3::new(0.1, 0.2, 1.5),
    ];
    let slim = [block[0], DVec3::new(0.3, 0.6, 0.0), block[2]];
    let tube = [DVec3::X, DVec3::Y, 1.5 * DVec3::Z];
    for (kind, centre, axes, at) in [
        (Kind::Sphere, [0.1, 0.2, -0.3], DVec3::AXES, upward),
        (Kind::Cube, [0.2, 0.1, 0.0], block, upward),
        (Kind::Cylinder, [0.2, 0.1, 0.3], tube, lean),
        (Kind::Ellipsoid, [0.1, 0.1, 0.3], slim, lean),
        (Kind::Barrel, [0.1, 0.1, 0.3], slim, lean),
    ] {
        let light = Light::new(kind, DVec3::from_array(centre), axes);
        all.push((format!("inside, {kind:?}"), light, at, PI));
    }
    // A receiver on the axis sees the near cap alone, a disk: π sin² of its half-angle.
    let light = Light::new(Kind::Cylinder, 3.5 * DVec3::Z, tube);
    all.push(("on the axis of a cylinder".into(), light, upward, PI / 5.0));
    all
}

#[test]
fn irradiances_match_the_closed_forms() {
    let cases = closed_forms();
    let level = sidak(0.4 * FAMILY, 2 * cases.len());
    for precision in PRECISIONS {
        for (k, (name, light, at, irradiance)) in cases.iter().enumerate() {
            let estimates = irradiances(*light, *at, precision, 100 + k as u64);
            let p = t_test(&estimates, *irradiance);
            let (mean, variance) = moments(&estimates);
            let relative = (variance / 64.0).sqrt() / irradiance;
            println!(
                "{precision:?} {name}: {:+.1e} ± {relative:.1e}, p = {p:.3}",
                mean / irradiance - 1.0
            );
            assert!(relative < 2e-3, "{name}: {relative}");
            // Rounding may bias a mean by some units where the noise is smaller than that.
            let rounding = (mean / irradiance - 1.0).abs() < 50.0 * precision.roundoff();
            let right = p > level || rounding;
            assert!(right, "{name}: p = {p:e}, {mean} for {irradiance}");
            // Planted: a density that is a per cent too large.
            let wrong: Vec<f64> = estimates.iter().map(|e| e / 1.01).collect();
            let noticed = t_test(&wrong, *irradiance) < level;
            assert!(noticed, "{name} would not notice 1 %");
        }
    }
}

#[test]
fn points_fall_off_with_the_square() {
    let t = truth("point_light");
    let light = Light::new(Kind::Point, DVec3::Z * t.of("h"), DVec3::AXES);
    for precision in PRECISIONS {
        for row in t.rows("per_point") {
            let p = DVec3::X * number(&row["x"]);
            let drawn = best(precision, (light, p), &[[0.5, 0.5]])[0];
            let irradiance = t.of("I") * drawn.direction.z / drawn.pdf;
            let error = (irradiance / number(&row["E"]) - 1.0).abs();
            assert!(error < 6.0 * precision.roundoff(), "{error:e}");
        }
    }
}

#[test]
fn all_instruction_sets_draw_the_same_bits() {
    let mut rng = Pcg64Mcg::seed_from_u64(26);
    for precision in PRECISIONS {
        for from in pairs() {
            let variates = variates(&mut rng, 8);
            let all = on_each(|set| {
                let samples = draw(set, precision, from, &variates);
                let asked = asked(set, precision, from, &samples);
                samples.into_iter().zip(asked).collect::<Vec<_>>()
            });
            for (name, other) in &all[1..] {
                for ((a, a_asked), (b, b_asked)) in all[0].1.iter().zip(other) {
                    let same = a.valid == b.valid
                        && same_bits(a.pdf, b.pdf)
                        && same_bits(*a_asked, *b_asked)
                        && same_bits(a.distance, b.distance)
                        && a.direction == b.direction;
                    assert!(same, "{name} {:?}: {a:?} {b:?}", from.0);
                }
            }
        }
    }
}
