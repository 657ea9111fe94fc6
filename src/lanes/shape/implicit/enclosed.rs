//! First zeros of a field along rays by interval subdivision, for any expression.

use glam::DVec3;

use super::along::Along;
use super::clip::{Clipped, clipped};
use crate::field::interval_program::IntervalProgram;
use crate::field::over_box::survey;
use crate::field::tape::Tape;
use crate::math::double_double::DoubleDouble;
use crate::math::instructions::{DoubleLanes, Instructions, Job};
use crate::math::interval::ScalarInterval;
use crate::math::scalar_lane::One;
use crate::root::interval::{self, Search, departure};
use crate::root::{Outcome, Root, sphere_trace};
use crate::shape::line::LocalRay;

/// Most evaluations for one ray: well above what separated zeros need (some tens), and about a
/// millisecond for a field of a dozen operations.
pub const WORK_BOUND: u32 = 2_000;

/// A field made ready for interval subdivision, as its factors.
#[derive(Debug, Clone)]
pub struct EnclosedField {
    factors: Vec<EnclosedFactor>,
}

#[derive(Debug, Clone)]
struct EnclosedFactor {
    program: IntervalProgram,
    multiplicity: u32,
    /// An upper bound of its gradient's length over the box, where it is known.
    steepness: f64,
}

impl EnclosedFactor {
    fn new(tape: &Tape, multiplicity: u32) -> Self {
        Self {
            program: IntervalProgram::new(tape),
            multiplicity,
            steepness: f64::INFINITY,
        }
    }
}

impl EnclosedField {
    pub fn new(tape: &Tape) -> Self {
        let parts = tape.factors().factors;
        let parts = parts.iter();
        let mut factors: Vec<EnclosedFactor> = parts
            .map(|part| EnclosedFactor::new(&part.tape, part.multiplicity))
            .collect();
        // A zero of one factor is one of the product only where the others are defined.
        let total = factors.iter().all(|factor| factor.program.is_total());
        if factors.len() != 1 && !total {
            factors = vec![EnclosedFactor::new(tape, 1)];
        }
        Self { factors }
    }

    /// With bounds of the factors' gradients over a box, which sphere tracing can use besides
    /// those along the ray. The bound of a product is none of its factors.
    pub fn surveyed(mut self, inside: &[DVec3; 2]) -> Self {
        for factor in &mut self.factors {
            factor.steepness = survey(Instructions::best(), &factor.program, inside).steepness;
        }
        self
    }

    /// The first zero on a ray inside a closed box with t_min < t < t_max, by a search.
    pub fn first_hit(
        &self,
        ray: &LocalRay<DoubleDouble>,
        inside: &[DVec3; 2],
        limits: [f64; 2],
        search: &Searching,
    ) -> Search {
        let Some(clipped) = clipped(ray, inside, limits) else {
            return Search::new(Outcome::Absent, 0);
        };
        search.instructions.run(First {
            field: self,
            clipped: &clipped,
            searching: search,
        })
    }
}

#[derive(Debug, Clone, Copy)]
pub struct Searching {
    /// In which instructions; the zeros are the same with each.
    pub instructions: Instructions,
    pub method: Method,
    /// Most evaluations for each factor.
    pub bound: u32,
    /// For a ray that leaves this very surface at t = 0: how far each local coordinate of its
    /// start may be from the true hit's. The zero there does not count.
    pub leaving: Option<f64>,
}

impl Default for Searching {
    fn default() -> Self {
        Self {
            instructions: Instructions::best(),
            method: Method::Subdivision,
            bound: WORK_BOUND,
            leaving: None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    Subdivision,
    Spheres,
}

struct First<'a> {
    field: &'a EnclosedField,
    clipped: &'a Clipped,
    searching: &'a Searching,
}

impl First<'_> {
    /// The search of one factor, from where it may begin.
    #[inline(always)]
    fn search<L: DoubleLanes>(&self, lanes: L, factor: &EnclosedFactor, to: f64) -> Search {
        let program = &factor.program;
        let line = &self.clipped.line;
        let mut along = Along::new(lanes, program, line);
        let from = match self.searching.leaving {
            None => Some(0.0),
            Some(shift) => {
                let blurred = line.blurred(shift);
                let mut blurred = Along::new(lanes, program, &blurred);
                departure(&mut blurred, &mut along, to)
            }
        };
        let Some(from) = from else {
            return Search::new(Outcome::Undecided, 4);
        };
        if from >= to {
            return Search::new(Outcome::Absent, 2);
        }
        let bound = self.searching.bound;
        match self.searching.method {
            Method::Subdivision => interval::first_zero(&mut along, [from, to], bound),
            Method::Spheres => {
                let lipschitz = factor.steepness * speed(self.clipped) * (1.0 + 4.0 * f64::EPSILON);
                sphere_trace::first_zero(&mut along, [from, to], lipschitz, bound)
            }
        }
    }
}

impl Job<f64> for First<'_> {
    type Output = Search;

    #[inline(always)]
    fn run<L: DoubleLanes>(self, lanes: L) -> Search {
        let clipped = self.clipped;
        let length = point(clipped.far[1]) - point(clipped.start);
        let mut to = length.high;
        let mut first: Option<Root> = None;
        let mut evaluations = 0;
        for factor in &self.field.factors {
            let search = self.search(lanes, factor, to);
            evaluations += search.evaluations;
            match search.outcome {
                Outcome::Absent => {}
                Outcome::Undecided => {
                    return Search::new(Outcome::Undecided, evaluations);
                }
                Outcome::Found(root) => {
                    let root = Root {
                        multiplicity: root.multiplicity.map(|m| m * factor.multiplicity),
                        ..root
                    };
                    let joined = first.map_or(root, |first| earlier(&first, &root));
                    to = joined.enclosure[1];
                    first = Some(joined);
                }
            }
        }
        let outcome = first.map_or(Outcome::Absent, |root| placed(clipped, &root));
        Search::new(outcome, evaluations)
    }
}

/// An upper bound of the direction's length.
fn speed(clipped: &Clipped) -> f64 {
    let d = clipped
        .line
        .direction
        .map(|d| ScalarInterval::splat(One, d));
    let squares = d[0].squared() + d[1].squared() + d[2].squared();
    squares.square_root().high
}

fn point(x: f64) -> ScalarInterval {
    ScalarInterval::point(One, x)
}

/// The earlier of the first zeros of two factors; which it is stays open where the enclosures
/// overlap.
fn earlier(a: &Root, b: &Root) -> Root {
    if a.enclosure[1] < b.enclosure[0] {
        return *a;
    }
    if b.enclosure[1] < a.enclosure[0] {
        return *b;
    }
    Root {
        enclosure: [0, 1].map(|i| a.enclosure[i].min(b.enclosure[i])),
        multiplicity: None,
    }
}

/// A zero in s as one in t, if it surely is within the stretch.
fn placed(clipped: &Clipped, root: &Root) -> Outcome {
    let [s_low, s_high] = root.enclosure;
    let low = (point(clipped.start) + point(s_low))
        .low
        .max(clipped.near[0]);
    let high = (point(clipped.start) + point(s_high)).high;
    if low > clipped.far[1] {
        return Outcome::Absent;
    }
    let within = low >= clipped.near[1] && high <= clipped.far[0];
    if !within {
        return Outcome::Undecided;
    }
    Outcome::Found(Root {
        enclosure: [low, high],
        multiplicity: root.multiplicity,
    })
}
