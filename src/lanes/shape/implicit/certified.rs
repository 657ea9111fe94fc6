//! Polynomial surfaces with proved hits, in tiers: f64 lanes, double-double lanes, exact integers.
//!
//! The ray is clipped to a box outside of which the surface is proved not to lie, the field expanded
//! into Bernstein coefficients between the two ends, and the first root isolated with certain signs
//! ([`crate::root::bernstein`]). One number a ray bounds the coefficients' errors: a constant of
//! the surface (see [`crate::field::program::bounds`]), and another one times the distance between the
//! rounded local ends and the exact ones. Rays that f64 leaves undecided are asked again in
//! double-double, and the rest exactly.

mod exact;
mod kernel;
mod normal;
mod place;

use glam::DVec3;

pub use place::Certified;

use super::enclosed::Interval;
use super::finder::{Finder, Prover, RootFinder};
use super::{FinderChoice, Implicit};
use crate::field::tape::Tape;
use crate::math::instructions::{DoubleLanes, Instructions, Job};
use crate::math::number::{binary_exponent, power_of_two};
use crate::math::packet::each;
use crate::math::words::{Pair, Plain, Row};
use crate::root::exact::ExactRoot;
use crate::shape::ladder::Ladder;
use crate::shape::{Ray, Tier};

pub const WIDTH: usize = 8;

/// Eight rays and their limits.
#[derive(Debug, Clone, Copy)]
pub struct Packet {
    /// World coordinates, by axis.
    pub origin: [[f64; WIDTH]; 3],
    /// By axis; any length but zero.
    pub direction: [[f64; WIDTH]; 3],
    /// Hits count after this, and at it where it is 0.
    pub t_min: [f64; WIDTH],
    /// Hits count before this.
    pub t_max: [f64; WIDTH],
    /// Rays to test, by bit.
    pub active: u32,
    /// Rays that leave this surface: `t_min` is 0 and the root there does not count.
    pub leaving: u32,
    /// Unit roundoff with which the origins of these were rounded.
    pub roundoff: f64,
    /// How many times `t_max` is known to be a root of the only factor, in all lanes.
    pub roots_at_end: usize,
}

impl Default for Packet {
    fn default() -> Self {
        Self {
            origin: [[0.0; WIDTH]; 3],
            direction: [[1.0; WIDTH]; 3],
            t_min: [0.0; WIDTH],
            t_max: [f64::INFINITY; WIDTH],
            active: 0,
            leaving: 0,
            roundoff: f64::EPSILON / 2.0,
            roots_at_end: 0,
        }
    }
}

impl Packet {
    pub fn set(&mut self, lane: usize, origin: DVec3, direction: DVec3, limits: [f64; 2]) {
        for axis in 0..3 {
            self.origin[axis][lane] = origin[axis];
            self.direction[axis][lane] = direction[axis];
        }
        [self.t_min[lane], self.t_max[lane]] = limits;
        self.active |= 1 << lane;
    }

    pub(super) fn ray(&self, lane: usize) -> Ray {
        let at = |v: &[[f64; WIDTH]; 3]| DVec3::from_array(v.map(|axis| axis[lane]));
        Ray {
            origin: at(&self.origin),
            direction: at(&self.direction),
        }
    }
}

#[derive(Debug, Clone, Copy, Default)]
pub struct Answers {
    pub found: u32,
    pub absent: u32,
    /// In units of the direction.
    pub t: [f64; WIDTH],
    /// Bounds of t.
    pub low: [f64; WIDTH],
    pub high: [f64; WIDTH],
    /// Multiplicity of the root; 0 where it is not known.
    pub multiplicity: [u32; WIDTH],
    pub tiers: [Tier; WIDTH],
    /// Lanes whose enclosure is wider than [`SHARP`] times the clipped stretch.
    blurred: u32,
    /// Where the search ended in undecided lanes, and the length of the clipped ray.
    doubt: [f64; WIDTH],
    stretch: [f64; WIDTH],
}

/// Width of an enclosure that counts as sharp, relative to the clipped stretch of the ray: half of
/// it is what t may be off by.
pub const SHARP: f64 = 1e-12;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Enclosures that f64 leaves blurred are sharpened in double-double.
    pub sharp: bool,
    /// What double-double leaves undecided is decided exactly.
    pub exact: bool,
}

#[derive(Debug)]
pub struct Workspace {
    /// The answers are the same with each.
    pub instructions: Instructions,
    rows: Vec<Row>,
}

impl Workspace {
    pub fn new(instructions: Instructions) -> Self {
        Self {
            instructions,
            rows: Vec::new(),
        }
    }
}

/// With the best instruction set that this machine has.
impl Default for Workspace {
    fn default() -> Self {
        Self::new(Instructions::best())
    }
}

struct Ask<'a> {
    placed: &'a Certified,
    packet: &'a Packet,
    asked: u32,
    /// In double-double.
    sharper: bool,
    rows: &'a mut [Row],
}

impl Job<f64> for Ask<'_> {
    type Output = Answers;

    #[inline(always)]
    fn run<L: DoubleLanes>(self, l: L) -> Answers {
        if self.sharper {
            kernel::first_hits::<_, Pair<_>>(l, self)
        } else {
            kernel::first_hits::<_, Plain<_>>(l, self)
        }
    }
}

impl Certified {
    /// The first hits of a packet, by the cheapest arithmetic that is certain of each.
    pub fn first_hits(
        &self,
        packet: &Packet,
        effort: Effort,
        workspace: &mut Workspace,
    ) -> Answers {
        let mut answers = self.in_lanes(packet, packet.active, false, workspace);
        let mut open = packet.active & !(answers.found | answers.absent);
        let blurred = if effort.sharp {
            answers.blurred & answers.found
        } else {
            0
        };
        let again = open | blurred;
        if again != 0 {
            let sharper = self.in_lanes(packet, again, true, workspace);
            let decided = sharper.found | sharper.absent;
            for lane in each(again & (open | decided)) {
                answers.tiers[lane] = Tier::DoubleDouble;
                answers.take(&sharper, lane);
            }
            open &= !decided;
        }
        if effort.exact {
            for lane in each(open) {
                answers.tiers[lane] = Tier::Exact;
                if !self.multiple_root(packet, lane, &mut answers, workspace) {
                    self.decide(packet, lane, &mut answers);
                }
            }
        }
        answers
    }

    /// The first hit of a ray by exact arithmetic alone.
    pub fn exactly(&self, ray: &Ray, limits: [f64; 2]) -> Option<ExactRoot> {
        exact::first_hit(self, ray, limits, None, f64::NAN)
    }

    fn in_lanes(
        &self,
        packet: &Packet,
        asked: u32,
        sharper: bool,
        workspace: &mut Workspace,
    ) -> Answers {
        let rows = self.factors.iter().map(|factor| factor.program.rows);
        let rows = rows.max().unwrap_or(0) * if sharper { 2 } else { 1 };
        if workspace.rows.len() < rows {
            workspace.rows.resize(rows, Row::default());
        }
        workspace.instructions.run(Ask {
            placed: self,
            packet,
            asked,
            sharper,
            rows: &mut workspace.rows,
        })
    }

    /// Tries whether the first hit of an undecided ray is a multiple root at a t of few bits close
    /// to where the search ended, as where a ray passes through a node. Its multiplicity is decided
    /// exactly; that no root comes before it, by signs of the polynomial with this root divided out.
    /// Returns whether the ray is decided.
    #[cold]
    fn multiple_root(
        &self,
        packet: &Packet,
        lane: usize,
        answers: &mut Answers,
        workspace: &mut Workspace,
    ) -> bool {
        let [factor] = self.factors.as_slice() else {
            return false;
        };
        if packet.leaving >> lane & 1 == 1 {
            return false;
        }
        let (doubt, stretch) = (answers.doubt[lane], answers.stretch[lane]);
        let ray = packet.ray(lane);
        for width in GUESS_WIDTHS {
            let Some(t) = simplest(doubt - width * stretch, doubt + width * stretch) else {
                continue;
            };
            if t <= packet.t_min[lane] || t >= packet.t_max[lane] || !self.surely_inside(&ray, t) {
                continue;
            }
            let multiplicity = exact::order_of_vanishing(self, &factor.program, &ray, t);
            if multiplicity < 2 || multiplicity > factor.program.result.degree {
                continue;
            }
            let mut before = Packet {
                roots_at_end: multiplicity,
                ..*packet
            };
            before.t_max[lane] = t;
            for sharper in [false, true] {
                let found = self.in_lanes(&before, 1 << lane, sharper, workspace);
                if found.absent >> lane & 1 == 1 {
                    answers.found |= 1 << lane;
                    answers.t[lane] = t;
                    (answers.low[lane], answers.high[lane]) = (t, t);
                    answers.multiplicity[lane] = multiplicity as u32 * factor.power;
                    return true;
                }
                if found.found >> lane & 1 == 1 {
                    answers.take(&found, lane);
                    return true;
                }
            }
        }
        false
    }

    /// Whether the point at t is in the clip box with room to spare.
    fn surely_inside(&self, ray: &Ray, t: f64) -> bool {
        let p = ray.at(t);
        (0..3).all(|i| {
            let row = &self.inverse[0].rows[i];
            let x = row[0][0] * p.x + row[1][0] * p.y + row[2][0] * p.z + row[3][0];
            x - self.clip[0][i] > self.margin && self.clip[1][i] - x > self.margin
        })
    }

    #[cold]
    fn decide(&self, packet: &Packet, lane: usize, answers: &mut Answers) {
        let ray = packet.ray(lane);
        let start = (packet.leaving >> lane & 1 == 1).then_some(packet.roundoff);
        let limits = [packet.t_min[lane], packet.t_max[lane]];
        let bit = 1 << lane;
        match exact::first_hit(self, &ray, limits, start, answers.doubt[lane]) {
            Some(root) => {
                answers.found |= bit;
                answers.absent &= !bit;
                answers.t[lane] = root.t;
                [answers.low[lane], answers.high[lane]] = root.enclosure;
                answers.multiplicity[lane] = root.multiplicity.unwrap_or(0);
            }
            None => {
                answers.absent |= bit;
                answers.found &= !bit;
            }
        }
    }
}

impl Answers {
    /// Takes a lane of other answers, all but its tier.
    fn take(&mut self, from: &Self, lane: usize) {
        let bit = 1 << lane;
        self.found = self.found & !bit | from.found & bit;
        self.absent = self.absent & !bit | from.absent & bit;
        self.t[lane] = from.t[lane];
        self.low[lane] = from.low[lane];
        self.high[lane] = from.high[lane];
        self.multiplicity[lane] = from.multiplicity[lane];
        self.doubt[lane] = from.doubt[lane];
        self.stretch[lane] = from.stretch[lane];
    }
}

/// Distances, relative to the stretch, within which a root is guessed near the end of a search: a double
/// root is found to at most half of a double-double's digits, a triple one to a third.
const GUESS_WIDTHS: [f64; 2] = [1.0 / (1u64 << 34) as f64, 1.0 / (1u64 << 22) as f64];

/// The number with the fewest bits in an interval.
fn simplest(low: f64, high: f64) -> Option<f64> {
    if !(low < high && low.is_finite() && high.is_finite()) {
        return None;
    }
    if low <= 0.0 && high >= 0.0 {
        return Some(0.0);
    }
    if high < 0.0 {
        return simplest(-high, -low).map(|x| -x);
    }
    let mut step = power_of_two(binary_exponent(high));
    loop {
        let x = (high / step).floor() * step;
        if x >= low {
            return Some(x);
        }
        step *= 0.5;
    }
}

/// A polynomial surface and how far its finder goes.
#[derive(Debug)]
struct Tiers {
    certified: Certified,
    /// Whether what double-double leaves undecided is decided exactly.
    exact: bool,
}

impl Prover for Tiers {
    fn first_hits(&self, packet: &Packet, sharp: bool, workspace: &mut Workspace) -> Answers {
        let exact = self.exact;
        let effort = Effort { sharp, exact };
        self.certified.first_hits(packet, effort, workspace)
    }

    fn gradient_direction(&self, tape: &Tape, ray: &Ray, enclosure: [f64; 2]) -> Option<DVec3> {
        self.certified.gradient_direction(tape, ray, enclosure)
    }
}

/// Certified isolation for polynomials, interval subdivision for other fields.
fn placed(implicit: &Implicit, ladder: &Ladder, exact: bool) -> Finder {
    match Certified::new(&implicit.field.tape, implicit.inside, ladder) {
        Some(certified) => Finder::proved(FinderChoice::Polynomial, Tiers { certified, exact }),
        None => Interval::place(implicit, ladder),
    }
}

/// The finder that suits the field.
pub struct Auto;

impl RootFinder for Auto {
    const NAME: &'static str = "auto";
    const WORDS: &'static str = "the finder that suits the field";

    fn place(implicit: &Implicit, ladder: &Ladder) -> Finder {
        placed(implicit, ladder, true)
    }
}

/// Isolation of the roots of a polynomial along the ray, without the last, exact tier.
pub struct Polynomial;

impl RootFinder for Polynomial {
    const NAME: &'static str = "polynomial";
    const WORDS: &'static str =
        "certified roots of polynomials: in lanes of f64, then of double-double, then exactly";
    const ANY_FIELD: bool = false;

    fn place(implicit: &Implicit, ladder: &Ladder) -> Finder {
        placed(implicit, ladder, false)
    }
}
