//! Where random numbers come from, and what is done with them.
//!
//! All randomness is counter-based: the numbers of sample (seed, x, y, index) are a pure function
//! of those and of the *name* of the dimension ([`Slot`]), so a sample can be computed alone, in
//! any order, and leaving a dimension out moves no other.

pub mod hash;
pub mod mis;
pub mod permute;
pub mod sequence;
pub mod sobol;
pub mod warp;

use crate::math::lanes::Lanes;

/// Names of pairs of random dimensions. A bounce's slots repeat with [`Slot::STRIDE`]; slots 2i and
/// 2i + 1 are often wanted together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Slot {
    /// Position in the pixel.
    Pixel = 0,
    /// Hero wavelength.
    Wavelength = 1,
    /// Position on the lens.
    Lens = 2,
    /// Which lobe of the surface, or which of many lights.
    Choice = 3,
    /// Which of few lights, and which point of it.
    Light = 4,
    /// Direction of the scattered ray.
    Bsdf = 5,
    /// Russian roulette.
    Roulette = 6,
    /// Whether a path goes on beyond `max_depth`.
    Beyond = 7,
}

impl Slot {
    /// Distance between the slots of one bounce and the next.
    pub const STRIDE: u32 = 8;

    /// The number that names this slot at a bounce.
    #[inline(always)]
    pub fn at<L: Lanes>(self, l: L, depth: L::Int) -> L::Int {
        use crate::math::lanes::Int;
        depth.times(l.int(Self::STRIDE)).plus(l.int(self as u32))
    }
}

/// The samplers by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SamplerKind {
    /// Every number drawn on its own.
    Independent,
    /// Strata visited in a random order per pixel.
    Stratified,
    /// Owen-scrambled Sobol' points.
    Sobol,
    /// One ray through the pixel's centre.
    Center,
}

impl SamplerKind {
    /// All of them, the usual one first.
    pub const ALL: [Self; 4] = [
        Self::Sobol,
        Self::Independent,
        Self::Stratified,
        Self::Center,
    ];

    /// The name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Stratified => "stratified",
            Self::Sobol => "sobol",
            Self::Center => "center",
        }
    }
}
