//! Where each method fails: every shape × finder × precision over families of rays that grow harder by
//! one number, against exact verdicts.
//!
//! Each arithmetic is asked about the ray as it can hold it, and judged by the exact answer to that ray:
//! what rounding does to a ray is not the method's fault. An answer is wrong if it is a miss for a hit or the
//! other way round, on another object, or off by more than half the way to the next crossing or a
//! thousandth of the object's size; but not for less than its arithmetic can hold of t.
//!
//! What the plan takes is judged by what a path would make of it, too: its hit, rounded to coordinates
//! about the camera in the planned precision, must lie nearer to where it belongs than to the next
//! object, with no allowance for a coarse arithmetic.

pub mod chart;
pub mod families;
mod plan;
pub mod textbook;
pub mod truth;

use std::fmt::Write as _;
use std::time::Instant;

use glam::DVec3;

use crate::finders::{Contestant, Precision, Ready, Score};
use etalon::inside::math::affine::Affine;
use etalon::inside::math::lanes::Scalar;
use etalon::inside::scene::FinderChoice;
use etalon::inside::shape::implicit::certified::Workspace;
use etalon::inside::shape::implicit::placed::{ImplicitAnswer, PlacedImplicit};
use etalon::inside::shape::{Placed, Query, Ray, ShapeKind, Start, Tally};
use families::{Body, Case, FAMILIES, Family, Problem};
use textbook::Textbook;
use truth::First;

/// What is hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// A canonical shape.
    Canonical(ShapeKind),
    /// A named implicit surface.
    Implicit(&'static str),
}

/// All of them, in the order of the picture's rows.
pub const SUBJECTS: [Subject; 9] = [
    Subject::Canonical(ShapeKind::Sphere),
    Subject::Canonical(ShapeKind::Cube),
    Subject::Canonical(ShapeKind::Cylinder),
    Subject::Canonical(ShapeKind::Disk),
    Subject::Canonical(ShapeKind::Rectangle),
    Subject::Canonical(ShapeKind::Plane),
    Subject::Implicit("torus"),
    Subject::Implicit("heart"),
    Subject::Implicit("chmutov"),
];

impl Subject {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Canonical(kind) => kind.name(),
            Self::Implicit(name) => name,
        }
    }

    /// Its place among [`SUBJECTS`].
    pub fn index(self) -> usize {
        SUBJECTS
            .iter()
            .position(|s| *s == self)
            .unwrap_or(SUBJECTS.len())
    }

    /// The methods that know this kind of shape.
    pub fn methods(self) -> &'static [Method] {
        match self {
            Self::Canonical(_) => &CANONICAL,
            Self::Implicit(_) => &IMPLICIT,
        }
    }
}

/// A way to a first hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// [`textbook`].
    Textbook(Precision),
    /// What the plan takes for a scene of this kind: the ladder, on rays of the precision that it
    /// chooses.
    Ladder,
    /// 256 equal steps and bisection.
    SignChange(Precision),
    /// A finder of implicit surfaces that proves its answers; of these the plan takes `auto`, in f64.
    Proved(FinderChoice),
}

const CANONICAL: [Method; 3] = [
    Method::Textbook(Precision::Single),
    Method::Textbook(Precision::Double),
    Method::Ladder,
];

const IMPLICIT: [Method; 6] = [
    Method::SignChange(Precision::Single),
    Method::SignChange(Precision::Double),
    Method::Proved(FinderChoice::SphereTrace),
    Method::Proved(FinderChoice::Interval),
    Method::Proved(FinderChoice::Polynomial),
    Method::Proved(FinderChoice::Auto),
];

/// Rays that are timed together, and how often: the best time counts, so that what else the machine does
/// hardly shows.
const BLOCK: usize = 10;
const RUNS: usize = 3;
/// Steps of the finder that proves nothing.
const STEPS: u32 = 256;

impl Method {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Textbook(_) => "textbook",
            Self::Ladder => "ladder",
            Self::SignChange(_) => "sign-change",
            Self::Proved(choice) => choice.name(),
        }
    }

    /// Whether it is what the plan would take.
    pub fn is_planned(self) -> bool {
        matches!(self, Self::Ladder | Self::Proved(FinderChoice::Auto))
    }

    /// The precision that it works in where the plan takes another one for the ladder only.
    fn precision(self, planned: Precision) -> Precision {
        match self {
            Self::Textbook(precision) | Self::SignChange(precision) => precision,
            Self::Ladder => planned,
            Self::Proved(_) => Precision::Double,
        }
    }
}

/// A method on one shape, family and difficulty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// What is hit.
    pub subject: Subject,
    /// Which rays.
    pub family: Family,
    /// Their difficulty as a power of ten.
    pub exponent: i32,
    /// How hits are found.
    pub method: Method,
    /// In which precision.
    pub precision: Precision,
    /// What came of it.
    pub score: Score,
}

impl Point {
    /// Whether the plan may stand here: what it takes is never wrong and leaves nothing undecided, and
    /// what claims to prove its answers is never wrong.
    pub fn is_safe(&self) -> bool {
        let Score {
            wrong, undecided, ..
        } = self.score;
        match self.method {
            Method::Textbook(_) | Method::SignChange(_) => true,
            Method::Proved(_) => wrong == 0 && (undecided == 0 || !self.method.is_planned()),
            Method::Ladder => wrong == 0 && undecided == 0,
        }
    }
}

/// Counts of each method over all points, by kind of shape, as a table for people.
pub fn summary(points: &[Point]) -> String {
    let mut text = String::new();
    for (kind, methods) in [("canonical", &CANONICAL[..]), ("implicit", &IMPLICIT[..])] {
        for method in methods {
            let own = points.iter().filter(|p| {
                let canonical = matches!(p.subject, Subject::Canonical(_));
                p.method == *method && canonical == (kind == "canonical")
            });
            let all = own.fold(Score::default(), |sum, p| sum.joined(p.score));
            let precision = match method {
                Method::Textbook(Precision::Single) | Method::SignChange(Precision::Single) => {
                    "f32"
                }
                Method::Ladder => "as planned",
                _ => "f64",
            };
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{kind:9} {:12} {precision:10} wrong {:6} undecided {:6} of {:6}, {:8.0} ns a ray",
                method.name(),
                all.wrong,
                all.undecided,
                all.rays,
                all.nanoseconds_a_ray()
            );
        }
    }
    text
}

/// All methods on a shape's rays of one family and difficulty.
pub fn points(subject: Subject, family: Family, exponent: i32, rays: usize) -> Vec<Point> {
    let Some(problem) = Problem::new(subject, family, exponent, rays) else {
        return Vec::new();
    };
    let planned = plan::precision(subject, &problem);
    let judged = [Precision::Single, Precision::Double].map(|p| Judged::new(subject, &problem, p));
    let methods = subject.methods().iter();
    methods
        .map(|&method| {
            let precision = method.precision(planned);
            let rays = &judged[usize::from(precision == Precision::Double)];
            Point {
                subject,
                family,
                exponent,
                method,
                precision,
                score: score(method, &problem, rays, precision),
            }
        })
        .collect()
}

/// All shapes, families and difficulties; `progress` is told of each shape and family.
pub fn run(rays: usize, mut progress: impl FnMut(Subject, Family)) -> Vec<Point> {
    let mut all = Vec::new();
    for subject in SUBJECTS {
        for family in FAMILIES {
            progress(subject, family);
            for exponent in family.exponents() {
                all.extend(points(subject, family, exponent, rays));
            }
        }
    }
    all
}

/// Rays as a precision holds them, with exact answers.
struct Judged {
    rays: Vec<(Ray, Option<First>)>,
    roundoff: f64,
}

impl Judged {
    fn new(subject: Subject, problem: &Problem, precision: Precision) -> Self {
        let rounded = |x: f64| match precision {
            Precision::Single => f64::from(x as f32),
            Precision::Double => x,
        };
        let rays = problem.cases.iter().map(|case| {
            let ray = Ray {
                origin: case.ray.origin.to_array().map(rounded).into(),
                direction: case.ray.direction.to_array().map(rounded).into(),
            };
            (ray, truth::first(subject, &problem.bodies, &Case { ray }))
        });
        Self {
            rays: rays.collect(),
            roundoff: match precision {
                Precision::Single => f32::ROUNDOFF,
                Precision::Double => f64::ROUNDOFF,
            },
        }
    }
}

/// What a method says.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Said {
    Hit { t: f64, body: usize },
    Miss,
    Undecided,
}

fn score(method: Method, problem: &Problem, judged: &Judged, precision: Precision) -> Score {
    let Some(mut finder) = Asked::new(method, problem) else {
        return Score::default();
    };
    let mut score = Score {
        rays: judged.rays.len() as u32,
        ..Score::default()
    };
    let mut said = Vec::with_capacity(judged.rays.len());
    for block in judged.rays.chunks(BLOCK) {
        let mut best = f64::INFINITY;
        let mut answers = Vec::new();
        for _ in 0..RUNS {
            let start = Instant::now();
            answers = block.iter().map(|(ray, _)| finder.first_hit(ray)).collect();
            best = best.min(start.elapsed().as_nanos() as f64);
        }
        score.nanoseconds += best;
        said.extend(answers);
    }
    for ((ray, first), said) in judged.rays.iter().zip(said) {
        score.undecided += u32::from(said == Said::Undecided);
        let right = match (said, first) {
            (Said::Undecided, _) | (Said::Miss, None) => true,
            (Said::Hit { t, body }, Some(first)) if method == Method::Ladder => {
                let place = problem.placed(ray, t, precision);
                body == first.body && problem.is_kept_apart(ray, first, place)
            }
            (Said::Hit { t, body }, Some(first)) => {
                // Eight roundings of t are what any arithmetic may lose at its end.
                let near = 8.0 * judged.roundoff * first.t.abs().max(t.abs());
                let within = (0.5 * first.gap).min(problem.same(ray));
                (body == first.body || first.gap <= near) && (t - first.t).abs() <= within.max(near)
            }
            _ => false,
        };
        score.wrong += u32::from(!right);
    }
    score
}

impl Problem {
    /// How far apart on a ray two answers may be that count as the same.
    fn same(&self, ray: &Ray) -> f64 {
        1e-3 * self.size / ray.direction.length()
    }

    /// Where a path of this precision would put a hit.
    fn placed(&self, ray: &Ray, t: f64, precision: Precision) -> DVec3 {
        let point = ray.origin + ray.direction * t - self.camera;
        match precision {
            Precision::Single => point.as_vec3().as_dvec3(),
            Precision::Double => point,
        }
    }

    /// Whether such a hit is nearer to where it belongs than to another body.
    fn is_kept_apart(&self, ray: &Ray, first: &First, place: DVec3) -> bool {
        let truth = self.placed(ray, first.t, Precision::Double);
        let within = (0.5 * first.other).min(self.same(ray)) * ray.direction.length();
        // What f64 itself does to coordinates of this size.
        let noise = 8.0 * f64::ROUNDOFF * (ray.origin.length() + self.camera.length());
        (place - truth).length() <= within + noise
    }
}

/// A method made ready for a problem.
enum Asked {
    Single(Vec<Textbook<f32>>),
    Double(Vec<Textbook<f64>>),
    Ladder(Vec<Placed>),
    Stepping(Ready, Affine, Precision),
    Proved(Box<PlacedImplicit>, Workspace),
}

impl Asked {
    fn new(method: Method, problem: &Problem) -> Option<Self> {
        let bodies = &problem.bodies;
        let body: &Body = bodies.first()?;
        Some(match method {
            Method::Textbook(Precision::Single) => Self::Single(textbooks(problem)?),
            Method::Textbook(Precision::Double) => Self::Double(textbooks(problem)?),
            Method::Ladder => {
                let placed = bodies
                    .iter()
                    .map(|b| Placed::new(b.kind?, &b.to_world).ok());
                Self::Ladder(placed.collect::<Option<_>>()?)
            }
            Method::SignChange(precision) => {
                let implicit = body.implicit.as_ref()?;
                let ready = Contestant::SignChange(precision, STEPS).of(implicit)?;
                Self::Stepping(ready, textbook::inverse(&body.to_world), precision)
            }
            Method::Proved(finder) => {
                let mut implicit = body.implicit.clone()?;
                implicit.finder = finder;
                let placed = PlacedImplicit::new(&implicit, &body.to_world).ok()?;
                Self::Proved(Box::new(placed), Workspace::default())
            }
        })
    }

    fn first_hit(&mut self, ray: &Ray) -> Said {
        match self {
            Self::Single(all) => nearest(all.iter().map(|one| one.first_hit(ray))),
            Self::Double(all) => nearest(all.iter().map(|one| one.first_hit(ray))),
            Self::Ladder(all) => {
                let mut tally = Tally::default();
                let hits = all.iter().map(|placed| {
                    let hit = placed.first_hit(ray, 0.0, Start::Free, &mut tally)?;
                    Some(hit.t)
                });
                nearest(hits)
            }
            Self::Stepping(ready, inverse, precision) => {
                let local = match precision {
                    Precision::Single => moved::<f32>(inverse, ray),
                    Precision::Double => moved::<f64>(inverse, ray),
                };
                match ready.first_hit(&local, 0.0, &mut Workspace::default()) {
                    crate::finders::Answer::Hit(t) => Said::Hit { t, body: 0 },
                    crate::finders::Answer::Miss => Said::Miss,
                    crate::finders::Answer::Undecided => Said::Undecided,
                }
            }
            Self::Proved(placed, workspace) => {
                let query = Query {
                    ray: *ray,
                    t_min: 0.0,
                    t_max: f64::INFINITY,
                };
                match placed.first_crossing(&query, workspace, &mut Tally::default()) {
                    ImplicitAnswer::Found(hit) => Said::Hit { t: hit.t, body: 0 },
                    ImplicitAnswer::Absent => Said::Miss,
                    ImplicitAnswer::Undecided => Said::Undecided,
                }
            }
        }
    }
}

fn textbooks<T: Scalar>(problem: &Problem) -> Option<Vec<Textbook<T>>> {
    let bodies = problem.bodies.iter();
    bodies
        .map(|b| Some(Textbook::new(b.kind?, &b.to_world)))
        .collect()
}

/// A ray in object coordinates, rounded.
fn moved<T: Scalar>(inverse: &Affine, ray: &Ray) -> Ray {
    let rows = inverse.rows.map(|row| row.map(T::from_f64));
    let [origin, direction] = textbook::local(&rows, ray).map(|v| v.map(T::to_f64).into());
    Ray { origin, direction }
}

/// The smallest t, and whose it is.
fn nearest(hits: impl Iterator<Item = Option<f64>>) -> Said {
    let mut first = Said::Miss;
    for (body, hit) in hits.enumerate() {
        let before = |t: f64| !matches!(first, Said::Hit { t: known, .. } if known <= t);
        if let Some(t) = hit.filter(|t| before(*t)) {
            first = Said::Hit { t, body };
        }
    }
    first
}
