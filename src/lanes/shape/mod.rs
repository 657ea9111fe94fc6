//! Shapes and rays: certified intersection of a line with placed canonical shapes.
//!
//! Each shape is a closed set in canonical coordinates (one file a shape), placed in the world by
//! any invertible 3×4 matrix, which *is* the object: nothing is decided by a rounded inverse. The
//! question "does the line meet it, and which crossing comes first" is a matter of signs of
//! polynomials in the given numbers. It is written once, over [`Number`](crate::math::number::Number),
//! without division or square root, and asked on a ladder: f64 with a forward error bound, then
//! double-double with one, then exactly. The first rung that knows answers (Woop, Benthin, Wald
//! 2013, JCGT 2(1), for the pattern of a fast test with a rare exact fallback).

pub mod cube;
pub mod cylinder;
pub mod disk;
pub mod flat;
pub mod hierarchy;
pub mod implicit;
pub mod index;
pub mod kind;
pub mod ladder;
pub mod lanes;
pub mod line;
pub mod list;
pub mod placed;
pub mod plane;
pub mod question;
pub mod rectangle;
pub mod resolve;
pub mod slab;
pub mod sphere;
mod surd;
mod value;

use glam::DVec3;

use implicit::Implicit;
pub use kind::{Emitter, Length, ShapeKind};

pub use crate::math::ray::Ray;
pub use list::{Query, nearest, occluded};
pub use placed::{Placed, SingularMatrix};

/// A shape in its own coordinates: sizes are part of the map that places it.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    Canonical(ShapeKind),
    /// f(x, y, z) = 0 inside a box.
    Implicit(Implicit),
}

impl Shape {
    /// Its name in scene files; of an implicit surface that has one, its own.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Canonical(kind) => kind.name(),
            Self::Implicit(implicit) => implicit.name.unwrap_or("implicit"),
        }
    }

    /// The canonical shape that it is; `None` for implicit surfaces.
    pub fn kind(&self) -> Option<ShapeKind> {
        match self {
            Self::Canonical(kind) => Some(*kind),
            Self::Implicit(_) => None,
        }
    }

    /// Opposite corners of a box around it; `None` where it has no end.
    pub fn corners(&self) -> Option<[DVec3; 2]> {
        match self {
            Self::Canonical(kind) => kind.corners(),
            Self::Implicit(implicit) => Some(implicit.inside),
        }
    }
}

/// What is known of the ray's start beyond its rounded coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Start {
    /// Nothing: the coordinates alone decide.
    #[default]
    Free,
    /// The origin stands for a point of this very surface and the ray goes inward: the entering
    /// crossing is the start, wherever rounding has put it, and only the leaving one counts. Flat
    /// shapes have no inside and are not met again.
    OnSurfaceInward,
    /// The shape cannot be met: the ray leaves this convex surface outward (or this flat one to
    /// either side), or the shape is to be left out.
    Excluded,
}

/// The kind of arithmetic that decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rung {
    /// f64 with a forward error bound.
    Double,
    /// Double-double with a forward error bound.
    DoubleDouble,
    Exact,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    pub double: u64,
    pub double_double: u64,
    pub exact: u64,
}

impl Tally {
    pub fn count(&mut self, rung: Rung) {
        match rung {
            Rung::Double => self.double += 1,
            Rung::DoubleDouble => self.double_double += 1,
            Rung::Exact => self.exact += 1,
        }
    }

    pub fn joined(self, other: Self) -> Self {
        Self {
            double: self.double + other.double,
            double_double: self.double_double + other.double_double,
            exact: self.exact + other.exact,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Where on the ray, in units of its direction; finite.
    pub t: f64,
    /// World coordinates.
    pub point: DVec3,
    /// Unit geometric normal in the world: outward, or the image of +z for flat shapes, under any
    /// transform, mirrors included.
    pub normal: DVec3,
    /// Canonical coordinates of the point, on the surface up to rounding; coordinates that are
    /// constant on a face are exact.
    pub local: DVec3,
    /// Whether the ray meets the outward (+z) side.
    pub front: bool,
    pub rung: Rung,
}

/// Both crossings of a line with a convex surface; the same one twice for flat shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossings {
    pub near: Hit,
    pub far: Hit,
}
