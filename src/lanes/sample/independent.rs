//! Independent samples: every number drawn on its own.

use super::Slot;
use super::hash::pcg4d;
use super::kind::Sampler;
use super::sequence::{Identity, Sequence};
use crate::math::lanes::{Int, Lanes};

/// Numbers that are hashes of seed, pixel, sample, slot and bounce.
pub struct Independent;

impl Sampler for Independent {
    const NAME: &'static str = "independent";
    const WORDS: &'static str = "independent numbers";

    #[inline(always)]
    fn camera<L: Lanes>(_: &Sequence, l: L, id: Identity<L>) -> ([L::Real; 2], L::Real) {
        let [pixel, [wavelength, _]] = four(l, id, Slot::Pixel);
        (pixel, wavelength)
    }

    #[inline(always)]
    fn single<L: Lanes>(_: &Sequence, l: L, id: Identity<L>, slot: Slot) -> L::Real {
        two(l, id, slot)[0]
    }

    #[inline(always)]
    fn pair<L: Lanes>(_: &Sequence, l: L, id: Identity<L>, slot: Slot) -> [L::Real; 2] {
        two(l, id, slot)
    }

    #[inline(always)]
    fn light_and_bsdf<L: Lanes>(_: &Sequence, l: L, id: Identity<L>) -> [[L::Real; 2]; 2] {
        four(l, id, Slot::Light)
    }
}

/// The numbers of slots 2i and 2i + 1, of which `slot` is one: the hash makes four at a time.
#[inline(always)]
fn four<L: Lanes>(l: L, id: Identity<L>, slot: Slot) -> [[L::Real; 2]; 2] {
    let first = id
        .bounce
        .times(l.int(Slot::STRIDE))
        .plus(l.int(slot as u32 & !1));
    let [a, b, c, d] = pcg4d(l, [id.key, id.index, first, l.int(0x2545_f491)]);
    [[l.uniform(a), l.uniform(b)], [l.uniform(c), l.uniform(d)]]
}

/// The numbers of one slot.
#[inline(always)]
pub fn two<L: Lanes>(l: L, id: Identity<L>, slot: Slot) -> [L::Real; 2] {
    let [even, odd] = four(l, id, slot);
    if (slot as u32).is_multiple_of(2) {
        even
    } else {
        odd
    }
}
