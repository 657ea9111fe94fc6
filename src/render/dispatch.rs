//! Which compiled copy of the loop runs: instruction set × precision × number of wavelengths.

use fearless_simd::Level;

use crate::integrate::chunk::{self, Workspace};
use crate::integrate::develop::Spectrometer;
use crate::integrate::model::Model;
use crate::math::lanes::{Double, Scalar, Single};
use crate::math::twice::Twice;

/// The instruction sets that a compiled copy of the loop exists for.
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
    /// No vector unit that is known.
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    Fallback(fearless_simd::Fallback),
}

/// Instruction sets by name, best first.
pub const INSTRUCTION_NAMES: [&str; 4] = ["avx512", "avx2", "sse2", "neon"];

/// The instruction set of that name if this machine has it; `None` as name takes the best.
pub fn instructions(name: Option<&str>) -> Option<Instructions> {
    let level = Level::new();
    let wanted = |own: &str| name.is_none_or(|name| name == own);
    #[cfg(target_arch = "x86_64")]
    {
        if wanted("avx512")
            && let Some(simd) = level.as_avx512()
        {
            return Some(Instructions::Avx512(simd));
        }
        if wanted("avx2")
            && let Some(simd) = level.as_avx2()
        {
            return Some(Instructions::Avx2(simd));
        }
        if wanted("sse2")
            && let Some(simd) = level.as_sse2()
        {
            return Some(Instructions::Sse2(simd));
        }
        None
    }
    #[cfg(target_arch = "aarch64")]
    {
        return match level.as_neon() {
            Some(simd) if wanted("neon") => Some(Instructions::Neon(simd)),
            _ => None,
        };
    }
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    {
        let _ = (level, wanted);
        None
    }
}

/// A scalar whose lanes every instruction set can run.
pub trait Runs: Scalar {
    /// Renders a chunk of requested samples on the given instruction set.
    fn chunk<const C: usize>(
        level: Instructions,
        scene: &(Model<Self>, Spectrometer<Self>),
        requests: &chunk::Requests,
        workspace: &mut Workspace<Self, C>,
    );
}

macro_rules! runs {
    ($scalar:ty, $lanes:ident) => {
        impl Runs for $scalar {
            fn chunk<const C: usize>(
                level: Instructions,
                (model, spectrometer): &(Model<Self>, Spectrometer<Self>),
                requests: &chunk::Requests,
                workspace: &mut Workspace<Self, C>,
            ) {
                macro_rules! on {
                    ($simd:expr) => {
                        chunk::render($lanes($simd), model, spectrometer, requests, workspace)
                    };
                }
                match level {
                    #[cfg(target_arch = "x86_64")]
                    // Enough registers for two packets, and more wanted than one to be kept busy.
                    Instructions::Avx512(simd) => chunk::render(
                        Twice($lanes(simd)),
                        model,
                        spectrometer,
                        requests,
                        workspace,
                    ),
                    #[cfg(target_arch = "x86_64")]
                    Instructions::Avx2(simd) => on!(simd),
                    #[cfg(target_arch = "x86_64")]
                    Instructions::Sse2(simd) => on!(simd),
                    #[cfg(target_arch = "aarch64")]
                    Instructions::Neon(simd) => on!(simd),
                    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
                    Instructions::Fallback(simd) => on!(simd),
                }
            }
        }
    };
}

runs!(f32, Single);
runs!(f64, Double);
