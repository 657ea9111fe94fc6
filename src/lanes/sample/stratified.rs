//! Jittered samples: one in each stratum, the strata visited in a random order by pixel and slot.

use super::Slot;
use super::independent::two;
use super::kind::Sampler;
use super::permute::permute;
use super::sequence::{Identity, Sequence};
use crate::math::lanes::{Lanes, Real};

/// Strata visited in a random order by pixel and slot.
pub struct Stratified;

impl Sampler for Stratified {
    const NAME: &'static str = "stratified";
    const WORDS: &'static str = "strata";
    const NEEDS_COUNT: bool = true;

    #[inline(always)]
    fn single<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>, slot: Slot) -> L::Real {
        let seed = sequence.slot_seed(l, id, slot);
        let stratum = permute(l, id.index, sequence.points, seed);
        let [jitter, _] = two(l, id, slot);
        below_one(
            l,
            (l.to_real(stratum) + jitter) / l.real(sequence.points.into()),
        )
    }

    #[inline(always)]
    fn pair<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>, slot: Slot) -> [L::Real; 2] {
        let [across, down] = sequence.strata;
        let seed = sequence.slot_seed(l, id, slot);
        let stratum = permute(l, id.index, across * down, seed);
        let [u, v] = two(l, id, slot);
        let position = l.to_real(stratum);
        // The quotient is at least ½/across away from the integer that would be rounded to; above
        // 2²³ strata the sum itself may be rounded up to the next row, which shows in the column.
        // Exact for at most 2²⁴ strata.
        let width = l.real(across.into());
        let row = ((position + l.real(0.5)) / width).floor();
        let column = (-row).mul_add(width, position);
        let early = column.lt(l.real(0.0));
        let row = l.select(early, row - l.real(1.0), row);
        let column = l.select(early, column + width, column);
        [
            below_one(l, (column + u) / l.real(across.into())),
            below_one(l, (row + v) / l.real(down.into())),
        ]
    }
}

/// Sums such as (n − 1 + u)/n may round up to 1.
#[inline(always)]
fn below_one<L: Lanes>(l: L, u: L::Real) -> L::Real {
    u.min(l.real(1.0 - 1.0 / (1u64 << L::UNIFORM_BITS) as f64))
}

/// Strata m × n ≥ count, nearly square, exactly `count` where it has a fitting divisor.
pub fn strata(count: u32) -> [u32; 2] {
    let root = f64::from(count).sqrt();
    let exact = (1..=root as u32).rev().find(|a| count.is_multiple_of(*a));
    match exact {
        // At most twice as long as wide.
        Some(a) if 2 * u64::from(a) * u64::from(a) >= u64::from(count) => [count / a, a],
        _ => {
            let a = root.ceil() as u32;
            [a, count.div_ceil(a)]
        }
    }
}
