//! The samplers: one description, asked by slot.

use super::SamplerKind;
use super::hash::{Keys, mix, pcg4d};
use super::permute::permute;
use super::{Slot, sobol};
use crate::math::lanes::{Int, Lanes, Real, WIDEST, inlined};

/// Which points a render uses, and how many of them a replicate may see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sequence {
    kind: SamplerKind,
    keys: Keys,
    /// How samples are shared out among independent scrambles.
    pub replicates: Replicates,
    /// Most points of one replicate.
    points: u32,
    /// Significant bits of an index within a replicate.
    bits: u32,
    /// Strata across and down, for `stratified`.
    strata: [u32; 2],
}

/// How the samples of a pixel are shared out among its independent scrambles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replicates {
    /// This many, in turn.
    Fixed(u32),
    /// Two, then four, then eight as samples come: sample i belongs to the same replicate however
    /// many follow, so that stopping early changes no sample.
    Growing,
}

/// Samples at which the number of growing replicates begins to double: from there the new ones
/// alone are filled until they have caught up.
const GROWTH: [u32; 2] = [256, 4096];

impl Replicates {
    /// Replicate of sample `i` and the sample's index in it.
    #[inline]
    pub fn place(self, i: u32) -> (u32, u32) {
        match self {
            Self::Fixed(count) => (i % count, i / count),
            Self::Growing => {
                // Counts are powers of two, so that sharing out is masking and shifting.
                let mut bits = 1;
                for start in GROWTH {
                    if i < start {
                        break;
                    }
                    if i < 2 * start {
                        let new = i - start;
                        let count = 1 << bits;
                        return (count + (new & (count - 1)), new >> bits);
                    }
                    bits += 1;
                }
                (i & ((1 << bits) - 1), i >> bits)
            }
        }
    }

    /// [`Self::place`] of a packet of samples.
    #[inline(always)]
    pub fn places<L: Lanes>(self, l: L, i: L::Int) -> (L::Int, L::Int) {
        match self {
            Self::Fixed(count) => {
                let mut samples = [0; WIDEST];
                l.store_int(i, &mut samples);
                let (mut replicates, mut indices) = ([0; WIDEST], [0; WIDEST]);
                for ((i, replicate), index) in samples.iter().zip(&mut replicates).zip(&mut indices)
                {
                    *index = i / count;
                    *replicate = i - *index * count;
                }
                (l.load_int(&replicates), l.load_int(&indices))
            }
            Self::Growing => {
                let (mut replicate, mut index) = (i & l.int(1), i.right(1));
                for (bits, start) in (1..).zip(GROWTH) {
                    let count = 1 << bits;
                    let new = i.minus(l.int(start));
                    let catching_up = l.int(count).plus(new & l.int(count - 1));
                    let before = i.below(l.int(start));
                    let caught_up = !i.below(l.int(2 * start));
                    replicate = l.select_int(before, replicate, catching_up);
                    index = l.select_int(before, index, new.right(bits));
                    let all = i & l.int(2 * count - 1);
                    replicate = l.select_int(caught_up, all, replicate);
                    index = l.select_int(caught_up, i.right(bits + 1), index);
                }
                (replicate, index)
            }
        }
    }

    /// Number of replicates that `samples` samples reach.
    pub fn count(self, samples: u32) -> u32 {
        match self {
            Self::Fixed(count) => count.min(samples),
            Self::Growing => {
                let mut count = 2;
                for start in GROWTH {
                    if samples > start {
                        count = (2 * count).min(count + (samples - start));
                    }
                }
                count.min(samples)
            }
        }
    }

    /// Number of samples among the first `samples` that belong to `replicate`.
    pub fn samples_of(self, replicate: u32, samples: u32) -> u32 {
        match self {
            Self::Fixed(count) => Self::share(replicate, 0, count, samples),
            Self::Growing => {
                let (mut count, mut done) = (2, 0);
                let mut own = 0;
                for start in GROWTH {
                    let in_turn = samples.min(start).saturating_sub(done);
                    own += Self::share(replicate, 0, count, in_turn);
                    let catching_up = samples.min(2 * start).saturating_sub(start);
                    own += Self::share(replicate, count, count, catching_up);
                    (count, done) = (2 * count, 2 * start);
                }
                own + Self::share(replicate, 0, count, samples.saturating_sub(done))
            }
        }
    }

    /// What `replicate` gets of `samples` dealt in turn to `count` replicates from `first` on.
    fn share(replicate: u32, first: u32, count: u32, samples: u32) -> u32 {
        if replicate < first || replicate >= first + count {
            return 0;
        }
        samples / count + u32::from(replicate - first < samples % count)
    }
}

/// What identifies one sample in lanes: which scramble, and which of its points.
#[derive(Clone, Copy)]
pub struct Identity<L: Lanes> {
    /// Hash of seed, pixel and replicate.
    pub key: L::Int,
    /// Index within the replicate; with its bits reversed for the sequences that shuffle it.
    pub index: L::Int,
}

/// The numbers that a camera ray needs.
#[derive(Clone, Copy)]
pub struct CameraSample<L: Lanes> {
    /// Position in the pixel, [0, 1)².
    pub pixel: [L::Real; 2],
    /// Hero wavelength variate.
    pub wavelength: L::Real,
    /// Position on the lens, [0, 1)²; meaningless without a lens.
    pub lens: [L::Real; 2],
}

/// Strata m × n ≥ count, nearly square, exactly `count` where it has a fitting divisor.
fn strata(count: u32) -> [u32; 2] {
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

impl Sequence {
    /// A sampler for at most `spp` samples a pixel.
    pub fn new(kind: SamplerKind, seed: u64, spp: u32, replicates: Replicates) -> Self {
        let points = match replicates {
            Replicates::Fixed(count) => spp.div_ceil(count).max(1),
            Replicates::Growing => spp.max(1),
        };
        Self {
            kind,
            keys: Keys::new(seed),
            replicates,
            points,
            bits: 32 - (points - 1).leading_zeros(),
            strata: strata(points),
        }
    }

    /// The same points under other scrambles.
    pub fn reseeded(self, seed: u64) -> Self {
        Self {
            keys: Keys::new(seed),
            ..self
        }
    }

    /// Identity of samples of pixels.
    #[inline(always)]
    pub fn identity<L: Lanes>(
        &self,
        l: L,
        x: L::Int,
        y: L::Int,
        replicate: L::Int,
        index: L::Int,
    ) -> Identity<L> {
        Identity {
            key: self.keys.pixel(l, x, y, replicate),
            index: match self.kind {
                SamplerKind::Sobol | SamplerKind::Center => index.reversed(),
                SamplerKind::Independent | SamplerKind::Stratified => index,
            },
        }
    }

    /// The camera's numbers, stratified together.
    #[inline(never)]
    pub fn camera<L: Lanes>(&self, l: L, id: Identity<L>, lens: bool) -> CameraSample<L> {
        l.vectorize(
            #[inline(always)]
            || {
                let seed = inlined(
                    #[inline(always)]
                    |slot: Slot, component: u32| {
                        mix(
                            l,
                            id.key.plus(
                                l.int(0x9e37_79b9u32.wrapping_mul(2 * slot as u32 + component + 1)),
                            ),
                        )
                    },
                );
                let zero = l.real(0.0);
                match self.kind {
                    SamplerKind::Sobol | SamplerKind::Center => {
                        let coordinate = inlined(
                            #[inline(always)]
                            |dimension: usize, slot: Slot, component: u32| {
                                let digits =
                                    sobol::digits(l, dimension, id.index.reversed(), self.bits);
                                l.uniform(sobol::scrambled(l, digits, seed(slot, component)))
                            },
                        );
                        let pixel = if self.kind == SamplerKind::Center {
                            [l.real(0.5); 2]
                        } else {
                            [coordinate(0, Slot::Pixel, 0), coordinate(1, Slot::Pixel, 1)]
                        };
                        CameraSample {
                            pixel,
                            wavelength: coordinate(2, Slot::Wavelength, 0),
                            lens: if lens {
                                [coordinate(3, Slot::Lens, 0), coordinate(4, Slot::Lens, 1)]
                            } else {
                                [zero; 2]
                            },
                        }
                    }
                    SamplerKind::Independent => {
                        let depth = l.int(0);
                        let [pixel, [wavelength, _]] = self.independent(l, id, Slot::Pixel, depth);
                        CameraSample {
                            pixel,
                            wavelength,
                            lens: if lens {
                                self.independent(l, id, Slot::Lens, depth)[0]
                            } else {
                                [zero; 2]
                            },
                        }
                    }
                    SamplerKind::Stratified => {
                        let depth = l.int(0);
                        CameraSample {
                            pixel: self.pair(l, id, Slot::Pixel, depth),
                            wavelength: self.single(l, id, Slot::Wavelength, depth),
                            lens: if lens {
                                self.pair(l, id, Slot::Lens, depth)
                            } else {
                                [zero; 2]
                            },
                        }
                    }
                }
            },
        )
    }

    /// Two numbers of a padded slot at a bounce.
    #[inline(never)]
    pub fn pair<L: Lanes>(&self, l: L, id: Identity<L>, slot: Slot, depth: L::Int) -> [L::Real; 2] {
        l.vectorize(
            #[inline(always)]
            || {
                match self.kind {
                    SamplerKind::Sobol | SamplerKind::Center => {
                        let base = self.slot_seed(l, id, slot, depth);
                        let index = sobol::shuffled(l, id.index, base);
                        let first =
                            sobol::scrambled(l, index, mix(l, base.plus(l.int(0x68bc_21eb))));
                        let digits = sobol::digits(l, 1, index, 32);
                        let second =
                            sobol::scrambled(l, digits, mix(l, base.plus(l.int(0x02e5_be93))));
                        [l.uniform(first), l.uniform(second)]
                    }
                    SamplerKind::Stratified => {
                        let [across, down] = self.strata;
                        let seed = self.slot_seed(l, id, slot, depth);
                        let stratum = permute(l, id.index, across * down, seed);
                        let [u, v] = self.independent_pair(l, id, slot, depth);
                        let position = l.to_real(stratum);
                        // The quotient is at least ½/across away from the integer that would be
                        // rounded to; above 2²³ strata the sum itself may be rounded up to the
                        // next row, which shows in the column. Exact for at most 2²⁴ strata.
                        let width = l.real(across.into());
                        let row = ((position + l.real(0.5)) / width).floor();
                        let column = (-row).mul_add(width, position);
                        let early = column.lt(l.real(0.0));
                        let row = l.select(early, row - l.real(1.0), row);
                        let column = l.select(early, column + width, column);
                        [
                            self.below_one(l, (column + u) / l.real(across.into())),
                            self.below_one(l, (row + v) / l.real(down.into())),
                        ]
                    }
                    SamplerKind::Independent => self.independent_pair(l, id, slot, depth),
                }
            },
        )
    }

    /// The numbers of slots 2i and 2i + 1, of which `slot` is the first.
    #[inline(never)]
    pub fn two_pairs<L: Lanes>(
        &self,
        l: L,
        id: Identity<L>,
        slot: Slot,
        second: Slot,
        depth: L::Int,
    ) -> [[L::Real; 2]; 2] {
        debug_assert!((slot as u32).is_multiple_of(2) && second as u32 == slot as u32 + 1);
        l.vectorize(
            #[inline(always)]
            || match self.kind {
                SamplerKind::Independent => self.independent(l, id, slot, depth),
                _ => [
                    self.pair(l, id, slot, depth),
                    self.pair(l, id, second, depth),
                ],
            },
        )
    }

    /// One number of a padded slot at a bounce.
    #[inline(never)]
    pub fn single<L: Lanes>(&self, l: L, id: Identity<L>, slot: Slot, depth: L::Int) -> L::Real {
        l.vectorize(
            #[inline(always)]
            || match self.kind {
                SamplerKind::Sobol | SamplerKind::Center => {
                    let base = self.slot_seed(l, id, slot, depth);
                    let index = sobol::shuffled(l, id.index, base);
                    l.uniform(sobol::scrambled(
                        l,
                        index,
                        mix(l, base.plus(l.int(0x68bc_21eb))),
                    ))
                }
                SamplerKind::Stratified => {
                    let seed = self.slot_seed(l, id, slot, depth);
                    let stratum = permute(l, id.index, self.points, seed);
                    let [jitter, _] = self.independent_pair(l, id, slot, depth);
                    self.jittered(l, stratum, jitter, self.points)
                }
                SamplerKind::Independent => self.independent_pair(l, id, slot, depth)[0],
            },
        )
    }

    #[inline(always)]
    fn slot_seed<L: Lanes>(&self, l: L, id: Identity<L>, slot: Slot, depth: L::Int) -> L::Int {
        mix(l, id.key ^ slot.at(l, depth).times(l.int(0x9e37_79b9)))
    }

    /// Independent numbers of slots 2i and 2i + 1, of which `slot` is the first: the hash makes four
    /// at a time.
    #[inline(always)]
    fn independent<L: Lanes>(
        &self,
        l: L,
        id: Identity<L>,
        slot: Slot,
        depth: L::Int,
    ) -> [[L::Real; 2]; 2] {
        let counters = [id.key, id.index, slot.at(l, depth), l.int(0x2545_f491)];
        let [a, b, c, d] = pcg4d(l, counters);
        [[l.uniform(a), l.uniform(b)], [l.uniform(c), l.uniform(d)]]
    }

    /// The same for one of the two.
    #[inline(always)]
    fn independent_pair<L: Lanes>(
        &self,
        l: L,
        id: Identity<L>,
        slot: Slot,
        depth: L::Int,
    ) -> [L::Real; 2] {
        let [even, odd] = match slot {
            Slot::Pixel | Slot::Wavelength => self.independent(l, id, Slot::Pixel, depth),
            Slot::Lens | Slot::Choice => self.independent(l, id, Slot::Lens, depth),
            Slot::Light | Slot::Bsdf => self.independent(l, id, Slot::Light, depth),
            Slot::Roulette | Slot::Beyond => self.independent(l, id, Slot::Roulette, depth),
        };
        if (slot as u32).is_multiple_of(2) {
            even
        } else {
            odd
        }
    }

    #[inline(always)]
    fn jittered<L: Lanes>(&self, l: L, stratum: L::Int, u: L::Real, count: u32) -> L::Real {
        self.below_one(l, (l.to_real(stratum) + u) / l.real(count.into()))
    }

    /// Sums such as (n − 1 + u)/n may round up to 1.
    #[inline(always)]
    fn below_one<L: Lanes>(&self, l: L, u: L::Real) -> L::Real {
        u.min(l.real(1.0 - 1.0 / (1u64 << L::UNIFORM_BITS) as f64))
    }
}
