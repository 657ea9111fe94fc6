//! Random permutations of {0, …, n − 1} computed element by element.

use crate::math::lanes::{Int, Lanes, Mask};

/// Element `i` of a permutation of {0, …, `count` − 1} chosen by `seed`, for i < count: a keyed
/// bijection of the next power of two, walked along its cycle until it falls inside
/// (A. Kensler, "Correlated Multi-Jittered Sampling", Pixar 13-01, 2013, section 4).
#[inline(always)]
pub fn permute<L: Lanes>(l: L, i: L::Int, count: u32, seed: L::Int) -> L::Int {
    let bits = 32 - count.saturating_sub(1).leading_zeros();
    let mask = l.int(((1u64 << bits) - 1) as u32);
    let half = (bits / 2).max(1);
    let limit = l.int(count);
    let mut x = i;
    let mut walking = l.mask(true);
    loop {
        // Each line is invertible modulo 2^bits: odd products, sums, xor with a right shift.
        let mut y = x.plus(seed) & mask;
        y = y.times(seed.right(15) | l.int(1)) & mask;
        y = y ^ y.right(half);
        y = y.times(l.int(0x7feb_352d)) & mask;
        y = y ^ (seed.right(7) & mask);
        y = y ^ y.right(half);
        y = y.times(l.int(0x846c_a68b)) & mask;
        y = y ^ y.right(half);
        y = y.plus(seed.right(3)) & mask;
        // The first step is for all lanes; later ones only for those still outside.
        x = l.select_int(walking, y, x);
        walking = !x.below(limit);
        if !walking.any() {
            return x;
        }
    }
}
