//! Independent samples: every number drawn on its own.

use super::Slot;
use super::hash::pcg4d;
use super::kind::Sampler;
use super::sequence::{CameraSample, Identity, Sequence};
use crate::math::lanes::Lanes;

/// Every number drawn on its own.
pub struct Independent;

impl Sampler for Independent {
    const NAME: &'static str = "independent";
    const WORDS: &'static str = "independent numbers";

    #[inline(always)]
    fn camera<L: Lanes>(
        _sequence: &Sequence,
        l: L,
        id: Identity<L>,
        lens: bool,
    ) -> CameraSample<L> {
        let depth = l.int(0);
        let [pixel, [wavelength, _]] = four(l, id, Slot::Pixel, depth);
        CameraSample {
            pixel,
            wavelength,
            lens: if lens {
                four(l, id, Slot::Lens, depth)[0]
            } else {
                [l.real(0.0); 2]
            },
        }
    }

    #[inline(always)]
    fn single<L: Lanes>(
        _sequence: &Sequence,
        l: L,
        id: Identity<L>,
        slot: Slot,
        depth: L::Int,
    ) -> L::Real {
        two(l, id, slot, depth)[0]
    }

    #[inline(always)]
    fn pair<L: Lanes>(
        _sequence: &Sequence,
        l: L,
        id: Identity<L>,
        slot: Slot,
        depth: L::Int,
    ) -> [L::Real; 2] {
        two(l, id, slot, depth)
    }

    #[inline(always)]
    fn two_pairs<L: Lanes>(
        _sequence: &Sequence,
        l: L,
        id: Identity<L>,
        [slot, _]: [Slot; 2],
        depth: L::Int,
    ) -> [[L::Real; 2]; 2] {
        four(l, id, slot, depth)
    }
}

/// The numbers of slots 2i and 2i + 1, of which `slot` is the first: the hash makes four at a time.
#[inline(always)]
fn four<L: Lanes>(l: L, id: Identity<L>, slot: Slot, depth: L::Int) -> [[L::Real; 2]; 2] {
    let counters = [id.key, id.index, slot.at(l, depth), l.int(0x2545_f491)];
    let [a, b, c, d] = pcg4d(l, counters);
    [[l.uniform(a), l.uniform(b)], [l.uniform(c), l.uniform(d)]]
}

/// The numbers of one slot.
#[inline(always)]
pub fn two<L: Lanes>(l: L, id: Identity<L>, slot: Slot, depth: L::Int) -> [L::Real; 2] {
    let [even, odd] = match slot {
        Slot::Pixel | Slot::Wavelength => four(l, id, Slot::Pixel, depth),
        Slot::Lens | Slot::Choice => four(l, id, Slot::Lens, depth),
        Slot::Light | Slot::Bsdf => four(l, id, Slot::Light, depth),
        Slot::Roulette | Slot::Beyond => four(l, id, Slot::Roulette, depth),
    };
    if (slot as u32).is_multiple_of(2) {
        even
    } else {
        odd
    }
}
