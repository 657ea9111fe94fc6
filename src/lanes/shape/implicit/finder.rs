//! The contract of the root finders of implicit surfaces, and their list.

use std::fmt::Debug;
use std::sync::Arc;

use glam::DVec3;

use super::Implicit;
use super::certified::{Answers, Packet, Workspace};
use crate::field::tape::Tape;
use crate::shape::Ray;
use crate::shape::ladder::Ladder;

/// A root finder as surfaces ask for it.
pub trait RootFinder {
    /// Its name in scene files.
    const NAME: &'static str;
    /// How it works, for `info`.
    const WORDS: &'static str;
    /// Whether it may be asked for where the field is no polynomial.
    const ANY_FIELD: bool = true;

    /// What finds the roots of a surface, placed by a ladder.
    fn place(implicit: &Implicit, ladder: &Ladder) -> Finder;
}

kinds! {
    FinderChoice of RootFinder {
        Auto in certified,
        SignChange in baseline,
        SphereTrace in enclosed,
        Interval in enclosed,
        Polynomial in certified,
    }
    fn name(self) -> &'static str = NAME;
    fn words(self) -> &'static str = WORDS;
    fn takes_any_field(self) -> bool = ANY_FIELD;
}

/// A finder made ready for a surface in the world.
#[derive(Debug, Clone)]
pub struct Finder {
    /// Never [`FinderChoice::Auto`], which leads to one of the others.
    pub kind: FinderChoice,
    /// `None` for changes of sign, which prove nothing and are sought by the caller.
    pub prover: Option<Arc<dyn Prover>>,
}

impl Finder {
    /// The finder that a surface asks for.
    pub fn new(implicit: &Implicit, ladder: &Ladder) -> Self {
        of!(implicit.finder, place(implicit, ladder))
    }

    /// A finder that proves its answers.
    pub fn proved(kind: FinderChoice, prover: impl Prover + 'static) -> Self {
        Self {
            kind,
            prover: Some(Arc::new(prover)),
        }
    }
}

/// Finds the first hits of rays with a surface in the world, and proves them.
pub trait Prover: Debug + Send + Sync {
    /// The first hits of a packet. `sharp` asks for narrow enclosures at a higher cost.
    fn first_hits(&self, packet: &Packet, sharp: bool, workspace: &mut Workspace) -> Answers;

    /// The direction of the gradient, in object coordinates, at the exact root within an enclosure
    /// of t; `None` where only its enclosure is known.
    fn gradient_direction(&self, _: &Tape, _: &Ray, _: [f64; 2]) -> Option<DVec3> {
        None
    }
}
