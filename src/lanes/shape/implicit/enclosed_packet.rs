//! Enclosed fields placed in the world, asked in packets like the certified polynomials.

use glam::DVec3;

use super::certified::{Answers, Packet};
use super::enclosed::{EnclosedField, Method, Searching, WORK_BOUND};
use crate::math::affine::Affine;
use crate::math::double_double::DoubleDouble;
use crate::math::instructions::Instructions;
use crate::math::interval::ScalarInterval;
use crate::math::number::{Number, power_of_two};
use crate::math::packet::each;
use crate::math::scalar_lane::One;
use crate::root::Outcome;
use crate::shape::implicit::Implicit;
use crate::shape::ladder::{Ladder, ScaledRay};
use crate::shape::{Ray, SingularMatrix, Tier};

/// A field in the world with a finder that works with enclosures.
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
    /// To be searched by interval subdivision.
    ///
    /// # Errors
    /// [`SingularMatrix`] where the matrix is singular or has an entry that is not finite.
    pub fn by_subdivision(implicit: &Implicit, to_world: &Affine) -> Result<Self, SingularMatrix> {
        Self::new(implicit, to_world, Method::Subdivision)
    }

    /// To be searched by sphere tracing.
    ///
    /// # Errors
    /// [`SingularMatrix`] where the matrix is singular or has an entry that is not finite.
    pub fn by_spheres(implicit: &Implicit, to_world: &Affine) -> Result<Self, SingularMatrix> {
        let mut placed = Self::new(implicit, to_world, Method::Spheres)?;
        placed.field = placed.field.surveyed(&implicit.inside);
        Ok(placed)
    }

    fn new(implicit: &Implicit, to_world: &Affine, method: Method) -> Result<Self, SingularMatrix> {
        let ladder = Ladder::new(to_world)?;
        let row = |row: &[DoubleDouble; 4]| {
            let sizes = row[..3].iter().map(|x| x.to_f64().abs());
            sizes.sum::<f64>() * (1.0 + 8.0 * f64::EPSILON)
        };
        let entries = ladder.double_double.inverse();
        let largest_row = entries.iter().map(row).fold(0.0, f64::max);
        Ok(Self {
            field: EnclosedField::new(&implicit.field.tape),
            inside: implicit.inside,
            method,
            largest_row,
            ladder,
        })
    }

    pub fn first_hits(&self, instructions: Instructions, packet: &Packet) -> Answers {
        let mut answers = Answers::default();
        for lane in each(packet.active) {
            self.answer(instructions, packet, lane, &mut answers);
        }
        answers
    }

    fn answer(
        &self,
        instructions: Instructions,
        packet: &Packet,
        lane: usize,
        answers: &mut Answers,
    ) {
        let ray = packet.ray(lane);
        let leaving = packet.leaving >> lane & 1 == 1;
        // The point of a hit is rounded some times (distance, product, sum, the way back): 2³
        // units of its largest coordinate, and as much again for the way there.
        let extent = ray.origin.abs().max_element();
        let shift = 16.0 * packet.roundoff * extent * self.largest_row;
        let searching = Searching {
            instructions,
            method: self.method,
            bound: WORK_BOUND,
            leaving: leaving.then_some(shift),
        };
        let outcome = self.first_hit(&ray, [packet.t_min[lane], packet.t_max[lane]], &searching);
        let bit = 1 << lane;
        match outcome {
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

    /// The first hit of a world ray, t in units of its direction.
    pub fn first_hit(&self, ray: &Ray, limits: [f64; 2], searching: &Searching) -> Outcome {
        let scaled = ScaledRay::new(ray);
        let unit = power_of_two(scaled.exponent());
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

/// t / unit, exact unless it leaves the range of normal numbers.
fn unscaled(t: f64, unit: f64) -> [f64; 2] {
    let quotient = t / unit;
    if quotient * unit == t {
        return [quotient; 2];
    }
    let bounds = ScalarInterval::splat(One, [t; 2]) / ScalarInterval::splat(One, [unit; 2]);
    [bounds.low, bounds.high]
}
