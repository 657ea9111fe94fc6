//! Packets as arrays, for work on one lane after the other.

use super::lanes::{Lanes, WIDEST};

/// The numbers of the true lanes, in order.
#[inline(always)]
pub fn each(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(inlined!(move || {
        if bits == 0 {
            return None;
        }
        let i = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        Some(i)
    }))
}

/// A packet of reals as an array; unused places are zero.
#[inline(always)]
pub fn array<L: Lanes>(l: L, x: L::Real) -> [L::Scalar; WIDEST] {
    let mut out = [L::Scalar::default(); WIDEST];
    l.store(x, &mut out);
    out
}

/// A packet of integers as an array; unused places are zero.
#[inline(always)]
pub fn int_array<L: Lanes>(l: L, x: L::Int) -> [u32; WIDEST] {
    let mut out = [0; WIDEST];
    l.store_int(x, &mut out);
    out
}
