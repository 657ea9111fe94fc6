//! What can happen in a scene: the branches of the loop, the same for all lanes.

use super::model::Appearance;
use super::parts::{Parts, word};
use crate::material::{MaterialKind, MaterialKinds};
use crate::math::lanes::Scalar;

/// What the loop asks before each of its branches; a branch that nothing takes is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Needs {
    /// The materials that scatter on some surface.
    pub materials: MaterialKinds,
    /// The camera has a lens, whose two numbers are drawn.
    pub lens: bool,
    /// Bits of [`word`] that some part has.
    words: u32,
}

impl Needs {
    /// What parts, and the appearances of the objects that they belong to, can make happen.
    pub fn new<T: Scalar>(parts: &Parts<T>, appearances: &[Appearance<T>], lens: bool) -> Self {
        Self {
            materials: appearances.iter().map(|a| a.surface.kind).collect(),
            lens,
            words: parts.entries.iter().fold(0, |all, part| all | part.word),
        }
    }

    /// Everything, whether it can happen or not.
    pub fn everything() -> Self {
        Self {
            materials: MaterialKind::ALL.iter().copied().collect(),
            lens: true,
            words: u32::MAX,
        }
    }

    /// Whether some part has one of these bits.
    #[inline(always)]
    pub fn has(self, bits: u32) -> bool {
        self.words & bits != 0
    }

    /// The branches in words, and whether they are in the loop.
    pub fn branches(self) -> impl Iterator<Item = (&'static str, bool)> {
        let materials = MaterialKind::ALL
            .iter()
            .filter_map(move |kind| Some((kind.branch()?, self.materials.contains(*kind))));
        let words = word::BRANCHES.iter();
        materials
            .chain(words.map(move |(bit, words)| (*words, self.has(*bit))))
            .chain([("lens", self.lens)])
    }
}
