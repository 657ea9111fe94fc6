//! The parts of objects (faces, curved walls), numbered throughout a scene, and what a hit on each needs:
//! geometry, material, emission.

use super::model::Appearance;
use crate::material::SPECTRA;
use crate::math::lanes::Scalar;
use crate::math::lookup::SMALL;
use crate::shape::lanes::LaneShape;
use crate::shape::lanes::part::{Part, PartKind};

/// Bits of a part's word.
pub mod word {
    /// Mask of the [`MaterialKind`](crate::material::MaterialKind).
    pub const KIND: u32 = 0xff;
    /// A pair of parallel faces.
    pub const FACES: u32 = 1 << 8;
    pub const BALL: u32 = 1 << 9;
    /// The shape itself computes points and normals.
    pub const OTHER: u32 = 1 << 10;
    /// Refraction by the material disperses.
    pub const DISPERSES: u32 = 1 << 11;
    /// A texture chooses the spectra by the place.
    pub const TEXTURED: u32 = 1 << 12;
    /// The outward side (+z of flat shapes) emits.
    pub const EMITS_FRONT: u32 = 1 << 13;
    /// The other side emits.
    pub const EMITS_BACK: u32 = 1 << 14;
    /// Part of a convex closed shape, whose exits are seen from inside.
    pub const CLOSED: u32 = 1 << 15;
    pub const EMITS: u32 = EMITS_FRONT | EMITS_BACK;

    /// The branches of the loop that bits of words open.
    pub const BRANCHES: [(u32, &str); 8] = [
        (DISPERSES, "dispersion"),
        (TEXTURED, "textures"),
        (EMITS_FRONT, "emission from fronts"),
        (EMITS_BACK, "emission from backs"),
        (FACES, "cubes"),
        (BALL, "balls"),
        (OTHER, "other curved surfaces"),
        (CLOSED, "insides of closed shapes"),
    ];
}

/// Marks objects that no light stands for.
pub const NO_LIGHT: u32 = u32::MAX;

/// The numbers of parts, as reals R and integers I: of one part ([`Entry`]), of a few as tables to
/// look numbers up in ([`SmallTable`]), or of those that a packet has met.
#[derive(Debug, Clone, Copy)]
pub struct PartData<R, I> {
    /// [`Part::vector`].
    pub vector: [R; 3],
    /// [`Part::level`].
    pub level: R,
    /// [`Part::half`].
    pub half: R,
    /// The object that the part belongs to.
    pub object: I,
    /// Bits of [`word`].
    pub word: I,
    /// The material's spectra: where they stand in the bank.
    pub spectra: [I; SPECTRA],
    /// The spectrum of the emission.
    pub emission: I,
    /// The light that samples the object, or [`NO_LIGHT`].
    pub light: I,
}

/// The numbers of one part.
pub type Entry<T> = PartData<T, u32>;

/// The numbers of up to [`SMALL`] parts by column.
pub type SmallTable<T> = PartData<[T; SMALL], [u32; SMALL]>;

impl<T: Scalar> Entry<T> {
    fn new(object: u32, part: &Part<T>, closed: bool, appearance: &Appearance<T>) -> Self {
        Self {
            vector: part.vector,
            level: part.level,
            half: part.half,
            object,
            word: word_of(part.kind, closed, appearance),
            spectra: appearance.surface.spectra,
            emission: appearance.emission.unwrap_or(0),
            light: appearance.light.unwrap_or(NO_LIGHT),
        }
    }
}

impl<T: Scalar> SmallTable<T> {
    fn of(entries: &[Entry<T>]) -> Self {
        let real = |number: &dyn Fn(&Entry<T>) -> T| {
            std::array::from_fn(|k| entries.get(k).map_or(T::default(), number))
        };
        let int = |number: &dyn Fn(&Entry<T>) -> u32| {
            std::array::from_fn(|k| entries.get(k).map_or(0, number))
        };
        Self {
            vector: [0, 1, 2].map(|axis| real(&|entry| entry.vector[axis])),
            level: real(&|entry| entry.level),
            half: real(&|entry| entry.half),
            object: int(&|entry| entry.object),
            word: int(&|entry| entry.word),
            spectra: [0, 1].map(|which| int(&|entry| entry.spectra[which])),
            emission: int(&|entry| entry.emission),
            light: int(&|entry| entry.light),
        }
    }
}

/// All parts of a scene.
#[derive(Debug, Clone, Default)]
pub struct Parts<T> {
    pub entries: Vec<Entry<T>>,
    /// Number of each object's first part.
    pub first: Vec<u32>,
    /// The entries by column, where they are few.
    pub small: Option<Box<SmallTable<T>>>,
}

impl<T: Scalar> Parts<T> {
    /// The parts of shapes whose objects look like this.
    pub fn new(shapes: &[LaneShape<T>], appearances: &[Appearance<T>]) -> Self {
        let mut parts = Self::default();
        for (k, (shape, appearance)) in shapes.iter().zip(appearances).enumerate() {
            parts.first.push(parts.entries.len() as u32);
            let closed = shape.kind.is_some_and(|kind| !kind.is_flat());
            let own = shape.parts();
            let own = own.iter();
            parts
                .entries
                .extend(own.map(|part| Entry::new(k as u32, part, closed, appearance)));
        }
        if parts.entries.len() <= SMALL {
            parts.small = Some(Box::new(SmallTable::of(&parts.entries)));
        }
        parts
    }
}

fn word_of<T>(kind: PartKind, closed: bool, appearance: &Appearance<T>) -> u32 {
    let part = match kind {
        PartKind::Plane => 0,
        PartKind::Faces => word::FACES,
        PartKind::Ball => word::BALL,
        PartKind::Other => word::OTHER,
    };
    let bit = |on: bool, bit: u32| if on { bit } else { 0 };
    let emits = |side: usize| appearance.emission.is_some() && appearance.emits[side];
    let surface = &appearance.surface;
    part | surface.kind as u32
        | bit(surface.disperses, word::DISPERSES)
        | bit(surface.texture.is_some(), word::TEXTURED)
        | bit(emits(0), word::EMITS_FRONT)
        | bit(emits(1), word::EMITS_BACK)
        | bit(closed, word::CLOSED)
}
