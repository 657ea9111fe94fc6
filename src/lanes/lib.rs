//! The path loop of etalon and all that it is made of: numbers in lanes, shapes, fields, spectra,
//! samplers, lights, materials, cameras.
//!
//! Everything that is compiled once for each instruction set and precision is compiled here, so
//! that what stands above (scene files, plans, films, commands) is built without it. No room knows
//! of scenes or files; the table of rooms stands in the documentation of the crate `etalon`, which
//! is the one to use.

#![allow(
    missing_docs,
    reason = "an inner crate: what users see is documented at the door of etalon, and here what a name does not say"
)]

/// A closure that is always inlined, as one over lanes must be to be compiled for the instruction
/// set of its caller; an attribute may stand on an argument but not on the right of `let`.
macro_rules! inlined {
    (|| $body:expr) => {
        $crate::math::lanes::inlined_once(
            #[inline(always)]
            || $body
        )
    };
    ($($closure:tt)*) => {
        $crate::math::lanes::inlined(
            #[inline(always)]
            $($closure)*
        )
    };
}

/// Methods of one expression each, always inlined, as those of lanes must be.
macro_rules! methods {
    ($(
        $(#[$attribute:meta])*
        $visibility:vis fn $method:ident $(<$generic:ident>)? ($($argument:tt)*) -> $result:ty
            = $value:expr;
    )*) => {
        $(
            $(#[$attribute])*
            #[inline(always)]
            $visibility fn $method $(<$generic>)? ($($argument)*) -> $result {
                $value
            }
        )*
    };
}

pub mod camera;
pub mod declare;
#[doc(hidden)]
pub mod doors;
pub mod field;
pub mod integrate;
pub mod light;
pub mod material;
pub mod math;
#[cfg(feature = "planted")]
pub mod planted;
pub mod root;
pub mod sample;
pub mod shape;
pub mod spectrum;
