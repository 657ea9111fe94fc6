//! What the loop knows of each part of each object, by the part's number.

use super::model::{ObjectShading, Scatter};
use crate::math::lanes::Scalar;
use crate::math::lookup::SMALL;
use crate::shape::lanes::LaneShape;
use crate::shape::lanes::part::{Part, PartKind};

/// Bits of a part's word.
pub mod word {
    /// Mask of the [`super::Scatter`] kind.
    pub const SCATTER: u32 = 7;
    /// Two parallel faces.
    pub const FACES: u32 = 1 << 3;
    /// A ball.
    pub const BALL: u32 = 1 << 4;
    /// A shape that computes its own surface.
    pub const OTHER: u32 = 1 << 5;
    /// Glass that disperses.
    pub const DISPERSES: u32 = 1 << 6;
    /// A checkerboard.
    pub const CHECKER: u32 = 1 << 7;
    /// The outward side emits.
    pub const EMITS_FRONT: u32 = 1 << 8;
    /// The other side emits.
    pub const EMITS_BACK: u32 = 1 << 9;
    /// Part of a convex closed shape, whose exits are seen from inside.
    pub const CLOSED: u32 = 1 << 10;
}

/// Marks objects that no light stands for.
pub const NO_LIGHT: u32 = u32::MAX;

/// One part.
#[derive(Debug, Clone, Copy)]
pub struct Entry<T> {
    /// The object it belongs to.
    pub object: u32,
    /// Its geometry.
    pub part: Part<T>,
    /// Bits of [`word`].
    pub word: u32,
    /// Spectrum of albedo, reflectance or n.
    pub spectrum: u32,
    /// Spectrum of the extinction coefficient.
    pub extinction: u32,
    /// Spectrum of the emission.
    pub emission: u32,
    /// The light that samples the object, or [`NO_LIGHT`].
    pub light: u32,
}

/// The entries by column, where they are few.
#[derive(Debug, Clone)]
pub struct SmallTable<T> {
    /// [`Part::vector`].
    pub vector: [[T; SMALL]; 3],
    /// [`Part::level`].
    pub level: [T; SMALL],
    /// [`Part::half`].
    pub half: [T; SMALL],
    /// [`Entry::object`].
    pub object: [u32; SMALL],
    /// [`Entry::word`].
    pub word: [u32; SMALL],
    /// [`Entry::spectrum`].
    pub spectrum: [u32; SMALL],
    /// [`Entry::extinction`].
    pub extinction: [u32; SMALL],
    /// [`Entry::emission`].
    pub emission: [u32; SMALL],
    /// [`Entry::light`].
    pub light: [u32; SMALL],
}

/// All parts of a scene.
#[derive(Debug, Clone, Default)]
pub struct Parts<T> {
    /// By number.
    pub entries: Vec<Entry<T>>,
    /// Number of each object's first part.
    pub first: Vec<u32>,
    /// The entries once more, where they are few.
    pub small: Option<Box<SmallTable<T>>>,
    /// Union of all words.
    pub words: u32,
}

impl<T: Scalar> Parts<T> {
    /// Of objects with their appearance.
    pub fn new(shapes: &[LaneShape<T>], shading: &[ObjectShading<T>]) -> Self {
        let mut parts = Self::default();
        for (k, (shape, shading)) in shapes.iter().zip(shading).enumerate() {
            parts.first.push(parts.entries.len() as u32);
            let closed = shape.kind.is_some_and(|kind| !kind.is_flat());
            for part in shape.parts() {
                parts.entries.push(Entry {
                    object: k as u32,
                    part,
                    word: word_of(part.kind, shading) | if closed { word::CLOSED } else { 0 },
                    spectrum: shading.spectrum,
                    extinction: shading.extinction,
                    emission: shading.emission.unwrap_or(0),
                    light: shading.light.unwrap_or(NO_LIGHT),
                });
            }
        }
        parts.words = parts.entries.iter().fold(0, |all, e| all | e.word);
        if parts.entries.len() <= SMALL {
            parts.small = Some(Box::new(SmallTable::new(&parts.entries)));
        }
        parts
    }
}

fn word_of<T>(kind: PartKind, shading: &ObjectShading<T>) -> u32 {
    let kind = match kind {
        PartKind::Plane => 0,
        PartKind::Faces => word::FACES,
        PartKind::Ball => word::BALL,
        PartKind::Other => word::OTHER,
    };
    let bit = |on: bool, bit: u32| if on { bit } else { 0 };
    let emits = |side: usize| shading.emission.is_some() && shading.emits[side];
    kind | shading.scatter as u32
        | bit(shading.disperses, word::DISPERSES)
        | bit(shading.checker.is_some(), word::CHECKER)
        | bit(emits(0), word::EMITS_FRONT)
        | bit(emits(1), word::EMITS_BACK)
}

impl<T: Scalar> SmallTable<T> {
    fn new(entries: &[Entry<T>]) -> Self {
        fn column<T, V: Copy + Default>(
            entries: &[Entry<T>],
            value: impl Fn(&Entry<T>) -> V,
        ) -> [V; SMALL] {
            let mut column = [V::default(); SMALL];
            for (place, entry) in column.iter_mut().zip(entries) {
                *place = value(entry);
            }
            column
        }
        Self {
            vector: [0, 1, 2].map(|i| column(entries, |e| e.part.vector[i])),
            level: column(entries, |e| e.part.level),
            half: column(entries, |e| e.part.half),
            object: column(entries, |e| e.object),
            word: column(entries, |e| e.word),
            spectrum: column(entries, |e| e.spectrum),
            extinction: column(entries, |e| e.extinction),
            emission: column(entries, |e| e.emission),
            light: column(entries, |e| e.light),
        }
    }
}

const _: () = assert!(Scatter::Glass as u32 <= word::SCATTER);
