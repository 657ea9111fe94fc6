//! Where random numbers come from, and what is done with them.
//!
//! All randomness is counter-based: the numbers of sample (seed, x, y, index) are a pure function
//! of those and of the *name* of the dimension ([`Slot`]), so a sample can be computed alone, in
//! any order, and leaving a dimension out moves no other.

/// The samplers: what stands here is read from scene files, planned and tested.
macro_rules! samplers {
    ($define:ident) => {
        $define! {
            Sobol in sobol,
            Independent in independent,
            Stratified in stratified,
            Center in center,
        }
    };
}

pub mod center;
pub mod hash;
pub mod independent;
pub mod kind;
pub mod mis;
pub mod permute;
pub mod replicates;
pub mod sequence;
pub mod sobol;
pub mod stratified;
pub mod warp;

pub use kind::SamplerKind;

use crate::math::lanes::{Int, Lanes};

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
    pub fn at<L: Lanes>(self, l: L, bounce: L::Int) -> L::Int {
        bounce.times(l.int(Self::STRIDE)).plus(l.int(self as u32))
    }
}
