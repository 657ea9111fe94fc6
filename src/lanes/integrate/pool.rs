//! The state of the paths in flight.
//!
//! Paths end at different times. Each pass over the pool advances all of them by one segment and
//! writes the survivors down one after the other, in order; new camera samples fill the free end, so
//! that lanes stay full. Only what changes places with a path lies in the pool;
//! its spectra lie in rows by sample ([`Rows`]) and stay where they are.

pub use crate::math::lanes::WIDEST;
use crate::math::lanes::{Int, Lanes, Mask, Scalar};
pub use crate::math::packet::{array, each, int_array};

/// Real numbers of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum RealField {
    /// Origin of the next segment, three numbers.
    Origin = 0,
    /// Its unit direction, three numbers.
    Direction = 3,
    /// Solid-angle density with which the direction was chosen.
    Pdf = 6,
}

/// Number of reals.
const REALS: usize = 7;

/// Integers of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum IntField {
    /// Object that the segment leaves.
    Departure = 0,
    /// Bits of [`flags`].
    Flags = 1,
    /// Segments traced so far.
    Depth = 2,
    /// Sampler key.
    Key = 3,
    /// Index within the replicate.
    Index = 4,
    /// Where its spectra are among [`Rows`].
    Slot = 5,
    /// Which row of every table holds its wavelengths.
    Row = 6,
}

/// Number of integers.
const INTS: usize = 7;

/// What is known of a path besides numbers.
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

/// Paths in flight.
#[derive(Debug)]
pub struct Pool<T> {
    capacity: usize,
    /// Number of paths.
    pub length: usize,
    reals: Vec<T>,
    ints: Vec<u32>,
}

/// A path's values at its wavelengths, which are wanted together.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub struct Carried<T, const C: usize> {
    /// Throughput of the path so far.
    pub throughput: [T; C],
    /// Radiance gathered.
    pub radiance: [T; C],
}

impl<T: Scalar, const C: usize> Carried<T, C> {
    /// At the camera.
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            throughput: [T::from_f64(1.0); C],
            radiance: [T::default(); C],
        }
    }

    /// Multiplies the throughput.
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

impl<T: Scalar, const C: usize> Default for Carried<T, C> {
    fn default() -> Self {
        Self::new()
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
    /// Room for `samples` samples.
    pub fn new(samples: usize) -> Self {
        Self {
            paths: vec![Carried::new(); samples],
            row: vec![0; samples],
            hero: vec![0; samples],
            fraction: vec![T::default(); samples],
        }
    }
}

impl<T: Copy + Default> Pool<T> {
    /// An empty pool for `paths` paths.
    pub fn new(paths: usize) -> Self {
        // A packet may be stored at any place, so it may reach past the last path.
        let capacity = paths + WIDEST;
        Self {
            capacity,
            length: 0,
            reals: vec![T::default(); REALS * capacity],
            ints: vec![0; INTS * capacity],
        }
    }

    /// Bits of the lanes that hold paths in the packet at `at`.
    #[inline(always)]
    pub fn active<L: Lanes>(&self, at: usize) -> u32 {
        let here = (self.length - at).min(L::COUNT);
        ((1u64 << here) - 1) as u32
    }

    /// Reads a packet of a field's component.
    #[inline(always)]
    pub fn real<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        field: RealField,
        i: usize,
        at: usize,
    ) -> L::Real {
        l.load(&self.reals[(field as usize + i) * self.capacity + at..])
    }

    /// Writes a packet of a field's component.
    #[inline(always)]
    pub fn set_real<L: Lanes<Scalar = T>>(
        &mut self,
        l: L,
        field: RealField,
        i: usize,
        at: usize,
        x: L::Real,
    ) {
        let at = (field as usize + i) * self.capacity + at;
        l.store(x, &mut self.reals[at..]);
    }

    /// Reads a packet of an integer field.
    #[inline(always)]
    pub fn int<L: Lanes<Scalar = T>>(&self, l: L, field: IntField, at: usize) -> L::Int {
        l.load_int(&self.ints[field as usize * self.capacity + at..])
    }

    /// Writes a packet of an integer field.
    #[inline(always)]
    pub fn set_int<L: Lanes<Scalar = T>>(&mut self, l: L, field: IntField, at: usize, x: L::Int) {
        let at = field as usize * self.capacity + at;
        l.store_int(x, &mut self.ints[at..]);
    }

    /// Writes the lanes in `keep` of a field's component from `at` on; of what stood in the rest of a
    /// packet there, nothing is left.
    #[inline(always)]
    pub fn keep_real<L: Lanes<Scalar = T>>(
        &mut self,
        l: L,
        field: RealField,
        i: usize,
        at: usize,
        (x, keep): (L::Real, L::Mask),
    ) {
        let at = (field as usize + i) * self.capacity + at;
        l.compress_into(x, keep, &mut self.reals[at..]);
    }

    /// The same of an integer field.
    #[inline(always)]
    pub fn keep_int<L: Lanes<Scalar = T>>(
        &mut self,
        l: L,
        field: IntField,
        at: usize,
        (x, keep): (L::Int, L::Mask),
    ) {
        let at = field as usize * self.capacity + at;
        l.compress_int_into(x, keep, &mut self.ints[at..]);
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

/// Whether any lane is true.
#[inline(always)]
pub fn any<M: Mask>(m: M) -> bool {
    m.any()
}
