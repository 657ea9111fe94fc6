//! Instruction sets: which this machine has, and running f64 lanes on one of them from code that
//! has no lanes itself.

use fearless_simd::Level;

use super::lanes::{Double, Lanes};
use super::scalar_lane::One;

/// Lanes of f64 on any instruction set.
pub trait DoubleLanes: Lanes<Scalar = f64> {}
impl<L: Lanes<Scalar = f64>> DoubleLanes for L {}

/// Something to do in f64 lanes of any kind.
pub trait Job {
    /// What comes of it.
    type Output;
    /// Does it; to be inlined into the caller, which is compiled for the instruction set.
    fn run<L: DoubleLanes>(self, lanes: L) -> Self::Output;
}

/// An instruction set. The results are the same bits on each.
#[derive(Debug, Clone, Copy)]
pub enum Instructions {
    /// x86-64 with AVX-512 (Ice Lake and later).
    #[cfg(target_arch = "x86_64")]
    Avx512(fearless_simd::Avx512),
    /// x86-64 with AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    Avx2(fearless_simd::Avx2),
    /// Any x86-64.
    #[cfg(target_arch = "x86_64")]
    Sse2(fearless_simd::Sse2),
    /// Arm with Neon.
    #[cfg(target_arch = "aarch64")]
    Neon(fearless_simd::Neon),
    /// One lane after the other; the path loop, which has no such copy where there are vectors,
    /// takes those that every machine has.
    Scalar(Least),
}

/// The vectors that every machine of its kind has.
#[cfg(target_arch = "x86_64")]
type Least = fearless_simd::Sse2;
/// The vectors that every machine of its kind has.
#[cfg(target_arch = "aarch64")]
type Least = fearless_simd::Neon;
/// Vectors in the compiler's hands.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
type Least = fearless_simd::Fallback;

impl Instructions {
    /// All that this machine has, the best first.
    pub fn all() -> Vec<Self> {
        let level = Level::new();
        let mut all = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(level.as_avx512().map(Self::Avx512));
            all.extend(level.as_avx2().map(Self::Avx2));
            all.extend(level.as_sse2().map(Self::Sse2));
            all.extend(level.as_sse2().map(Self::Scalar));
        }
        #[cfg(target_arch = "aarch64")]
        {
            all.extend(level.as_neon().map(Self::Neon));
            all.extend(level.as_neon().map(Self::Scalar));
        }
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        {
            let _ = level;
            all.push(Self::Scalar(Least::new()));
        }
        all
    }

    /// The best that this machine has.
    pub fn best() -> Self {
        Self::all()[0]
    }

    /// The one of this name, if this machine has it.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|own| own.name() == name)
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => "avx512",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Self::Sse2(_) => "sse2",
            #[cfg(target_arch = "aarch64")]
            Self::Neon(_) => "neon",
            Self::Scalar(_) => "scalar",
        }
    }

    /// Does the job on this instruction set.
    pub fn run<J: Job>(self, job: J) -> J::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(simd) => on(Double(simd), job),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(simd) => on(Double(simd), job),
            #[cfg(target_arch = "x86_64")]
            Self::Sse2(simd) => on(Double(simd), job),
            #[cfg(target_arch = "aarch64")]
            Self::Neon(simd) => on(Double(simd), job),
            Self::Scalar(_) => on(One, job),
        }
    }
}

/// The boundary at which code for an instruction set begins.
#[inline(never)]
fn on<L: DoubleLanes, J: Job>(lanes: L, job: J) -> J::Output {
    lanes.vectorize(
        #[inline(always)]
        || job.run(lanes),
    )
}
