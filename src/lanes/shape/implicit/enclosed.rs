//! First zeros of a field along rays by interval subdivision, for any expression.

use glam::DVec3;

use super::along::Along;
use super::certified::{Answers, Packet, Workspace};
use super::clip::{Clipped, clipped};
use super::finder::{Finder, Prover, RootFinder};
use super::{FinderChoice, Implicit};
use crate::field::interval_program::IntervalProgram;
use crate::field::over_box::survey;
use crate::field::tape::Tape;
use crate::math::double_double::DoubleDouble;
use crate::math::instructions::{DoubleLanes, Instructions, Job};
use crate::math::interval::ScalarInterval;
use crate::math::number::{Number, power_of_two};
use crate::math::packet::each;
use crate::math::scalar_lane::One;
use crate::root::interval::{self, Search, departure};
use crate::root::{Outcome, Root, sphere_trace};
use crate::shape::ladder::{Ladder, ScaledRay};
use crate::shape::line::LocalRay;
use crate::shape::{Ray, Tier};

/// Most evaluations for one ray: well above what separated zeros take (some tens), and about a
/// millisecond for a field of a dozen operations.
pub const WORK_BOUND: u32 = 2_000;

/// The factors of a field, as interval programs.
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

    /// With bounds of the factors' gradients over a box, which sphere tracing can use besides those along
    /// the ray.
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
        search.instructions.run(FirstZero {
            field: self,
            clipped: &clipped,
            searching: search,
        })
    }
}

#[derive(Debug, Clone, Copy)]
pub struct Searching {
    /// The zeros are the same with each.
    pub instructions: Instructions,
    pub method: Method,
    /// Most evaluations for each factor.
    pub bound: u32,
    /// For a ray that leaves this surface at t = 0, where the zero does not count: how far each local
    /// coordinate of its start may be from the exact hit's.
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

struct FirstZero<'a> {
    field: &'a EnclosedField,
    clipped: &'a Clipped,
    searching: &'a Searching,
}

impl FirstZero<'_> {
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

impl Job<f64> for FirstZero<'_> {
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

/// The earlier of the first zeros of two factors; where the enclosures overlap, what holds for both.
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

/// A field in the world with a finder that works with enclosures, asked in packets like the
/// certified polynomials.
#[derive(Debug, Clone)]
pub struct EnclosedPacket {
    field: EnclosedField,
    ladder: Ladder,
    inside: [DVec3; 2],
    method: Method,
    /// Largest sum of magnitudes of a row of the inverse map: local length of a world vector of
    /// components 1, rounded upward.
    largest_row: f64,
}

impl EnclosedPacket {
    pub fn new(implicit: &Implicit, ladder: &Ladder, method: Method) -> Self {
        // Entries rounded by ½ε and two sums are off by 1.5ε; 8ε leave room.
        let row = |row: &[DoubleDouble; 4]| {
            let sizes = row[..3].iter().map(|x| x.to_f64().abs());
            sizes.sum::<f64>() * (1.0 + 8.0 * f64::EPSILON)
        };
        let entries = ladder.double_double.inverse();
        let largest_row = entries.iter().map(row).fold(0.0, f64::max);
        let field = EnclosedField::new(&implicit.field.tape);
        Self {
            field: match method {
                Method::Subdivision => field,
                Method::Spheres => field.surveyed(&implicit.inside),
            },
            inside: implicit.inside,
            method,
            largest_row,
            ladder: ladder.clone(),
        }
    }

    /// The first hit of a world ray, t in units of its direction.
    pub fn first_hit(&self, ray: &Ray, limits: [f64; 2], searching: &Searching) -> Outcome {
        let scaled = ScaledRay::new(ray);
        let unit = power_of_two(scaled.exponent);
        let local = self.ladder.double_double.local(&scaled);
        let limits = limits.map(|t| (t * unit).clamp(-f64::MAX, f64::MAX));
        let search = self
            .field
            .first_hit(&local, &self.inside, limits, searching);
        match search.outcome {
            Outcome::Found(mut root) => {
                let [low, high] = root.enclosure.map(|t| unscaled(t, unit));
                root.enclosure = [low[0], high[1]];
                if root.enclosure.iter().all(|t| t.is_finite()) {
                    Outcome::Found(root)
                } else {
                    Outcome::Undecided
                }
            }
            other => other,
        }
    }
}

impl Prover for EnclosedPacket {
    fn first_hits(&self, packet: &Packet, _sharp: bool, workspace: &mut Workspace) -> Answers {
        let mut answers = Answers::default();
        for lane in each(packet.active) {
            let ray = packet.ray(lane);
            // Up to 2³ roundings of the largest coordinate on the way to the point of a hit (distance,
            // product, sum, map), and as many on the way back.
            let extent = ray.origin.abs().max_element();
            let shift = 16.0 * packet.roundoff * extent * self.largest_row;
            let leaving = packet.leaving >> lane & 1 == 1;
            let searching = Searching {
                instructions: workspace.instructions,
                method: self.method,
                bound: WORK_BOUND,
                leaving: leaving.then_some(shift),
            };
            let bit = 1 << lane;
            match self.first_hit(&ray, [packet.t_min[lane], packet.t_max[lane]], &searching) {
                Outcome::Undecided => {}
                Outcome::Absent => answers.absent |= bit,
                Outcome::Found(root) => {
                    let [low, high] = root.enclosure;
                    answers.found |= bit;
                    answers.t[lane] = low + 0.5 * (high - low);
                    [answers.low[lane], answers.high[lane]] = [low, high];
                    answers.multiplicity[lane] = root.multiplicity.unwrap_or(0);
                    answers.tiers[lane] = Tier::Double;
                }
            }
        }
        answers
    }
}

/// Interval subdivision.
pub struct Interval;

impl RootFinder for Interval {
    const NAME: &'static str = "interval";
    const WORDS: &'static str =
        "interval enclosures in lanes of f64, cut until each answer is proved";

    fn place(implicit: &Implicit, ladder: &Ladder) -> Finder {
        let placed = EnclosedPacket::new(implicit, ladder, Method::Subdivision);
        Finder::proved(FinderChoice::Interval, placed)
    }
}

/// Sphere tracing.
pub struct SphereTrace;

impl RootFinder for SphereTrace {
    const NAME: &'static str = "sphere-trace";
    const WORDS: &'static str = "steps as long as a proved Lipschitz bound allows";

    fn place(implicit: &Implicit, ladder: &Ladder) -> Finder {
        let placed = EnclosedPacket::new(implicit, ladder, Method::Spheres);
        Finder::proved(FinderChoice::SphereTrace, placed)
    }
}

/// t / unit, exact unless it leaves the range of normal numbers.
fn unscaled(t: f64, unit: f64) -> [f64; 2] {
    let quotient = t / unit;
    if quotient * unit == t {
        return [quotient; 2];
    }
    let bounds = ScalarInterval::splat(One, [t; 2]) / ScalarInterval::splat(One, [unit; 2]);
    [bounds.low, bounds.high]
}
