//! How cameras project, and the list of ways.

use std::ops::Add;

use crate::declare::Parameter;

/// A way from points of the picture to rays.
pub trait Project {
    /// Its key in scene files and its one number.
    const PARAMETER: Parameter;
    /// Whether all rays pass through one point. Then distances in the picture are those on the plane
    /// at distance 1, else those in the scene.
    const CENTRAL: bool;

    /// Height of the picture, for a value of the parameter.
    fn height(value: f64) -> f64;

    /// Origin about the camera's position, and direction, of the ray through a point of the picture:
    /// `at` about the middle, in the plane across the unit vector `forward`. The direction's
    /// component along `forward` is 1.
    fn ray<V: Add<Output = V>>(zero: V, forward: V, at: V) -> (V, V);
}

macro_rules! projections {
    ($($kind:ident in $module:ident,)*) => {
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum ProjectionKind {
            $($kind,)*
        }

        impl ProjectionKind {
            /// All of them, in the order in which messages list them.
            pub const ALL: &'static [Self] = &[$(Self::$kind,)*];
            /// Their keys in scene files.
            pub const KEYS: &'static [&'static str] =
                &[$(<super::$module::$kind as Project>::PARAMETER.key,)*];
        }

        /// Evaluates an item of a kind's type.
        macro_rules! of {
            ($self:expr, $item:ident $arguments:tt) => {
                match $self {
                    $(ProjectionKind::$kind => super::$module::$kind::$item $arguments,)*
                }
            };
            ($self:expr, $item:ident) => {
                match $self {
                    $(ProjectionKind::$kind => super::$module::$kind::$item,)*
                }
            };
        }
    };
}

projections! {
    Perspective in perspective,
    Orthographic in orthographic,
}

/// How image points become rays: a kind, and the value of its parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    pub kind: ProjectionKind,
    pub value: f64,
}

impl Projection {
    /// [`Project::height`].
    pub fn height(&self) -> f64 {
        of!(self.kind, height(self.value))
    }
}

impl ProjectionKind {
    /// [`Project::PARAMETER`].
    pub fn parameter(self) -> Parameter {
        of!(self, PARAMETER)
    }

    /// [`Project::CENTRAL`].
    pub fn is_central(self) -> bool {
        of!(self, CENTRAL)
    }

    /// [`Project::ray`].
    #[inline(always)]
    pub fn ray<V: Add<Output = V>>(self, zero: V, forward: V, at: V) -> (V, V) {
        of!(self, ray(zero, forward, at))
    }
}
