//! All root finders over rays whose first hits are known: how often wrong, how often undecided,
//! and how long a ray takes.

pub mod chart;
pub mod map;
mod march;
mod oracle;
mod shapes;

use std::sync::Arc;
use std::time::Instant;

use etalon::inside::field::expression::Expression;
use etalon::inside::math::affine::Affine;
pub use etalon::inside::math::instructions::Precision;
use etalon::inside::scene::{FinderChoice, Implicit};
use etalon::inside::shape::implicit::certified::Workspace;
use etalon::inside::shape::implicit::placed::{ImplicitAnswer, PlacedImplicit};
use etalon::inside::shape::{Query, Ray, Tally};
use glam::DVec3;

use march::March;
pub use oracle::{Oracle, OracleError, OracleRay};
pub use shapes::OracleShape;

/// The classes of rays, in the order of the chart's panels.
pub const CLASSES: [&str; 7] = [
    "ordinary",
    "axis",
    "graze",
    "near_singular",
    "singular",
    "start_on",
    "far",
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contestant {
    /// Equal steps and bisection.
    SignChange(Precision, u32),
    /// One that proves its answers, in f64 and, where it climbs, above.
    Proved(FinderChoice),
}

/// All that take part: the steps swept for the first kind.
pub const CONTESTANTS: [Contestant; 12] = [
    Contestant::SignChange(Precision::Single, 100),
    Contestant::SignChange(Precision::Single, 256),
    Contestant::SignChange(Precision::Single, 1_000),
    Contestant::SignChange(Precision::Single, 10_000),
    Contestant::SignChange(Precision::Double, 100),
    Contestant::SignChange(Precision::Double, 256),
    Contestant::SignChange(Precision::Double, 1_000),
    Contestant::SignChange(Precision::Double, 10_000),
    Contestant::Proved(FinderChoice::SphereTrace),
    Contestant::Proved(FinderChoice::Interval),
    Contestant::Proved(FinderChoice::Polynomial),
    Contestant::Proved(FinderChoice::Auto),
];

impl Contestant {
    pub fn name(self) -> &'static str {
        match self {
            Self::SignChange(..) => "sign-change",
            Self::Proved(choice) => choice.name(),
        }
    }

    /// The arithmetic it begins with.
    pub fn precision(self) -> Precision {
        match self {
            Self::SignChange(precision, _) => precision,
            Self::Proved(_) => Precision::Double,
        }
    }

    /// Steps, of the one that steps, and nothing of the others.
    pub fn steps(self) -> String {
        match self {
            Self::SignChange(_, steps) => steps.to_string(),
            Self::Proved(_) => String::new(),
        }
    }

    pub fn is_proved(self) -> bool {
        matches!(self, Self::Proved(_))
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    Hit(f64),
    Miss,
    Undecided,
}

/// A surface within the cube [−half, half]³, with the finder that the plan takes.
pub fn implicit(field: &Arc<Expression>, half: f64) -> Implicit {
    Implicit {
        name: None,
        field: Arc::clone(field),
        inside: [DVec3::splat(-half), DVec3::splat(half)],
        closed: false,
        finder: FinderChoice::Auto,
        steps: 256,
    }
}

/// A surface ready for one contestant.
pub enum Ready {
    Single(March<f32>),
    Double(March<f64>),
    Proved(Box<PlacedImplicit>),
}

impl Contestant {
    /// Prepares a surface; `None` where it cannot be placed.
    pub fn ready(self, shape: &OracleShape) -> Option<Ready> {
        self.of(&implicit(&shape.field, shape.half_width), &Affine::IDENTITY)
    }

    /// Prepares a surface whose box is a cube about the origin; what steps does so in object
    /// coordinates.
    pub fn of(self, implicit: &Implicit, to_world: &Affine) -> Option<Ready> {
        let (tape, half_width) = (&implicit.field.tape, implicit.inside[1].x);
        Some(match self {
            Self::SignChange(Precision::Single, steps) => {
                Ready::Single(March::new(tape, half_width, steps))
            }
            Self::SignChange(Precision::Double, steps) => {
                Ready::Double(March::new(tape, half_width, steps))
            }
            Self::Proved(finder) => {
                let implicit = Implicit {
                    finder,
                    ..implicit.clone()
                };
                let placed = PlacedImplicit::new(&implicit, to_world);
                Ready::Proved(Box::new(placed.ok()?))
            }
        })
    }
}

impl Ready {
    /// The first hit with t > `t_min`, or at it where it is 0.
    pub fn first_hit(&self, ray: &Ray, t_min: f64, workspace: &mut Workspace) -> Answer {
        match self {
            Self::Single(march) => march.first_hit(ray, t_min),
            Self::Double(march) => march.first_hit(ray, t_min),
            Self::Proved(placed) => {
                let query = Query {
                    ray: *ray,
                    t_min,
                    t_max: f64::INFINITY,
                };
                match placed.first_crossing(&query, workspace, &mut Tally::default()) {
                    ImplicitAnswer::Found(hit) => Answer::Hit(hit.t),
                    ImplicitAnswer::Absent => Answer::Miss,
                    ImplicitAnswer::Undecided => Answer::Undecided,
                }
            }
        }
    }
}

/// What a contestant did with the rays of a class.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Score {
    pub rays: u32,
    /// Answers that are not the truth.
    pub wrong: u32,
    /// Rays that it could not decide.
    pub undecided: u32,
    /// Time for all of them, ns.
    pub nanoseconds: f64,
}

impl Score {
    pub fn wrong_share(&self) -> f64 {
        f64::from(self.wrong) / f64::from(self.rays.max(1))
    }

    pub fn undecided_share(&self) -> f64 {
        f64::from(self.undecided) / f64::from(self.rays.max(1))
    }

    pub fn nanoseconds_a_ray(&self) -> f64 {
        self.nanoseconds / f64::from(self.rays.max(1))
    }

    pub fn joined(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            wrong: self.wrong + other.wrong,
            undecided: self.undecided + other.undecided,
            nanoseconds: self.nanoseconds + other.nanoseconds,
        }
    }
}

/// One contestant's scores by class.
#[derive(Debug, Clone, PartialEq)]
pub struct Result {
    pub contestant: Contestant,
    /// By class, as in [`CLASSES`].
    pub scores: [Score; CLASSES.len()],
}

impl Result {
    pub fn all(&self) -> Score {
        let scores = self.scores.into_iter();
        scores.fold(Score::default(), Score::joined)
    }
}

/// Runs one contestant over all rays, on this thread.
pub fn run(contestant: Contestant, oracle: &Oracle) -> Result {
    let mut scores = [Score::default(); CLASSES.len()];
    let mut workspace = Workspace::default();
    for shape in &oracle.shapes {
        let Some(ready) = contestant.ready(shape) else {
            continue;
        };
        for (class, score) in CLASSES.iter().zip(&mut scores) {
            let rays: Vec<&OracleRay> = oracle.rays_of(&shape.name, class).collect();
            *score = score.joined(timed(&ready, shape, &rays, &mut workspace));
        }
    }
    Result { contestant, scores }
}

/// The rays of one shape and class; answers are judged after the clock has stopped.
fn timed(
    ready: &Ready,
    shape: &OracleShape,
    rays: &[&OracleRay],
    workspace: &mut Workspace,
) -> Score {
    let start = Instant::now();
    let answers: Vec<Answer> = rays
        .iter()
        .map(|ray| ready.first_hit(&ray.ray, ray.t_min, workspace))
        .collect();
    let mut score = Score {
        rays: rays.len() as u32,
        nanoseconds: start.elapsed().as_nanos() as f64,
        ..Score::default()
    };
    for (ray, answer) in rays.iter().zip(answers) {
        match answer {
            Answer::Undecided => score.undecided += 1,
            answer if !ray.is_right(answer, shape.half_width) => score.wrong += 1,
            _ => {}
        }
    }
    score
}
