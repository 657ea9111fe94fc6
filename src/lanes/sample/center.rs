//! One ray through the pixel's centre; everything else as [`Sobol`] draws it.

use super::Slot;
use super::kind::Sampler;
use super::sequence::{Identity, Sequence};
use super::sobol::Sobol;
use crate::math::lanes::Lanes;

/// Every path through its pixel's centre.
pub struct Center;

impl Sampler for Center {
    const NAME: &'static str = "center";
    const WORDS: &'static str = "Sobol' points with Owen scrambling, through the pixel's centre";
    const CENTRED: bool = true;

    #[inline(always)]
    fn index<L: Lanes>(l: L, index: L::Int) -> L::Int {
        Sobol::index(l, index)
    }

    #[inline(always)]
    fn camera<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>) -> ([L::Real; 2], L::Real) {
        let (_, wavelength) = Sobol::camera(sequence, l, id);
        ([l.real(0.5); 2], wavelength)
    }

    #[inline(always)]
    fn lens<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>) -> [L::Real; 2] {
        Sobol::lens(sequence, l, id)
    }

    #[inline(always)]
    fn single<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>, slot: Slot) -> L::Real {
        Sobol::single(sequence, l, id, slot)
    }

    #[inline(always)]
    fn pair<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>, slot: Slot) -> [L::Real; 2] {
        Sobol::pair(sequence, l, id, slot)
    }
}
