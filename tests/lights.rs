//! Lights: directions follow their densities, densities integrate to 1 over what can be seen, both
//! strategies see the same density to the bit, and irradiances match closed forms.
//!
//! False alarms: this module's random tests share the family level 1e-4 (Šidák over the number
//! made), seeds are fixed and nothing is tried twice.

#![allow(clippy::unwrap_used, reason = "the truths file is part of the tests")]

use std::f64::consts::PI;

use etalon::Instructions;
use etalon::inside::light::{
    CubeLight, CylinderLight, LightShape, MappedLight, PlanarLight, PointLight, RectangleLight,
    SphereLight, WithoutSurface,
};
use etalon::inside::math::lanes::Scalar;
use etalon_doors::Made;
use etalon_doors::lights::{AnyLight, LightSample, light_densities, light_samples};
use glam::{DMat3, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::lanes_support::{PRECISIONS, Precision, on_each, same_bits};
use crate::statistics_support::{chi_square, t_test};
use crate::truth_file::truth;
use etalon::inside::stats::family::sidak;

/// Level of all random tests of this module together.
const FAMILY: f64 = 1e-4;

#[derive(Debug, Clone, Copy)]
enum Light {
    Rectangle { centre: DVec3, half: [DVec3; 2] },
    Parallelogram { centre: DVec3, half: [DVec3; 2] },
    Disk { centre: DVec3, half: [DVec3; 2] },
    Sphere { centre: DVec3, radius: f64 },
    Cube { centre: DVec3, half: [DVec3; 3] },
    Cylinder { centre: DVec3, half: [DVec3; 3] },
    Ellipsoid { centre: DVec3, half: [DVec3; 3] },
    Barrel { centre: DVec3, half: [DVec3; 3] },
    Point(DVec3),
}

impl Light {
    fn build<T: Scalar>(&self) -> LightShape<T> {
        let both = [true, true];
        match *self {
            Self::Rectangle { centre, half } => {
                let normal = half[0].cross(half[1]).normalize();
                LightShape::Rectangle(RectangleLight::new(centre, half, normal, both))
            }
            Self::Parallelogram { centre, half } => {
                let normal = half[0].cross(half[1]).normalize();
                LightShape::Planar(PlanarLight::new(centre, half, normal, false, both))
            }
            Self::Disk { centre, half } => {
                let normal = half[0].cross(half[1]).normalize();
                LightShape::Planar(PlanarLight::new(centre, half, normal, true, both))
            }
            Self::Sphere { centre, radius } => {
                LightShape::Sphere(SphereLight::new(centre, radius, both))
            }
            Self::Cube { centre, half } => {
                LightShape::Cube(CubeLight::new(centre, half, cube_normals(half), both))
            }
            Self::Cylinder { centre, half } => {
                let [a, b, c] = half;
                LightShape::Cylinder(CylinderLight::new(centre, [a, b], c, both))
            }
            Self::Ellipsoid { centre, half } => {
                LightShape::Mapped(MappedLight::ellipsoid(centre, linear(half), both))
            }
            Self::Barrel { centre, half } => {
                LightShape::Mapped(MappedLight::cylinder(centre, linear(half), both))
            }
            Self::Point(at) => LightShape::Point(PointLight::new(at)),
        }
    }

    /// What comes of it in a precision.
    fn ask<R>(&self, precision: Precision, ask: impl Fn(AnyLight) -> R) -> R {
        match precision {
            Precision::Single => ask(Made::Single(&self.build())),
            Precision::Double => ask(Made::Double(&self.build())),
        }
    }

    /// The canonical shape of a mapped one, with the map.
    fn canonical(&self) -> Option<(Self, DVec3, DMat3)> {
        let zero = DVec3::ZERO;
        match *self {
            Self::Ellipsoid { centre, half } => {
                let sphere = Self::Sphere {
                    centre: zero,
                    radius: 1.0,
                };
                Some((sphere, centre, linear(half)))
            }
            Self::Barrel { centre, half } => {
                let half_axes = [DVec3::X, DVec3::Y, DVec3::Z];
                let cylinder = Self::Cylinder {
                    centre: zero,
                    half: half_axes,
                };
                Some((cylinder, centre, linear(half)))
            }
            _ => None,
        }
    }

    /// First crossing of the ray: distance and outward normal.
    fn hit(&self, p: DVec3, direction: DVec3) -> Option<(f64, DVec3)> {
        let flat = |centre: DVec3, half: [DVec3; 2], inside: &dyn Fn(f64, f64) -> bool| {
            let normal = half[0].cross(half[1]).normalize();
            let t = (centre - p).dot(normal) / direction.dot(normal);
            let at = p + t * direction - centre;
            // Dual axes of a parallelogram.
            let [x, y] = [half[1].cross(normal), normal.cross(half[0])];
            let (x, y) = (at.dot(x) / half[0].dot(x), at.dot(y) / half[1].dot(y));
            (t > 0.0 && inside(x, y)).then_some((t, normal))
        };
        let square = |x: f64, y: f64| x.abs() <= 1.0 && y.abs() <= 1.0;
        match *self {
            Self::Rectangle { centre, half } | Self::Parallelogram { centre, half } => {
                flat(centre, half, &square)
            }
            Self::Disk { centre, half } => flat(centre, half, &|x, y| x * x + y * y <= 1.0),
            Self::Sphere { centre, radius } => {
                let o = p - centre;
                let b = o.dot(direction);
                let foot = o - b * direction;
                let c = radius * radius - foot.length_squared();
                if c < 0.0 {
                    return None;
                }
                let outside = o.length() > radius;
                let t = if outside {
                    -b - c.sqrt()
                } else {
                    -b + c.sqrt()
                };
                (t > 0.0).then(|| (t, (o + t * direction) / radius))
            }
            Self::Cube { centre, half } => {
                let normals = cube_normals(half);
                let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
                let (mut entered, mut left) = (DVec3::ZERO, DVec3::ZERO);
                for axis in 0..3 {
                    let n = normals[axis];
                    let (o, d) = ((p - centre).dot(n), direction.dot(n));
                    let h = half[axis].dot(n);
                    let (t1, t2) = ((-h * d.signum() - o) / d, (h * d.signum() - o) / d);
                    if t1 > near {
                        (near, entered) = (t1, -n * d.signum());
                    }
                    if t2 < far {
                        (far, left) = (t2, n * d.signum());
                    }
                }
                if near > far || far <= 0.0 {
                    None
                } else if near > 0.0 {
                    Some((near, entered))
                } else {
                    Some((far, left))
                }
            }
            Self::Cylinder { centre, half } => {
                let [a, b, c] = half;
                let (radius, height) = (a.length(), c.length());
                let local =
                    |v: DVec3| DVec3::new(v.dot(a) / radius, v.dot(b) / radius, v.dot(c) / height);
                let (o, d) = (local(p - centre), local(direction));
                let (square, linear) = (d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y);
                let rest = linear * linear - square * (o.x * o.x + o.y * o.y - radius * radius);
                let side = [-1.0, 1.0].map(|sign| (-linear + sign * rest.sqrt()) / square);
                let caps = [-1.0, 1.0].map(|sign| (sign * height * d.z.signum() - o.z) / d.z);
                let (near, far) = (side[0].max(caps[0]), side[1].min(caps[1]));
                if rest < 0.0 || near > far || far <= 0.0 {
                    return None;
                }
                let (t, by_cap) = if near > 0.0 {
                    (near, caps[0] > side[0])
                } else {
                    (far, caps[1] < side[1])
                };
                let at = o + t * d;
                let normal = if by_cap {
                    c * (at.z.signum() / height)
                } else {
                    (a * at.x + b * at.y) / (radius * radius)
                };
                Some((t, normal))
            }
            Self::Ellipsoid { .. } | Self::Barrel { .. } => {
                let (canonical, centre, map) = self.canonical()?;
                let back = map.inverse() * direction;
                let q = map.inverse() * (p - centre);
                let (t, normal) = canonical.hit(q, back.normalize())?;
                let normal = map.inverse().transpose() * normal;
                Some((t / back.length(), normal.normalize()))
            }
            Self::Point(_) => None,
        }
    }
}

fn linear([a, b, c]: [DVec3; 3]) -> DMat3 {
    DMat3::from_cols(a, b, c)
}

fn cube_normals(half: [DVec3; 3]) -> [DVec3; 3] {
    [0, 1, 2].map(|i| {
        let n = half[(i + 1) % 3].cross(half[(i + 2) % 3]).normalize();
        n * n.dot(half[i]).signum()
    })
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
    let start = DVec3::from_array(p.to_array().map(|x| precision.rounded(x)));
    let hit = |sample: &LightSample| {
        // Found in f64 for the rounded direction.
        let near = start + sample.distance * sample.direction;
        let normal = light.normal_near(near) * (1.0 + 3.0 * precision.roundoff());
        (sample.direction, normal)
    };
    let hits: Vec<_> = samples.iter().map(hit).collect();
    light.ask(precision, |light| light_densities(set, light, p, &hits))
}

impl Light {
    /// The outward normal at the light's point nearest to `at`, roughly: which face of a cube.
    fn normal_near(&self, at: DVec3) -> DVec3 {
        match *self {
            Self::Rectangle { half, .. }
            | Self::Parallelogram { half, .. }
            | Self::Disk { half, .. } => half[0].cross(half[1]).normalize(),
            Self::Sphere { centre, .. } => (at - centre).normalize(),
            Self::Cube { centre, half } => {
                let normals = cube_normals(half);
                let excess = |n: DVec3, h: DVec3| ((at - centre).dot(n) / h.dot(n)).abs();
                let (mut best, mut most) = (DVec3::X, f64::NEG_INFINITY);
                for (n, h) in normals.into_iter().zip(half) {
                    if excess(n, h) > most {
                        most = excess(n, h);
                        best = n * (at - centre).dot(n).signum();
                    }
                }
                best
            }
            Self::Cylinder { centre, half } => {
                let [a, b, c] = half;
                let v = at - centre;
                let (x, y) = (v.dot(a) / a.length_squared(), v.dot(b) / b.length_squared());
                let z = v.dot(c) / c.length_squared();
                if x.hypot(y) > z.abs() {
                    (x * a + y * b).normalize()
                } else {
                    c.normalize() * z.signum()
                }
            }
            Self::Ellipsoid { .. } | Self::Barrel { .. } => {
                let (canonical, centre, map) = self.canonical().unwrap();
                let normal = canonical.normal_near(map.inverse() * (at - centre));
                (map.inverse().transpose() * normal).normalize()
            }
            Self::Point(at) => at,
        }
    }
}

/// Jittered n × n variates.
fn variates(rng: &mut Pcg64Mcg, n: usize) -> Vec<[f64; 2]> {
    let mut all = Vec::with_capacity(n * n);
    for i in 0..n {
        for j in 0..n {
            let (u, v): (f64, f64) = (rng.random(), rng.random());
            all.push([(i as f64 + u) / n as f64, (j as f64 + v) / n as f64]);
        }
    }
    all
}

fn independent(rng: &mut Pcg64Mcg, n: usize) -> Vec<[f64; 2]> {
    (0..n).map(|_| [rng.random(), rng.random()]).collect()
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
    let at = |x: f64, y: f64, z: f64| centre + x * sides[0] + y * sides[1] + z * sides[2];
    let cube = vec![
        // Seen: one face, two, three; from far; grazing; from inside.
        at(0.2, 0.1, 3.0),
        at(2.5, 0.1, 2.0),
        at(2.0, 2.0, 2.0),
        at(-30.0, 20.0, 10.0),
        at(1.01, 2.5, 0.0),
        at(0.3, -0.2, 0.6),
        at(0.0, 0.0, 0.98),
    ];
    let long = 0.6 * normal.cross(half[0]).normalize();
    let round = [0.4 * half[0].normalize(), 0.4 * normal, long];
    let about = |x: f64, y: f64, z: f64| centre + x * round[0] + y * round[1] + z * round[2];
    let cylinder = vec![
        // Seen: the side, a cap, both; from far; grazing a cap; from inside, and on the axis.
        about(2.0, 1.0, 0.3),
        about(0.3, -0.2, -2.5),
        about(-1.5, 2.0, 1.8),
        about(30.0, -50.0, 40.0),
        about(2.5, 0.3, 1.01),
        about(0.4, 0.5, -0.6),
        about(0.0, 0.0, 0.9),
    ];
    // The same places, over and inside of images of the round shapes.
    let ellipsoid = [1.05, 1.5, 4.0, 60.0, 0.0, 0.3, 0.9, 0.98]
        .map(|d| at(0.6 * d, -0.48 * d, 0.64 * d))
        .to_vec();
    let barrel = vec![
        at(2.0, 1.0, 0.3),
        at(0.3, -0.2, -2.5),
        at(-1.5, 2.0, 1.8),
        at(30.0, -50.0, 40.0),
        at(2.5, 0.3, 1.02),
        at(0.4, 0.5, -0.6),
        at(0.0, 0.0, 0.9),
    ];
    vec![
        (
            Light::Rectangle {
                centre,
                half: [half[0], upright],
            },
            flat.clone(),
        ),
        (Light::Parallelogram { centre, half }, flat.clone()),
        (Light::Disk { centre, half }, flat),
        (Light::Sphere { centre, radius }, sphere),
        (
            Light::Cube {
                centre,
                half: sides,
            },
            cube,
        ),
        (
            Light::Cylinder {
                centre,
                half: round,
            },
            cylinder,
        ),
        (
            Light::Ellipsoid {
                centre,
                half: sides,
            },
            ellipsoid,
        ),
        (
            Light::Barrel {
                centre,
                half: sides,
            },
            barrel,
        ),
    ]
}

#[test]
fn both_strategies_see_the_same_density() {
    let mut rng = Pcg64Mcg::seed_from_u64(21);
    for precision in PRECISIONS {
        for (light, receivers) in settings() {
            for p in receivers {
                let variates = variates(&mut rng, 64);
                let drawn = best(precision, (light, p), &variates);
                let asked = asked(Instructions::best(), precision, (light, p), &drawn);
                for (sample, asked) in drawn.iter().zip(asked) {
                    assert!(sample.valid && sample.pdf > 0.0, "{light:?} {p} {sample:?}");
                    // Not within 1e-5 of each other but equal: they are the same function.
                    assert!(
                        same_bits(sample.pdf, asked),
                        "{precision:?} {light:?} {p} {sample:?} {asked}"
                    );
                }
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
        for (light, receivers) in settings() {
            for p in receivers {
                let p = DVec3::from_array(p.to_array().map(|x| precision.rounded(x)));
                let variates = variates(&mut rng, 32);
                for sample in best(precision, (light, p), &variates) {
                    let Some((t, normal)) = light.hit(p, sample.direction.normalize()) else {
                        // Rounded past the edge.
                        continue;
                    };
                    let cosine = normal.dot(sample.direction).abs();
                    let expected = match light {
                        Light::Parallelogram { half, .. } => {
                            t * t / cosine / (4.0 * half[0].cross(half[1]).length())
                        }
                        Light::Disk { half, .. } => {
                            t * t / cosine / (PI * half[0].cross(half[1]).length())
                        }
                        // The others have tests of their own integrals.
                        _ => continue,
                    };
                    // Rounding a direction by u moves cos by as much; the height of a plane is
                    // good to u of the distance.
                    let allowed = 20.0 * u * (1.0 + 4.0 / cosine);
                    let error = (sample.pdf / expected - 1.0).abs();
                    worst = worst.max(error / allowed);
                    assert!(
                        (sample.distance / t - 1.0).abs() <= allowed,
                        "{sample:?} {t}"
                    );
                }
            }
        }
        println!("{precision:?}: densities within {worst} of what is allowed");
        assert!(worst <= 1.0);
    }
}

/// Equal-area bins of the sphere of directions about an axis.
struct Bins {
    rows: usize,
    columns: usize,
    axis: [DVec3; 3],
    /// 1 − cos of the cone covered.
    height: f64,
}

impl Bins {
    fn about(axis: DVec3, height: f64) -> Self {
        let z = axis.normalize();
        let x = z.any_orthonormal_vector();
        Self {
            rows: 12,
            columns: 12,
            axis: [x, z.cross(x), z],
            height,
        }
    }

    fn of(&self, direction: DVec3) -> Option<usize> {
        let [x, y, z] = self.axis.map(|a| a.dot(direction));
        let h = (x * x + y * y) / (1.0 + z);
        let row = (h / self.height * self.rows as f64).floor();
        if row >= self.rows as f64 {
            return None;
        }
        let turn = libm::atan2(y, x) / (2.0 * PI) + 0.5;
        let column = ((turn * self.columns as f64) as usize).min(self.columns - 1);
        Some(row as usize * self.columns + column)
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

/// What one setting says: the integral of the density with its quadrature's error, and the p-value
/// of χ² of drawn directions against it.
struct Verdict {
    integral: f64,
    p_value: f64,
}

/// Integrates the density over solid-angle bins by an n × n midpoint rule in each, and compares
/// counts of drawn directions, whose density may have been bent by `bend`.
fn verdict(
    light: Light,
    p: DVec3,
    rng: &mut Pcg64Mcg,
    precision: Precision,
    bend: impl Fn([f64; 2]) -> [f64; 2],
) -> Verdict {
    let samples: Vec<[f64; 2]> = independent(rng, 40_000).into_iter().map(bend).collect();
    let drawn = best(precision, (light, p), &samples);
    let axis: DVec3 = drawn.iter().map(|s| s.direction).sum();
    let axis = axis.try_normalize().unwrap_or(DVec3::Z);
    // A cone that covers every direction to the light.
    let farthest = drawn
        .iter()
        .map(|s| s.direction.dot(axis))
        .fold(1.0, f64::min);
    let bins = Bins::about(axis, ((1.0 - farthest) * 1.05 + 1e-6).min(2.0));
    let fine = 40;
    let mut directions = Vec::new();
    let mut place = Vec::new();
    let (rows, columns) = (bins.rows * fine, bins.columns * fine);
    for i in 0..rows {
        for j in 0..columns {
            let d = bins.direction(
                (i as f64 + 0.5) / rows as f64,
                (j as f64 + 0.5) / columns as f64,
            );
            if let Some((_, normal)) = light.hit(p, d) {
                directions.push((d, normal));
                place.push((i / fine) * bins.columns + j / fine);
            }
        }
    }
    let densities = light.ask(Precision::Double, |light| {
        light_densities(Instructions::best(), light, p, &directions)
    });
    let cell = 2.0 * PI * bins.height / (rows * columns) as f64;
    let mut expected = vec![0.0; bins.rows * bins.columns];
    for (&place, &pdf) in place.iter().zip(&densities) {
        expected[place] += pdf * cell;
    }
    let integral: f64 = expected.iter().sum();
    let mut counts = vec![0; expected.len()];
    for sample in &drawn {
        if let Some(bin) = bins.of(sample.direction) {
            counts[bin] += 1;
        }
    }
    let total: u64 = counts.iter().sum();
    for e in &mut expected {
        *e *= total as f64 / integral;
        // The quadrature may miss a sliver at the outline.
        *e = e.max(1e-9);
    }
    let sum: f64 = expected.iter().sum();
    for e in &mut expected {
        *e *= total as f64 / sum;
    }
    Verdict {
        integral,
        p_value: chi_square(&counts, &expected),
    }
}

/// Receivers for which the density is smooth enough for midpoint quadrature: not within a tenth
/// of a size of the light's plane, where 1/cos³ spans decades.
fn tame() -> Vec<(Light, DVec3)> {
    settings()
        .into_iter()
        .flat_map(|(light, receivers)| {
            receivers.into_iter().enumerate().filter_map(move |(i, p)| {
                let grazing = match light {
                    Light::Sphere { .. } | Light::Ellipsoid { .. } => 0..0,
                    Light::Cube { .. } | Light::Cylinder { .. } | Light::Barrel { .. } => 4..5,
                    _ => 2..5,
                };
                let rough = grazing.contains(&i);
                (!rough).then_some((light, p))
            })
        })
        .collect()
}

#[test]
fn directions_follow_their_densities_which_integrate_to_one() {
    let mut rng = Pcg64Mcg::seed_from_u64(23);
    let settings = tame();
    let level = sidak(FAMILY / 2.0, 2 * settings.len());
    for precision in PRECISIONS {
        for &(light, p) in &settings {
            let Verdict { integral, p_value } = verdict(light, p, &mut rng, precision, |uv| uv);
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
        let verdict = verdict(light, receivers[0], &mut rng, Precision::Double, bend);
        println!("{light:?}: bent p = {:e}", verdict.p_value);
        assert!(verdict.p_value < 1e-5, "{light:?}");
    }
}

#[test]
fn grazing_receivers_see_all_of_a_flat_light_alike() {
    let mut rng = Pcg64Mcg::seed_from_u64(27);
    // By area, the points themselves are uniform, however grazing the view.
    let level = sidak(FAMILY / 10.0, 40);
    for precision in PRECISIONS {
        for (light, receivers) in settings() {
            let (centre, half) = match light {
                Light::Parallelogram { centre, half } | Light::Disk { centre, half } => {
                    (centre, half)
                }
                _ => continue,
            };
            let normal = half[0].cross(half[1]);
            for p in receivers {
                let variates = independent(&mut rng, 20_000);
                let drawn = best(precision, (light, p), &variates);
                let mut counts = vec![0; 144];
                for sample in &drawn {
                    let at = p + sample.distance * sample.direction - centre;
                    let x = at.cross(half[1]).dot(normal) / normal.length_squared();
                    let y = half[0].cross(at).dot(normal) / normal.length_squared();
                    let (a, b) = if matches!(light, Light::Disk { .. }) {
                        (x * x + y * y, libm::atan2(y, x) / (2.0 * PI) + 0.5)
                    } else {
                        ((x + 1.0) / 2.0, (y + 1.0) / 2.0)
                    };
                    let cell = |x: f64| ((x * 12.0) as usize).min(11);
                    counts[cell(a) * 12 + cell(b)] += 1;
                }
                let p_value = chi_square(&counts, &[20_000.0 / 144.0; 144]);
                assert!(p_value > level, "{light:?} {p}: {p_value:e}");
            }
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
    let (a, b, c, d) = (
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    );
    triangle(a, b, c) + triangle(a, c, d)
}

#[test]
fn a_rectangle_knows_its_solid_angle() {
    let mut rng = Pcg64Mcg::seed_from_u64(25);
    // What the threshold in rectangle.rs promises: four angles to a quarter unit of 1 each.
    for (precision, allowed) in [(Precision::Single, 7.5e-5), (Precision::Double, 2e-13)] {
        let mut worst = 0.0_f64;
        let mut near = 0;
        for _ in 0..4_000 {
            let half = [
                DVec3::X * rng.random_range(0.05..2.0),
                DVec3::Y * rng.random_range(0.05..2.0),
            ];
            let centre = DVec3::ZERO;
            let p = DVec3::new(
                rng.random_range(-3.0..3.0),
                rng.random_range(-3.0..3.0),
                libm::exp2(rng.random_range(-12.0..2.0)),
            );
            let p = DVec3::from_array(p.to_array().map(|x| precision.rounded(x)));
            let half = half.map(|h| DVec3::from_array(h.to_array().map(|x| precision.rounded(x))));
            let light = Light::Rectangle { centre, half };
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
    (0..64)
        .map(|_| {
            let variates = variates(&mut rng, 48);
            let drawn = best(precision, (light, p), &variates);
            let sum: f64 = drawn
                .iter()
                .filter(|s| s.valid)
                .map(|s| s.direction.dot(n).max(0.0) / s.pdf)
                .sum();
            sum / drawn.len() as f64
        })
        .collect()
}

/// Every closed form: light, receiver with normal, irradiance for radiance (or intensity) 1.
fn closed_forms() -> Vec<(String, Light, (DVec3, DVec3), f64)> {
    let mut all = Vec::new();
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    let vector = |v: &serde_json::Value| DVec3::from_array([0, 1, 2].map(|i| number(&v[i])));
    for id in ["polygon_light", "polygon_light_horizon"] {
        let t = truth(id);
        let v = [0, 1, 3].map(|i| vector(&t["setup"]["V"][i]));
        let half = [(v[1] - v[0]) / 2.0, (v[2] - v[0]) / 2.0];
        let centre = v[0] + half[0] + half[1];
        let at = (vector(&t["setup"]["P"]), vector(&t["setup"]["N"]));
        let irradiance = number(&t["exact"]["E"]) / number(&t["setup"]["Le"]);
        all.push((
            id.to_owned(),
            Light::Parallelogram { centre, half },
            at,
            irradiance,
        ));
        assert!(half[0].dot(half[1]).abs() < 1e-12);
        all.push((
            format!("{id}, rectangle"),
            Light::Rectangle { centre, half },
            at,
            irradiance,
        ));
        // The same light as two far smaller ones would be is left to the picture's own tests.
    }
    let t = truth("sphere_light");
    for row in t["exact"]["per_angle"].as_array().unwrap() {
        let beta = number(&row["beta_deg"]).to_radians();
        let centre = number(&t["setup"]["d"]) * DVec3::new(libm::sin(beta), 0.0, libm::cos(beta));
        let light = Light::Sphere {
            centre,
            radius: number(&t["setup"]["r"]),
        };
        let irradiance = number(&row["E"]) / number(&t["setup"]["Le"]);
        let name = format!("sphere_light {}°", row["beta_deg"]);
        all.push((name, light, (DVec3::ZERO, DVec3::Z), irradiance));
    }
    let t = truth("disk_light");
    for row in t["exact"]["per_offset"].as_array().unwrap() {
        let r = number(&t["setup"]["r"]);
        let centre = DVec3::new(number(&row["a"]), 0.0, number(&t["setup"]["h"]));
        let light = Light::Disk {
            centre,
            half: [DVec3::X * r, DVec3::Y * r],
        };
        let irradiance = number(&row["E"]) / number(&t["setup"]["Le"]);
        let name = format!("disk_light {}", row["a"]);
        all.push((name, light, (DVec3::ZERO, DVec3::Z), irradiance));
    }
    // Inside a closed light of radiance 1: π, for any shape.
    let inside = Light::Sphere {
        centre: DVec3::new(0.1, 0.2, -0.3),
        radius: 1.0,
    };
    all.push((
        "inside a sphere".into(),
        inside,
        (DVec3::ZERO, DVec3::Z),
        PI,
    ));
    let half = [
        DVec3::X,
        DVec3::new(0.3, 1.0, 0.0),
        DVec3::new(0.1, 0.2, 1.5),
    ];
    let cube = Light::Cube {
        centre: DVec3::new(0.2, 0.1, 0.0),
        half,
    };
    all.push(("inside a cube".into(), cube, (DVec3::ZERO, DVec3::Z), PI));
    let half = [DVec3::X, DVec3::Y, 1.5 * DVec3::Z];
    let cylinder = |centre: DVec3| Light::Cylinder { centre, half };
    all.push((
        "inside a cylinder".into(),
        cylinder(DVec3::new(0.2, 0.1, 0.3)),
        (DVec3::ZERO, DVec3::new(0.6, 0.0, 0.8)),
        PI,
    ));
    let (centre, up) = (DVec3::new(0.1, 0.1, 0.3), DVec3::new(0.6, 0.0, 0.8));
    let half = [
        DVec3::X,
        DVec3::new(0.3, 0.6, 0.0),
        DVec3::new(0.1, 0.2, 1.5),
    ];
    for (name, light) in [
        ("inside an ellipsoid", Light::Ellipsoid { centre, half }),
        ("inside a leaning cylinder", Light::Barrel { centre, half }),
    ] {
        all.push((name.into(), light, (DVec3::ZERO, up), PI));
    }
    // A receiver on the axis sees the near cap alone, a disk: π sin² of its half-angle.
    all.push((
        "on the axis of a cylinder".into(),
        cylinder(DVec3::new(0.0, 0.0, 3.5)),
        (DVec3::ZERO, DVec3::Z),
        PI / 5.0,
    ));
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
            let (mean, variance) = crate::statistics_support::moments(&estimates);
            let relative = (variance / 64.0).sqrt() / irradiance;
            println!(
                "{precision:?} {name}: {:+.1e} ± {relative:.1e}, p = {p:.3}",
                mean / irradiance - 1.0
            );
            assert!(relative < 2e-3, "{name}: {relative}");
            // Rounding may bias a mean by some units where the noise is smaller than that.
            let rounding = (mean / irradiance - 1.0).abs() < 50.0 * precision.roundoff();
            assert!(
                p > level || rounding,
                "{name}: p = {p:e}, {mean} for {irradiance}"
            );
            // Planted: a density that is a per cent too large.
            let wrong: Vec<f64> = estimates.iter().map(|e| e / 1.01).collect();
            assert!(
                t_test(&wrong, *irradiance) < level,
                "{name} would not notice 1 %"
            );
        }
    }
}

#[test]
fn points_fall_off_with_the_square() {
    let t = truth("point_light");
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    for precision in PRECISIONS {
        for row in t["exact"]["per_point"].as_array().unwrap() {
            let light = Light::Point(DVec3::new(0.0, 0.0, number(&t["setup"]["h"])));
            let p = DVec3::new(number(&row["x"]), 0.0, 0.0);
            let drawn = best(precision, (light, p), &[[0.5, 0.5]]);
            let irradiance = number(&t["setup"]["I"]) * drawn[0].direction.z / drawn[0].pdf;
            let error = (irradiance / number(&row["E"]) - 1.0).abs();
            assert!(error < 6.0 * precision.roundoff(), "{error:e}");
        }
    }
}

#[test]
fn all_instruction_sets_draw_the_same_bits() {
    let mut rng = Pcg64Mcg::seed_from_u64(26);
    for precision in PRECISIONS {
        for (light, receivers) in settings() {
            for p in receivers {
                let variates = variates(&mut rng, 8);
                let from = (light, p);
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
                        assert!(same, "{name} {light:?}: {a:?} {b:?}");
                    }
                }
            }
        }
    }
}
