//! Independent scrambles of a pixel's points, whose spread is the standard error.

use crate::math::lanes::{Int, Lanes, WIDEST};

/// How the samples of a pixel are shared out among its independent scrambles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replicates {
    /// This many, which get samples in turn.
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
    #[inline]
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

    /// Number of samples of each replicate among the first `samples`.
    pub fn counts(self, samples: u32) -> Vec<f64> {
        let own = |replicate| f64::from(self.samples_of(replicate, samples));
        (0..self.count(samples)).map(own).collect()
    }

    /// What `replicate` gets of `samples` dealt in turn to `count` replicates from `first` on.
    fn share(replicate: u32, first: u32, count: u32, samples: u32) -> u32 {
        if replicate < first || replicate >= first + count {
            return 0;
        }
        samples / count + u32::from(replicate - first < samples % count)
    }
}
