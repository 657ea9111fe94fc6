//! Which compiled copy of the loop runs: instruction set × precision × number of wavelengths.

use crate::integrate::chunk::{self, Workspace};
use crate::integrate::develop::Spectrometer;
use crate::integrate::model::Model;
use crate::math::instructions::Instructions;
use crate::math::lanes::{Double, Scalar, Single};
use crate::math::twice::Twice;

/// A scalar in which paths of C wavelengths run, on every instruction set.
pub trait Runs<const C: usize>: Scalar {
    /// Renders a chunk of requested samples on the given instruction set.
    fn chunk(
        level: Instructions,
        scene: &(Model<Self>, Spectrometer<Self>),
        requests: &chunk::Requests,
        workspace: &mut Workspace<Self, C>,
    );
}

macro_rules! runs {
    ($scalar:ty, $wavelengths:literal, $lanes:ident) => {
        impl Runs<$wavelengths> for $scalar {
            fn chunk(
                level: Instructions,
                (model, spectrometer): &(Model<Self>, Spectrometer<Self>),
                requests: &chunk::Requests,
                workspace: &mut Workspace<Self, $wavelengths>,
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
                    Instructions::Scalar(simd) => on!(simd),
                }
            }
        }
    };
}

runs!(f32, 4, Single);
runs!(f32, 8, Single);
runs!(f64, 4, Double);
runs!(f64, 8, Double);
