//! Nanoseconds a ray of the finders of implicit surfaces.
//!
//!     cargo bench -p etalon-method               oracle rays, all finders
//!     cargo bench -p etalon-method -- view heart 700 10 "$PWD/depths.f64"
//!                                                primary rays, camera 10 times as far
//!
//! Coefficients are formed anew for each ray. Each time is the best of several runs over all rays of
//! a kind, one thread.

#![allow(
    clippy::unwrap_used,
    reason = "a measurement stops at what it cannot read"
)]

mod yardstick;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use etalon::Instructions;
use etalon::inside::field::expression::Expression;
use etalon::inside::field::named;
use etalon::inside::math::affine::Affine;
use etalon::inside::scene::{FinderChoice, Implicit};
use etalon::inside::shape::Query;
use etalon::inside::shape::implicit::baseline::SteppingFinder;
use etalon::inside::shape::implicit::certified::{Certified, Effort, Packet, WIDTH, Workspace};
use etalon::inside::shape::lanes::implicit::LaneImplicit;
use etalon_doors::shapes::sign_changes;
use etalon_method::finders::{CLASSES, Oracle};
use glam::DVec3;
use yardstick::Yardstick;

/// Runs over the rays; the best counts.
const RUNS: usize = 9;

#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    direction: DVec3,
    t_min: f64,
}

impl Ray {
    fn line(&self) -> etalon::Ray {
        etalon::Ray {
            origin: self.origin,
            direction: self.direction,
        }
    }
}

struct Surface {
    degree: u32,
    certified: Certified,
    stepping: LaneImplicit<f64>,
    scalar: SteppingFinder,
    yardstick: Yardstick,
}

impl Surface {
    fn new(field: Arc<Expression>, half: f64) -> Self {
        let implicit = Implicit {
            name: None,
            field,
            inside: [DVec3::splat(-half), DVec3::splat(half)],
            closed: false,
            finder: FinderChoice::SignChange,
            steps: 256,
        };
        let (tape, inside) = (&implicit.field.tape, implicit.inside);
        let placed = Certified::new(tape, inside, &Affine::IDENTITY).unwrap();
        Self {
            degree: implicit.field.polynomial.as_ref().unwrap().degree(),
            certified: placed.unwrap(),
            stepping: LaneImplicit::new(&implicit, &Affine::IDENTITY, &Affine::IDENTITY).unwrap(),
            scalar: SteppingFinder::new(&implicit, &Affine::IDENTITY).unwrap(),
            yardstick: Yardstick::new(tape, half),
        }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        ["view", name, size, distance, file] => {
            view(name, size.parse().unwrap(), distance.parse().unwrap(), file);
        }
        _ => oracle(),
    }
}

/// Seconds of the best run.
fn best(mut run: impl FnMut() -> u32) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        std::hint::black_box(run());
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}

fn packets(rays: &[Ray]) -> Vec<Packet> {
    let packet = |rays: &[Ray]| {
        let mut packet = Packet::default();
        for (lane, ray) in rays.iter().enumerate() {
            packet.set(lane, ray.origin, ray.direction, [ray.t_min, f64::INFINITY]);
        }
        packet
    };
    rays.chunks(WIDTH).map(packet).collect()
}

/// Seconds of one pass by the certified finder.
fn certified(surface: &Surface, packets: &[Packet], exact: bool) -> f64 {
    let mut workspace = Workspace::default();
    let effort = Effort {
        sharp: false,
        exact,
    };
    best(|| {
        let mut found = |packet| {
            let answers = surface.certified.first_hits(packet, effort, &mut workspace);
            answers.found
        };
        packets.iter().map(&mut found).fold(0, u32::wrapping_add)
    })
}

const FINDERS: [&str; 5] = [
    "sign-change 256, scalar",
    "sign-change 256, lanes",
    "yardstick",
    "polynomial",
    "auto",
];

/// Seconds by each of [`FINDERS`].
fn times(surface: &Surface, rays: &[Ray]) -> [f64; 5] {
    let packets = packets(rays);
    let count = |hits: &dyn Fn(&Ray) -> bool| rays.iter().map(|r| u32::from(hits(r))).sum();
    let yardstick = best(|| {
        count(&|r| {
            surface
                .yardstick
                .first_hit(r.origin, r.direction, r.t_min)
                .is_some()
        })
    });
    let march = best(|| {
        count(&|r| {
            let query = Query {
                ray: r.line(),
                t_min: r.t_min,
                t_max: f64::INFINITY,
            };
            surface.scalar.first_hit(&query).is_some()
        })
    });
    let lines: Vec<etalon::Ray> = rays.iter().map(Ray::line).collect();
    let set = Instructions::best();
    [
        march,
        best(|| sign_changes(set, &surface.stepping, &lines)),
        yardstick,
        certified(surface, &packets, false),
        certified(surface, &packets, true),
    ]
}

fn oracle() {
    let oracle = Oracle::new(None, None).unwrap();
    let mut sums: BTreeMap<(String, String), ([f64; 5], usize)> = BTreeMap::new();
    for shape in &oracle.shapes {
        let surface = &Surface::new(Arc::clone(&shape.field), shape.half_width);
        let degree = format!("degree {:2}", surface.degree);
        for class in CLASSES {
            let rays = oracle.rays_of(&shape.name, class);
            let rays: Vec<Ray> = rays
                .map(|row| Ray {
                    origin: row.ray.origin,
                    direction: row.ray.direction,
                    t_min: row.t_min,
                })
                .collect();
            let times = times(surface, &rays);
            for key in [
                (class, "all degrees"),
                (class, &*degree),
                ("all classes", "all degrees"),
            ] {
                let key = (key.0.to_owned(), key.1.to_owned());
                let (sum, count) = sums.entry(key).or_default();
                for (sum, time) in sum.iter_mut().zip(times) {
                    *sum += time;
                }
                *count += rays.len();
            }
        }
    }
    println!(
        "class,degree,rays,{}",
        FINDERS.map(|f| f.replace(',', "")).join(",")
    );
    for ((class, degree), (sum, count)) in sums {
        let each = sum.map(|s| format!("{:.1}", s * 1e9 / count as f64));
        println!("{class},{degree},{count},{}", each.join(","));
    }
}

/// Primary rays of a named surface, seen along +y from a distance, and their t as little-endian f64,
/// infinite where nothing is hit. The window is `half` wide on both sides of the centre.
fn view(name: &str, size: usize, distance: f64, file: &str) {
    let named = named::find(name).unwrap();
    let half = named.half_width;
    let surface = Surface::new(Arc::new(named.field(&[]).unwrap()), half);
    let far = 4.0 * half * distance;
    let place = |i: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    let pixel = |k: usize| Ray {
        origin: DVec3::new(0.0, -far, 0.0),
        direction: DVec3::new(place(k % size) * half, far, -place(k / size) * half),
        t_min: 0.0,
    };
    let rays: Vec<Ray> = (0..size * size).map(pixel).collect();
    let packets = packets(&rays);
    let seconds = certified(&surface, &packets, true);
    let mut workspace = Workspace::default();
    let effort = Effort {
        sharp: true,
        exact: true,
    };
    let mut bytes = Vec::new();
    for packet in &packets {
        let answers = surface.certified.first_hits(packet, effort, &mut workspace);
        for lane in (0..WIDTH).filter(|lane| packet.active >> lane & 1 == 1) {
            let hit = answers.found >> lane & 1 == 1;
            let t = if hit { answers.t[lane] } else { f64::INFINITY };
            bytes.extend(t.to_le_bytes());
        }
    }
    std::fs::write(file, bytes).unwrap();
    println!("{:.1}", seconds * 1e9 / rays.len() as f64);
}
