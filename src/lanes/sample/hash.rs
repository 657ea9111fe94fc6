//! Integer hashes in lanes.

use rand::Rng;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use crate::math::lanes::{Int, Lanes};

/// A bijection of 32-bit numbers with good avalanche: two multiply–xorshift rounds with the
/// constants that Wellons found by search (C. Wellons, "Prospecting for Hash Functions", 2018,
/// `lowbias32`).
#[inline(always)]
pub fn mix<L: Lanes>(l: L, x: L::Int) -> L::Int {
    let x = x ^ x.right(16);
    let x = x.times(l.int(0x7feb_352d));
    let x = x ^ x.right(15);
    let x = x.times(l.int(0x846c_a68b));
    x ^ x.right(16)
}

/// Four random numbers from four counters (M. Jarzynski and M. Olano, "Hash Functions for GPU
/// Rendering", JCGT 9(3), 2020, `pcg4d`: a PCG step on each word, then cross-mixing).
#[inline(always)]
pub fn pcg4d<L: Lanes>(l: L, v: [L::Int; 4]) -> [L::Int; 4] {
    let step = inlined!(|x: L::Int| x.times(l.int(1_664_525)).plus(l.int(1_013_904_223)));
    let [x, y, z, w] = v;
    let (mut x, mut y, mut z, mut w) = (step(x), step(y), step(z), step(w));
    x = x.plus(y.times(w));
    y = y.plus(z.times(x));
    z = z.plus(x.times(y));
    w = w.plus(y.times(z));
    x = x ^ x.right(16);
    y = y ^ y.right(16);
    z = z ^ z.right(16);
    w = w ^ w.right(16);
    x = x.plus(y.times(w));
    y = y.plus(z.times(x));
    z = z.plus(x.times(y));
    w = w.plus(y.times(z));
    [x, y, z, w]
}

/// Keys of one render: what the user's seed becomes, by PCG (M. O'Neill 2014, XSL-RR 128/64 with
/// a multiplicative generator).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Keys {
    words: [u32; 2],
}

impl Keys {
    /// Keys for a seed.
    pub fn new(seed: u64) -> Self {
        let mut generator = Pcg64Mcg::seed_from_u64(seed);
        Self {
            words: [generator.next_u32(), generator.next_u32()],
        }
    }

    /// The key of a pixel's replicate: a hash of seed, x, y and replicate.
    #[inline(always)]
    pub fn pixel<L: Lanes>(&self, l: L, x: L::Int, y: L::Int, replicate: L::Int) -> L::Int {
        let [a, b, ..] = pcg4d(
            l,
            [x, y, replicate ^ l.int(self.words[0]), l.int(self.words[1])],
        );
        mix(l, a ^ b)
    }
}
