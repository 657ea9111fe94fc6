//! The state of the paths in flight.
//!
//! Paths end at different times. Each pass over the pool advances all of them by one segment and
//! writes the survivors down one after the other, in order; new camera samples fill the free end, so
//! that lanes stay full. The pool holds what moves with a path; its spectra lie in rows by sample
//! ([`Rows`]) and stay where they are.

pub use crate::math::lanes::WIDEST;
use crate::math::lanes::{Int, Lanes, Scalar};
pub use crate::math::packet::{array, each, int_array};
use crate::math::vec3::Vec3;
use crate::sample::sequence::Identity;

/// Paths in flight: a multiple of every lane count, small enough to stay in the cache beside the
/// results.
pub const POOL: usize = 512;
/// Places for numbers of paths: a packet may be stored at any, so it may reach past the last path.
const PLACES: usize = POOL + WIDEST;
/// Reals and integers of a path.
const REALS: usize = 7;
const INTS: usize = 7;

/// A packet of paths.
#[derive(Clone, Copy)]
pub struct Paths<L: Lanes> {
    /// Origins of the next segments.
    pub origin: Vec3<L::Real>,
    /// Their unit directions.
    pub direction: Vec3<L::Real>,
    /// Solid-angle densities with which the directions were chosen, sr⁻¹.
    pub pdf: L::Real,
    /// Objects that the segments leave, or [`NOTHING`](super::intersect::NOTHING).
    pub leaving: L::Int,
    /// Bits of [`flags`].
    pub flags: L::Int,
    /// Which random numbers are theirs; the bounce is the number of segments traced so far.
    pub id: Identity<L>,
    /// Where their spectra are among [`Rows`].
    pub slot: L::Int,
    /// Which row of every table holds their wavelengths.
    pub row: L::Int,
}

impl<L: Lanes> Paths<L> {
    /// In the order of the pool's columns.
    #[inline(always)]
    fn numbers(&self) -> ([L::Real; REALS], [L::Int; INTS]) {
        let (o, d, id) = (self.origin, self.direction, self.id);
        let (leaving, flags, slot, row) = (self.leaving, self.flags, self.slot, self.row);
        (
            [o.x, o.y, o.z, d.x, d.y, d.z, self.pdf],
            [leaving, flags, id.key, id.index, id.bounce, slot, row],
        )
    }
}

/// Truths about a path, one a bit.
pub mod flags {
    /// The segment goes into the object it leaves.
    pub const INWARD: u32 = 1;
    /// The direction was the only one possible: light sampling could not have found it.
    pub const SPECULAR: u32 = 2;
    /// The secondary wavelengths have ended.
    pub const TERMINATED: u32 = 4;
    /// The path is beyond `max_depth` and only measures what that cuts off.
    pub const BEYOND: u32 = 8;
}

/// Columns on the borders of cache lines, which packets then do not cross.
#[derive(Debug)]
#[repr(align(64))]
struct Columns<T, const N: usize>([[T; PLACES]; N]);

/// Paths in flight, their numbers by column.
#[derive(Debug)]
pub struct Pool<T> {
    /// Number of paths.
    pub length: usize,
    reals: Box<Columns<T, REALS>>,
    ints: Box<Columns<u32, INTS>>,
}

/// A path's values at its wavelengths, which are wanted together.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub struct Carried<T, const C: usize> {
    /// Product of bsdf · |cos|/pdf over the vertices so far.
    pub throughput: [T; C],
    /// Radiance gathered so far, W·m⁻²·sr⁻¹·nm⁻¹.
    pub radiance: [T; C],
}

impl<T: Scalar, const C: usize> Carried<T, C> {
    /// Multiplies the throughput by a factor at each wavelength.
    #[inline(always)]
    pub fn weigh(&mut self, factors: &[T; C]) {
        for (throughput, factor) in self.throughput.iter_mut().zip(factors) {
            *throughput = *throughput * *factor;
        }
    }

    /// Adds throughput × weight × value × emission to the radiance.
    #[inline(always)]
    pub fn receive(&mut self, weight: T, value: &[T; C], emission: &[T; C]) {
        for c in 0..C {
            let scattered = self.throughput[c] * weight * value[c];
            self.radiance[c] = scattered.fused(emission[c], self.radiance[c]);
        }
    }
}

/// What a path carries at the camera.
impl<T: Scalar, const C: usize> Default for Carried<T, C> {
    #[inline(always)]
    fn default() -> Self {
        Self {
            throughput: [T::from_f64(1.0); C],
            radiance: [T::default(); C],
        }
    }
}

/// Spectra of the samples of a chunk, one row of C values a sample.
#[derive(Debug)]
pub struct Rows<T, const C: usize> {
    /// What the paths carry and have gathered.
    pub paths: Vec<Carried<T, C>>,
    /// Which row of every spectrum holds the path's wavelengths.
    pub row: Vec<u32>,
    /// Which of the wavelengths is the hero.
    pub hero: Vec<u32>,
    /// How far into its cell each wavelength lies, [0, 1).
    pub fraction: Vec<T>,
}

impl<T: Scalar, const C: usize> Rows<T, C> {
    /// Rows for so many samples.
    pub fn new(samples: usize) -> Self {
        Self {
            paths: vec![Carried::default(); samples],
            row: vec![0; samples],
            hero: vec![0; samples],
            fraction: vec![T::default(); samples],
        }
    }
}

impl<T: Scalar> Default for Pool<T> {
    fn default() -> Self {
        Self {
            length: 0,
            reals: Box::new(Columns([[T::default(); PLACES]; REALS])),
            ints: Box::new(Columns([[0; PLACES]; INTS])),
        }
    }
}

impl<T: Scalar> Pool<T> {
    /// The packet at `at`, and the lanes in which it holds paths.
    #[inline(always)]
    pub fn read<L: Lanes<Scalar = T>>(&self, l: L, at: usize) -> (Paths<L>, L::Mask) {
        let real = inlined!(|i: usize| l.load(&self.reals.0[i][at..]));
        let int = inlined!(|i: usize| l.load_int(&self.ints.0[i][at..]));
        let paths = Paths {
            origin: Vec3::new(real(0), real(1), real(2)),
            direction: Vec3::new(real(3), real(4), real(5)),
            pdf: real(6),
            leaving: int(0),
            flags: int(1),
            id: Identity {
                key: int(2),
                index: int(3),
                bounce: int(4),
            },
            slot: int(5),
            row: int(6),
        };
        let here = (self.length - at).min(L::COUNT);
        (paths, l.mask_from_bits(((1u64 << here) - 1) as u32))
    }

    /// Writes a packet at `at`.
    #[inline(always)]
    pub fn write<L: Lanes<Scalar = T>>(&mut self, l: L, at: usize, paths: &Paths<L>) {
        let (reals, ints) = paths.numbers();
        for (column, x) in self.reals.0.iter_mut().zip(reals) {
            l.store(x, &mut column[at..]);
        }
        for (column, x) in self.ints.0.iter_mut().zip(ints) {
            l.store_int(x, &mut column[at..]);
        }
    }

    /// Writes the paths in the lanes of `keep` from `at` on; of what stood in the rest of a packet
    /// there, nothing is left.
    #[inline(always)]
    pub fn keep<L: Lanes<Scalar = T>>(&mut self, l: L, at: usize, paths: &Paths<L>, keep: L::Mask) {
        let (reals, ints) = paths.numbers();
        for (column, x) in self.reals.0.iter_mut().zip(reals) {
            l.compress_into(x, keep, &mut column[at..]);
        }
        for (column, x) in self.ints.0.iter_mut().zip(ints) {
            l.compress_int_into(x, keep, &mut column[at..]);
        }
    }
}

/// Where a lane's flags contain a bit.
#[inline(always)]
pub fn has<L: Lanes>(l: L, value: L::Int, bit: u32) -> L::Mask {
    !(value & l.int(bit)).same(l.int(0))
}

/// The bit where the mask is true, else 0.
#[inline(always)]
pub fn bit_where<L: Lanes>(l: L, m: L::Mask, bit: u32) -> L::Int {
    l.select_int(m, l.int(bit), l.int(0))
}
