//! Random permutations of {0, …, n − 1} computed element by element.

use super::hash::mix;
use crate::math::lanes::{Int, Lanes, Mask};

/// Rounds of the bijection; small sets need more, for there each mixes less. Of four elements, a
/// round brings the chance of every permutation four times closer to 1/24.
const ROUNDS: usize = 4;
/// Rounds for sets of at most 64.
const SMALL_ROUNDS: usize = 8;

/// Element `i` of a permutation of {0, …, `count` − 1} chosen by `seed`, for i < count: a keyed
/// bijection of the next power of two, walked along its cycle until it falls inside (the walk as
/// in A. Kensler, "Correlated Multi-Jittered Sampling", Pixar 13-01, 2013, section 4).
///
/// The walk makes the choice uneven where the bijection is not close to uniform among *all* of
/// the power of two, so every round has a key of its own: x ↦ a x + b with odd a, then an xor of
/// some bits of the upper half into the lower, all modulo 2^bits.
#[inline(always)]
pub fn permute<L: Lanes>(l: L, i: L::Int, count: u32, seed: L::Int) -> L::Int {
    let bits = 32 - count.saturating_sub(1).leading_zeros();
    let mask = l.int(((1u64 << bits) - 1) as u32);
    let half = (bits / 2).max(1);
    let limit = l.int(count);
    let rounds = if bits <= 6 { SMALL_ROUNDS } else { ROUNDS };
    let mut keys = [seed; SMALL_ROUNDS];
    for (round, key) in keys.iter_mut().enumerate().take(rounds) {
        let step = 0x9e37_79b9u32.wrapping_mul(round as u32);
        *key = mix(l, seed.plus(l.int(step)));
    }
    let mut x = i;
    let mut walking = l.mask(true);
    loop {
        let mut y = x;
        for &key in &keys[..rounds] {
            y = y.times(key.right(15) | l.int(1)).plus(key) & mask;
            y = y ^ (y.right(half) & (key.right(24) | key.left(8)));
        }
        // The first step is for all lanes; later ones only for those still outside.
        x = l.select_int(walking, y, x);
        walking = !x.below(limit);
        if !walking.any() {
            return x;
        }
    }
}
