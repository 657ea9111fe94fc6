//! Owen-scrambled Sobol' points in lanes.
//!
//! The scrambling is hash-based (B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4),
//! 2020) on bit-reversed numbers, where "each digit depends on the more significant ones" becomes
//! "each bit depends on the lower ones", which is what multiplication does.

use super::Slot;
use super::hash::mix;
use super::kind::Sampler;
use super::sequence::{Identity, Sequence};
use crate::math::lanes::{Int, Lanes};

/// Owen-scrambled Sobol' points.
pub struct Sobol;

impl Sampler for Sobol {
    const NAME: &'static str = "sobol";
    const WORDS: &'static str = "Sobol' points with Owen scrambling";

    /// With its bits reversed, as the shuffle wants it.
    #[inline(always)]
    fn index<L: Lanes>(_l: L, index: L::Int) -> L::Int {
        index.reversed()
    }

    /// Pixel, wavelength and lens are stratified together, as one point of five dimensions.
    #[inline(always)]
    fn camera<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>) -> ([L::Real; 2], L::Real) {
        let coordinate = inlined!(|dimension: usize| coordinate(sequence, l, id, dimension));
        ([coordinate(0), coordinate(1)], coordinate(2))
    }

    #[inline(always)]
    fn lens<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>) -> [L::Real; 2] {
        [
            coordinate(sequence, l, id, 3),
            coordinate(sequence, l, id, 4),
        ]
    }

    #[inline(always)]
    fn single<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>, slot: Slot) -> L::Real {
        let base = sequence.slot_seed(l, id, slot);
        l.uniform(first(l, shuffled(l, id.index, base), base))
    }

    #[inline(always)]
    fn pair<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>, slot: Slot) -> [L::Real; 2] {
        let base = sequence.slot_seed(l, id, slot);
        let index = shuffled(l, id.index, base);
        let second = scrambled(
            l,
            digits(l, 1, index, 32),
            mix(l, base.plus(l.int(0x02e5_be93))),
        );
        [l.uniform(first(l, index, base)), l.uniform(second)]
    }
}

/// The first coordinate of a slot's points.
#[inline(always)]
fn first<L: Lanes>(l: L, index: L::Int, base: L::Int) -> L::Int {
    scrambled(l, index, mix(l, base.plus(l.int(0x68bc_21eb))))
}

/// Slot and component of each dimension of a camera sample's point.
const CAMERA: [(Slot, u32); DIMENSIONS] = [
    (Slot::Pixel, 0),
    (Slot::Pixel, 1),
    (Slot::Wavelength, 0),
    (Slot::Lens, 0),
    (Slot::Lens, 1),
];

/// A coordinate of a camera sample's point.
#[inline(always)]
fn coordinate<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>, dimension: usize) -> L::Real {
    let (slot, component) = CAMERA[dimension];
    let step = 0x9e37_79b9u32.wrapping_mul(2 * slot as u32 + component + 1);
    let seed = mix(l, id.key.plus(l.int(step)));
    let digits = digits(l, dimension, id.index.reversed(), sequence.bits);
    l.uniform(scrambled(l, digits, seed))
}

/// Dimensions of the joint set of a camera sample: pixel x, y, wavelength, lens u, v.
pub const DIMENSIONS: usize = 5;

/// Generator matrices of the dimensions beyond the second, column by column with the first digit
/// in bit 0 (bit-reversed), from primitive polynomials and initial numbers m of S. Joe and
/// F. Kuo, "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci.
/// Comput. 30 (2008), table `new-joe-kuo-6`, d = 3, 4, 5.
const COLUMNS: [[u32; 32]; DIMENSIONS - 2] = [
    columns(2, 1, [1, 3, 0]),
    columns(3, 1, [1, 3, 1]),
    columns(3, 2, [1, 1, 1]),
];

/// The 32 direction numbers for a primitive polynomial of degree `s` with inner coefficients `a`
/// and initial numbers `m` (P. Bratley and B. Fox, ACM TOMS 14 (1988), Algorithm 659).
const fn columns(s: usize, a: u32, m: [u32; 3]) -> [u32; 32] {
    let mut v = [0u32; 32];
    let mut k = 0;
    while k < 32 {
        if k < s {
            v[k] = m[k] << (31 - k);
        } else {
            v[k] = v[k - s] ^ (v[k - s] >> s);
            let mut j = 1;
            while j < s {
                if (a >> (s - 1 - j)) & 1 == 1 {
                    v[k] ^= v[k - j];
                }
                j += 1;
            }
        }
        k += 1;
    }
    let mut k = 0;
    while k < 32 {
        v[k] = v[k].reverse_bits();
        k += 1;
    }
    v
}

/// A seeded permutation of 32-bit numbers in which bit k depends on bits 0 … k alone, each flip
/// close to random: Owen's nested uniform scramble of bit-reversed numbers (S. Laine and
/// T. Karras 2011; round constants of N. Vegdahl, "Building a Better LK Hash", 2021).
#[inline(always)]
pub fn nested_scramble<L: Lanes>(l: L, x: L::Int, seed: L::Int) -> L::Int {
    let x = x ^ x.times(l.int(0x3d20_adea));
    let x = x.plus(seed);
    let x = x.times(seed.right(16) | l.int(1));
    let x = x ^ x.times(l.int(0x0552_6c56));
    x ^ x.times(l.int(0x53a2_2864))
}

/// Digits of the second Sobol' dimension, first digit in bit 0: the matrix is Pascal's triangle
/// modulo 2, digit k is the sum of the index bits j with C(j, k) odd, and by Lucas's theorem that
/// is a sum over supersets, done one bit of the position at a time.
#[inline(always)]
fn second_dimension<L: Lanes>(l: L, index: L::Int) -> L::Int {
    let x = index ^ (index.right(1) & l.int(0x5555_5555));
    let x = x ^ (x.right(2) & l.int(0x3333_3333));
    let x = x ^ (x.right(4) & l.int(0x0f0f_0f0f));
    let x = x ^ (x.right(8) & l.int(0x00ff_00ff));
    x ^ x.right(16)
}

/// Digits of any of the [`DIMENSIONS`], first digit in bit 0, for indices below 2^`bits`.
#[inline(always)]
pub fn digits<L: Lanes>(l: L, dimension: usize, index: L::Int, bits: u32) -> L::Int {
    match dimension {
        0 => index,
        1 => second_dimension(l, index),
        _ => {
            let columns = &COLUMNS[dimension - 2];
            let mut sum = l.int(0);
            for bit in 0..bits.min(32) {
                let chosen = index.right(bit) & l.int(1);
                // 0 or all ones.
                let mask = l.int(0).minus(chosen);
                sum = sum ^ (mask & l.int(columns[bit as usize]));
            }
            sum
        }
    }
}

/// 32 random bits of a scrambled coordinate, most significant first.
#[inline(always)]
pub fn scrambled<L: Lanes>(l: L, digits: L::Int, seed: L::Int) -> L::Int {
    nested_scramble(l, digits, seed).reversed()
}

/// The index in a random order that keeps every aligned block of 2ᵏ indices together, so that
/// prefixes stay well stratified (Burley 2020, section 5); from the index with its bits reversed.
#[inline(always)]
pub fn shuffled<L: Lanes>(l: L, reversed_index: L::Int, seed: L::Int) -> L::Int {
    nested_scramble(l, reversed_index, seed).reversed()
}
