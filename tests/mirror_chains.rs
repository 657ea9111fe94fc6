//! How long a path between two mirrors stays true: `tests/data/mirrors.csv`, path lengths from
//! bounce to bounce in 400-digit arithmetic.
//!
//! Two spheres of radius 1 stand g apart. One bounce and the way to the other sphere multiply what is
//! off by λ = 1 + g + √((1 + g)² − 1), the larger eigenvalue of the ray matrix of a convex mirror of
//! radius 1 and a gap g (trace 2 + 2g, determinant 1; Gerrard and Burch 1975, ch. II).

use etalon::inside::math::affine::Affine;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::plan::Tables;
use etalon::inside::shape::{Placed, Ray, ShapeKind, Start, Tally};
use etalon::{Plan, Scene};
use etalon_doors::Made;
use etalon_doors::models::path_lengths;

use crate::oracle_support::{Row, number, ray, rows};
use crate::support::object;

/// The error that ends a count of bounces.
const ERROR: f64 = 1e-6;
/// Wavelengths of the path, which sees only mirrors that reflect everything.
const WAVELENGTHS: usize = 4;

struct Chain {
    id: String,
    gap: f64,
    ray: Ray,
    each: Vec<f64>,
}

fn chain(row: &Row) -> Chain {
    let each = row["t_each"].split(';').map(|t| t.parse().unwrap());
    Chain {
        id: row["id"].clone(),
        gap: number(row, "gap"),
        ray: ray(row),
        each: each.collect(),
    }
}

impl Chain {
    /// Distance of the centres from the origin.
    fn centre(&self) -> f64 {
        1.0 + self.gap / 2.0
    }

    /// Both mirrors, seen from where the chain begins.
    fn plan(&self, precision: &str) -> Plan {
        let mirror = |x: f64| {
            let place = format!("{{ translate = [{x:?}, 0, 0] }}");
            object("\"sphere\"", "mirror", &place)
        };
        let text = format!(
            "camera = {{ from = [0, 0, 0], to = [1, 0, 0], fov = 40 }}\n\
             image = {{ size = [256, 256], spp = 1, precision = \"{precision}\", \
             wavelengths = {WAVELENGTHS} }}\n\
             materials.mirror = {{ mirror = {{ ideal = 1 }} }}\n{}{}",
            mirror(-self.centre()),
            mirror(self.centre())
        );
        let scene = Scene::parse(&text).unwrap();
        Plan::new(&scene, false).unwrap()
    }

    /// Bounces before the first path length that is off by more than [`ERROR`], or misses.
    fn score(&self, lengths: &[f64]) -> usize {
        let right = |(a, b): &(&f64, &f64)| (**a - **b).abs() <= ERROR;
        self.each.iter().zip(lengths).take_while(right).count()
    }

    /// Growth of an error from bounce to bounce.
    fn growth(&self) -> f64 {
        let half_trace = 1.0 + self.gap;
        half_trace + (half_trace * half_trace - 1.0).sqrt()
    }
}

/// Path lengths by the step of the path loop, as it stands in the library.
fn by_the_loop(plan: &Plan, chain: &Chain) -> Vec<f64> {
    let model = match &plan.tables {
        Tables::Single(tables) => Made::Single(&tables.0),
        Tables::Double(tables) => Made::Double(&tables.0),
    };
    path_lengths(model, chain.ray, chain.each.len())
}

/// Path lengths by certified hits whose points and normals are rounded to f64, as `trace` prints
/// them.
fn by_printed_hits(chain: &Chain) -> Vec<f64> {
    let spheres = [-chain.centre(), chain.centre()].map(|x| {
        let mut to_world = Affine::IDENTITY;
        to_world.rows[0][3] = x;
        Placed::new(ShapeKind::Sphere, &to_world).unwrap()
    });
    let (mut ray, mut lengths) = (chain.ray, Vec::new());
    // The first mirror is the right one, and then they take turns.
    for (k, _) in chain.each.iter().enumerate() {
        let sphere = &spheres[(k + 1) % 2];
        let Some(hit) = sphere.first_hit(&ray, 0.0, Start::Free, &mut Tally::default()) else {
            break;
        };
        lengths.push(hit.t);
        let cosine = ray.direction.dot(hit.normal);
        ray = Ray {
            origin: hit.point,
            direction: ray.direction - hit.normal * (2.0 * cosine),
        };
    }
    lengths
}

#[test]
fn chains_of_mirrors_stay_true_as_long_as_their_digits_last() {
    let mut table = String::from("| chain | gap | bounces | f32 | f64 | default | trace |\n");
    for row in &rows("mirrors.csv") {
        let chain = chain(row);
        let plans = ["f32", "f64", "auto"].map(|precision| chain.plan(precision));
        let [single, double, default] = plans
            .each_ref()
            .map(|plan| chain.score(&by_the_loop(plan, &chain)));
        let printed = chain.score(&by_printed_hits(&chain));
        let name = plans[2].choices.precision.name();
        table += &format!(
            "| {} | {:e} | {} | {single} | {double} | {default} ({name}) | {printed} |\n",
            chain.id,
            chain.gap,
            chain.each.len()
        );
        // Each bounce adds some roundings of coordinates up to 2, and what is off grows from bounce to
        // bounce: 2⁶ u n λⁿ bounds it with room to spare where that is small.
        let count = chain.each.len();
        let bound = 64.0 * f64::ROUNDOFF * count as f64 * chain.growth().powi(count as i32);
        assert!(bound < ERROR, "{}: {bound:e}", chain.id);
        assert_eq!([double, printed], [count; 2], "{}", chain.id);
        // In single precision the same bound allows nothing; the plan takes it only where no gap is
        // at stake.
        assert!(default >= single, "{}: {default} and {single}", chain.id);
    }
    println!("{table}");
}
