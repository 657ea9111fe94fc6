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
pub use list::Query;
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Tier {
    /// f64 with a forward error bound.
    #[default]
    Double,
    /// Double-double with a forward error bound.
    DoubleDouble,
    Exact,
}

/// How many questions each arithmetic has decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    pub double: u64,
    pub double_double: u64,
    pub exact: u64,
    /// Of implicit surfaces: where arithmetic or work bound did not suffice.
    pub undecided: u64,
    /// Of implicit surfaces: answered without proof.
    pub uncertified: u64,
}

impl Tally {
    /// Counts a question by what has decided it; `None` for nothing.
    pub fn count(&mut self, tier: Option<Tier>) {
        match tier {
            Some(Tier::Double) => self.double += 1,
            Some(Tier::DoubleDouble) => self.double_double += 1,
            Some(Tier::Exact) => self.exact += 1,
            None => self.undecided += 1,
        }
    }

    pub fn joined(self, other: Self) -> Self {
        Self {
            double: self.double + other.double,
            double_double: self.double_double + other.double_double,
            exact: self.exact + other.exact,
            undecided: self.undecided + other.undecided,
            uncertified: self.uncertified + other.uncertified,
        }
    }

    pub fn rays(&self) -> u64 {
        self.double + self.double_double + self.exact + self.undecided + self.uncertified
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
    pub tier: Tier,
}
