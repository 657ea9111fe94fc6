//! The state of the paths in flight: a structure of arrays that stays packed.
//!
//! Paths end at different times. Each pass over the pool advances all of them by one segment;
//! when enough have ended the survivors are moved together, in order, and new camera samples fill
//! the free end, so that lanes stay full.

use crate::math::lanes::{Lanes, Mask};

/// Real numbers of a path before its spectral ones.
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

/// Number of reals before the spectral ones.
const PLAIN_REALS: usize = 7;

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
    /// Where the result goes.
    Slot = 5,
}

/// Number of integers.
const INTS: usize = 6;

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

/// Paths in flight with `C` wavelengths each.
#[derive(Debug)]
pub struct Pool<T, const C: usize> {
    capacity: usize,
    /// Lanes of a packet.
    lanes: usize,
    /// Paths in the pool, ended ones included.
    pub length: usize,
    /// Paths still going.
    pub alive: usize,
    reals: Vec<T>,
    ints: Vec<u32>,
    /// One word of alive lanes a packet.
    pub masks: Vec<u32>,
}

/// Where a spectral quantity of wavelength j is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum SpectralField {
    /// Throughput.
    Throughput = 0,
    /// Radiance gathered.
    Radiance = 1,
    /// Wavelength as a position on the grid.
    Position = 2,
}

/// Number of spectral quantities.
const SPECTRAL: usize = 3;

/// The results of a chunk of samples, by slot.
#[derive(Debug)]
pub struct Results<T, const C: usize> {
    /// Radiance of wavelength j in slot s at `j * capacity + s`.
    pub radiance: Vec<T>,
    /// Hero wavelength variates.
    pub hero: Vec<T>,
    /// Number of slots.
    pub capacity: usize,
}

impl<T: Copy + Default, const C: usize> Results<T, C> {
    /// Room for `capacity` samples.
    pub fn new(capacity: usize) -> Self {
        Self {
            radiance: vec![T::default(); C * capacity],
            hero: vec![T::default(); capacity],
            capacity,
        }
    }
}

impl<T: Copy + Default, const C: usize> Pool<T, C> {
    /// An empty pool for `paths` paths.
    pub fn new(paths: usize) -> Self {
        let real_fields = PLAIN_REALS + SPECTRAL * C;
        // A packet may be stored at any place, so it may reach past the last path.
        let capacity = paths + 16;
        Self {
            capacity,
            lanes: 1,
            length: 0,
            alive: 0,
            reals: vec![T::default(); real_fields * capacity],
            ints: vec![0; INTS * capacity],
            masks: vec![0; capacity],
        }
    }

    /// Declares every path in the pool alive.
    pub fn all_alive<L: Lanes>(&mut self) {
        self.alive = self.length;
        let mut left = self.length;
        for mask in &mut self.masks {
            let here = left.min(L::COUNT);
            *mask = ((1u64 << here) - 1) as u32;
            left -= here;
            if here == 0 {
                break;
            }
        }
        self.lanes = L::COUNT;
    }

    /// The places of paths that have ended since the last compaction.
    pub fn ended(&self) -> impl Iterator<Item = usize> + '_ {
        let (lanes, length) = (self.lanes, self.length);
        (0..length)
            .step_by(lanes)
            .enumerate()
            .flat_map(move |(packet, at)| {
                let here = (length - at).min(lanes);
                let all = ((1u64 << here) - 1) as u32;
                let mut bits = all & !self.masks[packet];
                std::iter::from_fn(move || {
                    (bits != 0).then(|| {
                        let i = bits.trailing_zeros() as usize;
                        bits &= bits - 1;
                        at + i
                    })
                })
            })
    }

    #[inline(always)]
    fn real_at(&self, field: usize, at: usize) -> usize {
        field * self.capacity + at
    }

    /// Reads a packet of a plain field's component.
    #[inline(always)]
    pub fn real<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        field: RealField,
        i: usize,
        at: usize,
    ) -> L::Real {
        l.load(&self.reals[self.real_at(field as usize + i, at)..])
    }

    /// Writes a packet of a plain field's component.
    #[inline(always)]
    pub fn set_real<L: Lanes<Scalar = T>>(
        &mut self,
        l: L,
        field: RealField,
        i: usize,
        at: usize,
        x: L::Real,
    ) {
        let at = self.real_at(field as usize + i, at);
        l.store(x, &mut self.reals[at..]);
    }

    #[inline(always)]
    fn spectral_at(&self, field: SpectralField, j: usize, at: usize) -> usize {
        self.real_at(PLAIN_REALS + field as usize * C + j, at)
    }

    /// Reads a packet of a spectral field.
    #[inline(always)]
    pub fn spectral<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        field: SpectralField,
        at: usize,
    ) -> [L::Real; C] {
        std::array::from_fn(|j| l.load(&self.reals[self.spectral_at(field, j, at)..]))
    }

    /// Writes a packet of a spectral field.
    #[inline(always)]
    pub fn set_spectral<L: Lanes<Scalar = T>>(
        &mut self,
        l: L,
        field: SpectralField,
        at: usize,
        x: [L::Real; C],
    ) {
        for (j, x) in x.into_iter().enumerate() {
            let at = self.spectral_at(field, j, at);
            l.store(x, &mut self.reals[at..]);
        }
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

    /// One path's radiance.
    pub fn radiance_of(&self, at: usize) -> [T; C] {
        std::array::from_fn(|j| self.reals[self.spectral_at(SpectralField::Radiance, j, at)])
    }

    /// One path's wavelengths as grid positions.
    pub fn positions_of(&self, at: usize) -> [T; C] {
        std::array::from_fn(|j| self.reals[self.spectral_at(SpectralField::Position, j, at)])
    }

    /// One path's integer.
    pub fn int_of(&self, field: IntField, at: usize) -> u32 {
        self.ints[field as usize * self.capacity + at]
    }

    /// Moves the paths still going to the front, keeping their order.
    #[inline(always)]
    pub fn compact<L: Lanes<Scalar = T>>(&mut self, l: L) {
        let mut to = 0;
        for (packet, from) in (0..self.length).step_by(L::COUNT).enumerate() {
            let bits = self.masks[packet];
            let kept = bits.count_ones() as usize;
            if kept == 0 {
                continue;
            }
            if to != from || kept != L::COUNT {
                let keep = l.mask_from_bits(bits);
                for field in self.reals.chunks_exact_mut(self.capacity) {
                    let x = l.compress(l.load(&field[from..]), keep);
                    l.store(x, &mut field[to..]);
                }
                for field in self.ints.chunks_exact_mut(self.capacity) {
                    let x = l.compress_int(l.load_int(&field[from..]), keep);
                    l.store_int(x, &mut field[to..]);
                }
            }
            to += kept;
        }
        self.length = to;
        self.alive = to;
    }
}

/// Whether a lane's flags contain a bit.
#[inline(always)]
pub fn has<L: Lanes>(l: L, value: L::Int, bit: u32) -> L::Mask {
    use crate::math::lanes::Int;
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
