//! The samplers: one description, asked by slot.

use super::hash::{Keys, mix};
use super::kind::{Sampler, of};
use super::replicates::Replicates;
use super::{SamplerKind, Slot, stratified};
use crate::math::lanes::{Int, Lanes};

/// Which points a render uses, and how many of them a replicate may see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sequence {
    kind: SamplerKind,
    keys: Keys,
    /// How samples are shared out among independent scrambles.
    pub replicates: Replicates,
    /// Most points of one replicate.
    pub(super) points: u32,
    /// Significant bits of an index within a replicate.
    pub(super) bits: u32,
    /// Strata across and down, for `stratified`.
    pub(super) strata: [u32; 2],
}

/// What identifies one sample in lanes: which scramble, which of its points, and which of their
/// coordinates.
#[derive(Clone, Copy)]
pub struct Identity<L: Lanes> {
    /// Hash of seed, pixel and replicate.
    pub key: L::Int,
    /// Index within the replicate, as [`Sampler::index`] has it.
    pub index: L::Int,
    /// The bounce that numbers are for, from 0.
    pub bounce: L::Int,
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
            strata: stratified::strata(points),
        }
    }

    /// The same points under other scrambles.
    pub fn reseeded(self, seed: u64) -> Self {
        Self {
            keys: Keys::new(seed),
            ..self
        }
    }

    /// Identity of samples of pixels, at their cameras.
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
            index: of!(self.kind, index(l, index)),
            bounce: l.int(0),
        }
    }

    /// [`Sampler::camera`], and [`Sampler::lens`] where there is one.
    #[inline(never)]
    pub fn camera<L: Lanes>(&self, l: L, id: Identity<L>, lens: bool) -> CameraSample<L> {
        l.vectorize(inlined!(|| {
            let (pixel, wavelength) = of!(self.kind, camera(self, l, id));
            let mut sample = CameraSample {
                pixel,
                wavelength,
                lens: [l.real(0.0); 2],
            };
            if lens {
                sample.lens = of!(self.kind, lens(self, l, id));
            }
            sample
        }))
    }

    /// [`Sampler::single`].
    #[inline(never)]
    pub fn single<L: Lanes>(&self, l: L, id: Identity<L>, slot: Slot) -> L::Real {
        l.vectorize(inlined!(|| of!(self.kind, single(self, l, id, slot))))
    }

    /// [`Sampler::pair`].
    #[inline(never)]
    pub fn pair<L: Lanes>(&self, l: L, id: Identity<L>, slot: Slot) -> [L::Real; 2] {
        l.vectorize(inlined!(|| of!(self.kind, pair(self, l, id, slot))))
    }

    /// [`Sampler::light_and_bsdf`].
    #[inline(never)]
    pub fn light_and_bsdf<L: Lanes>(&self, l: L, id: Identity<L>) -> [[L::Real; 2]; 2] {
        l.vectorize(inlined!(|| of!(self.kind, light_and_bsdf(self, l, id))))
    }

    /// A hash of a sample's key and a slot at its bounce.
    #[inline(always)]
    pub(super) fn slot_seed<L: Lanes>(&self, l: L, id: Identity<L>, slot: Slot) -> L::Int {
        mix(l, id.key ^ slot.at(l, id.bounce).times(l.int(0x9e37_79b9)))
    }
}
