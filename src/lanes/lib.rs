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

/// Kinds of one thing, one a file: their enum from a list, methods that give constants of the trait
/// that they have in common, and a macro `of!` for any item of a kind's type.
macro_rules! kinds {
    (
        $kinds:ident of $trait:ident {
            $($(#[$attribute:meta])? $kind:ident in $module:ident,)*
        }
        $(fn $method:ident(self) -> $type:ty = $constant:ident;)*
    ) => {
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $kinds {
            $(
                $(#[$attribute])?
                #[doc = concat!("See [`", stringify!($kind), "`](super::", stringify!($module), "::", stringify!($kind), ").")]
                $kind,
            )*
        }

        /// Evaluates an item of a kind's type.
        macro_rules! of {
            ($self:expr, $item:ident) => {
                match $self {
                    $(
                        $(#[$attribute])?
                        $kinds::$kind => <super::$module::$kind as $trait>::$item,
                    )*
                }
            };
            ($self:expr, $item:ident $arguments:tt) => {
                match $self {
                    $(
                        $(#[$attribute])?
                        $kinds::$kind => <super::$module::$kind as $trait>::$item $arguments,
                    )*
                }
            };
        }

        impl $kinds {
            /// All of them, in the order in which messages list them.
            pub const ALL: &'static [Self] = &[$($(#[$attribute])? Self::$kind,)*];

            $(
                #[doc = concat!("[`", stringify!($trait), "::", stringify!($constant), "`].")]
                #[inline(always)]
                pub const fn $method(self) -> $type {
                    of!(self, $constant)
                }
            )*
        }
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
pub mod field;
pub mod integrate;
pub mod light;
pub mod material;
pub mod math;
pub mod planted;
pub mod root;
pub mod sample;
pub mod shape;
pub mod spectrum;
