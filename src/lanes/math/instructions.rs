//! Instruction sets and precisions, and the one place where they become lanes to calculate in.

use fearless_simd::Level;

use super::lanes::{Lanes, Scalar};

pub trait DoubleLanes: Lanes<Scalar = f64> {}
impl<L: Lanes<Scalar = f64>> DoubleLanes for L {}

/// Something to do in lanes of T, whatever the instruction set.
pub trait Job<T: Scalar>: Sized {
    type Output;
    /// Does it; to be inlined into the caller, which is compiled for the instruction set.
    fn run<L: Lanes<Scalar = T>>(self, lanes: L) -> Self::Output;
    /// The same where there are registers for two packets ([`super::twice`]): 32, each as wide as
    /// one.
    #[inline(always)]
    fn run_amid_registers<L: Lanes<Scalar = T>>(self, lanes: L) -> Self::Output {
        self.run(lanes)
    }
}

/// Which scalars the lanes are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    Single,
    Double,
}

impl Precision {
    pub const ALL: [Self; 2] = [Self::Single, Self::Double];

    /// Its name in scene files and pictures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "f32",
            Self::Double => "f64",
        }
    }

    /// Unit roundoff of round-to-nearest.
    pub fn roundoff(self) -> f64 {
        match self {
            Self::Single => f32::ROUNDOFF,
            Self::Double => f64::ROUNDOFF,
        }
    }

    pub fn rounded(self, x: f64) -> f64 {
        match self {
            Self::Single => f64::from(x as f32),
            Self::Double => x,
        }
    }
}

/// Makes the enum of instruction sets from one list, the best first. A row gives the architecture,
/// the set's name in `fearless_simd`, the method of a level that tells whether the machine has it,
/// its name for users, and the method of a job that runs on it.
macro_rules! instruction_sets {
    ($($(#[$doc:meta])* $arch:literal, $set:ident, $have:ident, $name:literal, $run:ident;)*) => {
        /// An instruction set. The results are the same bits on each.
        #[derive(Debug, Clone, Copy)]
        pub enum Instructions {
            $(
                $(#[$doc])*
                #[cfg(target_arch = $arch)]
                $set(fearless_simd::$set),
            )*
            /// The instructions that every machine of the architecture has, one lane after the other.
            Scalar,
        }

        impl Instructions {
            /// The names of all that machines of this kind may have, the best first.
            pub const NAMES: &'static [&'static str] = &[
                $(#[cfg(target_arch = $arch)] $name,)*
                Self::LEAST,
            ];

            /// All that this machine has, the best first.
            pub fn all() -> Vec<Self> {
                let mut all = Vec::new();
                $(
                    #[cfg(target_arch = $arch)]
                    all.extend(Level::new().$have().map(Self::$set));
                )*
                all.push(Self::Scalar);
                all
            }

            /// The best of those that a level of `fearless_simd` has.
            #[inline(always)]
            pub(super) fn of(level: Level) -> Self {
                match level {
                    $(#[cfg(target_arch = $arch)] Level::$set(simd) => Self::$set(simd),)*
                    _ => Self::Scalar,
                }
            }

            /// One of [`NAMES`](Self::NAMES).
            pub fn name(self) -> &'static str {
                match self {
                    $(#[cfg(target_arch = $arch)] Self::$set(_) => $name,)*
                    Self::Scalar => Self::LEAST,
                }
            }

            pub fn run<T: Scalar, J: Job<T>>(self, job: J) -> J::Output {
                match self {
                    $(
                        #[cfg(target_arch = $arch)]
                        Self::$set(simd) => on(T::packet(simd), inlined!(|lanes| job.$run(lanes))),
                    )*
                    Self::Scalar => on(T::ONE, inlined!(|lanes| job.run(lanes))),
                }
            }
        }
    };
}

instruction_sets! {
    /// x86-64 with AVX-512 (Ice Lake and later).
    "x86_64", Avx512, as_avx512, "avx512", run_amid_registers;
    /// x86-64 with AVX2 and FMA.
    "x86_64", Avx2, as_avx2, "avx2", run;
    /// Arm with Neon.
    "aarch64", Neon, as_neon, "neon", run;
}

impl Instructions {
    /// Name of [`Self::Scalar`].
    const LEAST: &'static str = if cfg!(target_arch = "x86_64") {
        "sse2"
    } else {
        "scalar"
    };

    pub fn best() -> Self {
        Self::of(Level::new())
    }

    /// The one of this name, if this machine has it.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|own| own.name() == name)
    }
}

/// The boundary at which code for an instruction set begins.
#[inline(never)]
fn on<L: Lanes, R>(lanes: L, work: impl FnOnce(L) -> R) -> R {
    lanes.vectorize(inlined!(|| work(lanes)))
}
