//! What a sampler is and draws.

use super::Slot;
use super::sequence::{Identity, Sequence};
use crate::math::lanes::Lanes;

/// A way to choose the points of a pixel: numbers in [0, 1) by sample and slot.
pub trait Sampler {
    /// Its name in scene files.
    const NAME: &'static str;
    /// What its points are, in the words of `info`.
    const WORDS: &'static str;
    /// Whether the points are cut for a number of samples that must be known beforehand.
    const NEEDS_COUNT: bool = false;
    /// Whether every path goes through the pixel's centre, so that the picture is another one than
    /// the mean over the pixels.
    const CENTRED: bool = false;

    /// The index of a sample in its replicate, in the form in which the points are computed.
    #[inline(always)]
    fn index<L: Lanes>(_l: L, index: L::Int) -> L::Int {
        index
    }

    /// The numbers of a camera ray without a lens: position in the pixel and wavelength.
    #[inline(always)]
    fn camera<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>) -> ([L::Real; 2], L::Real) {
        let pixel = Self::pair(sequence, l, id, Slot::Pixel);
        (pixel, Self::single(sequence, l, id, Slot::Wavelength))
    }

    /// The position on the lens.
    #[inline(always)]
    fn lens<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>) -> [L::Real; 2] {
        Self::pair(sequence, l, id, Slot::Lens)
    }

    /// One number of a slot.
    fn single<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>, slot: Slot) -> L::Real;

    /// Two numbers of a slot.
    fn pair<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>, slot: Slot) -> [L::Real; 2];

    /// Two numbers each of [`Slot::Light`] and [`Slot::Bsdf`], which are wanted together.
    #[inline(always)]
    fn light_and_bsdf<L: Lanes>(sequence: &Sequence, l: L, id: Identity<L>) -> [[L::Real; 2]; 2] {
        [
            sequence.pair(l, id, Slot::Light),
            sequence.pair(l, id, Slot::Bsdf),
        ]
    }
}

macro_rules! define {
    ($($kind:ident in $module:ident,)*) => {
        kinds! {
            SamplerKind of Sampler {
                $($kind in $module,)*
            }
            fn name(self) -> &'static str = NAME;
            fn words(self) -> &'static str = WORDS;
            fn needs_count(self) -> bool = NEEDS_COUNT;
            fn is_centred(self) -> bool = CENTRED;
        }
    };
}

samplers!(define);
pub(super) use of;
