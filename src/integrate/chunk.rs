//! A chunk of samples from camera to tristimulus values.

use super::bounce::bounce;
use super::develop::Spectrometer;
use super::intersect::{NOTHING, Rungs};
use super::model::Model;
use super::pool::{IntField, Pool, RealField, Results, SpectralField, flags};
use crate::math::lanes::Lanes;

/// Paths in flight: a multiple of every lane count, small enough to stay in the cache beside the
/// results.
pub const POOL: usize = 512;
/// Most samples of a chunk.
pub const CHUNK: usize = 4096;
/// A packet may write this far past the last sample.
const PADDING: usize = 16;

/// One camera sample to take: pixel and index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request {
    /// Column of the pixel.
    pub x: u32,
    /// Row of the pixel, from the top.
    pub y: u32,
    /// Index of the sample in the pixel, replicates interleaved.
    pub sample: u32,
}

/// What `max_depth` cuts off, as sums over camera samples of their luminance beyond it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beyond {
    /// Σ Y.
    pub sum: f64,
    /// Σ Y².
    pub squares: f64,
}

/// Buffers of one worker, used again for every chunk.
#[derive(Debug)]
pub struct Workspace<T, const C: usize> {
    pool: Pool<T, C>,
    /// Radiance by sample.
    pub results: Results<T, C>,
    /// X, Y, Z by sample.
    pub tristimulus: [Vec<T>; 3],
    /// Which arithmetic decided.
    pub rungs: Rungs,
    /// What `max_depth` cut off.
    pub beyond: Beyond,
}

impl<T: crate::math::lanes::Scalar, const C: usize> Workspace<T, C> {
    /// Allocates the buffers.
    pub fn new() -> Self {
        Self {
            pool: Pool::new(POOL),
            results: Results::new(CHUNK + PADDING),
            tristimulus: std::array::from_fn(|_| vec![T::default(); CHUNK + PADDING]),
            rungs: Rungs::default(),
            beyond: Beyond::default(),
        }
    }
}

impl<T: crate::math::lanes::Scalar, const C: usize> Default for Workspace<T, C> {
    fn default() -> Self {
        Self::new()
    }
}

/// Renders up to [`CHUNK`] requested samples; their tristimulus values are then in
/// `workspace.tristimulus`, by request.
#[inline(always)]
pub fn render<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    spectrometer: &Spectrometer<L::Scalar>,
    requests: &[Request],
    workspace: &mut Workspace<L::Scalar, C>,
) {
    let Workspace {
        pool,
        results,
        tristimulus,
        rungs,
        beyond,
    } = workspace;
    pool.length = 0;
    pool.alive = 0;
    let mut taken = 0;
    loop {
        let waiting = taken < requests.len();
        let holes = pool.length - pool.alive;
        let open = POOL - pool.alive;
        // Compaction moves every field of every path: only when a quarter of the places gains.
        if holes * 4 >= pool.length.max(1) || (waiting && open * 4 >= POOL) {
            retire(pool, results, spectrometer, beyond);
            pool.compact(l);
            while taken < requests.len() && pool.length + L::COUNT <= POOL {
                let end = requests.len().min(taken + L::COUNT);
                start(
                    l,
                    model,
                    spectrometer,
                    &requests[taken..end],
                    taken,
                    pool,
                    results,
                );
                taken = end;
            }
            pool.all_alive::<L>();
        }
        if pool.length == 0 {
            break;
        }
        let mut alive = 0;
        for (packet, at) in (0..pool.length).step_by(L::COUNT).enumerate() {
            let active = pool.masks[packet];
            if active == 0 {
                continue;
            }
            let survivors = bounce(l, model, pool, results, at, active, rungs) & active;
            pool.masks[packet] = survivors;
            alive += survivors.count_ones() as usize;
        }
        pool.alive = alive;
    }
    for at in (0..requests.len()).step_by(L::COUNT) {
        let xyz = spectrometer.tristimulus::<L, C>(l, results, at);
        for (values, to) in xyz.into_iter().zip(tristimulus.iter_mut()) {
            l.store(values, &mut to[at..]);
        }
    }
}

/// Puts the camera rays of at most one packet of requests at the end of the pool; their results
/// go to slots `first ..`.
#[inline(always)]
fn start<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    spectrometer: &Spectrometer<L::Scalar>,
    requests: &[Request],
    first: usize,
    pool: &mut Pool<L::Scalar, C>,
    results: &mut Results<L::Scalar, C>,
) {
    let mut numbers = [[0u32; PADDING]; 5];
    let replicates = model.sequence.replicates;
    for (i, request) in requests.iter().enumerate() {
        numbers[0][i] = request.x;
        numbers[1][i] = request.y;
        (numbers[2][i], numbers[3][i]) = replicates.place(request.sample);
        numbers[4][i] = (first + i) as u32;
    }
    let [x, y, replicate, index, slot] = numbers.map(|n| l.load_int(&n));
    let id = model.sequence.identity(l, x, y, replicate, index);
    let sample = model.sequence.camera(l, id, model.needs.lens);
    let (origin, direction) = model.camera.rays(l, x, y, &sample);

    let at = pool.length;
    for (field, v) in [
        (RealField::Origin, origin),
        (RealField::Direction, direction),
    ] {
        pool.set_real(l, field, 0, at, v.x);
        pool.set_real(l, field, 1, at, v.y);
        pool.set_real(l, field, 2, at, v.z);
    }
    let zero = l.real(0.0);
    pool.set_real(l, RealField::Pdf, 0, at, zero);
    let positions =
        std::array::from_fn(|j| spectrometer.wavelength::<L, C>(l, sample.wavelength, j).0);
    pool.set_spectral(l, SpectralField::Position, at, positions);
    pool.set_spectral(l, SpectralField::Throughput, at, [l.real(1.0); C]);
    pool.set_spectral(l, SpectralField::Radiance, at, [zero; C]);
    pool.set_int(l, IntField::Departure, at, l.int(NOTHING));
    pool.set_int(l, IntField::Flags, at, l.int(flags::SPECULAR));
    pool.set_int(l, IntField::Depth, at, l.int(0));
    pool.set_int(l, IntField::Key, at, id.key);
    pool.set_int(l, IntField::Index, at, id.index);
    pool.set_int(l, IntField::Slot, at, slot);
    l.store(sample.wavelength, &mut results.hero[first..]);
    pool.length += requests.len();
}

/// Hands in the results of the paths that have ended.
fn retire<T: crate::math::lanes::Scalar, const C: usize>(
    pool: &Pool<T, C>,
    results: &mut Results<T, C>,
    spectrometer: &Spectrometer<T>,
    beyond: &mut Beyond,
) {
    for at in pool.ended() {
        let radiance = pool.radiance_of(at);
        if pool.int_of(IntField::Flags, at) & flags::BEYOND != 0 {
            let y = spectrometer.luminance(radiance, pool.positions_of(at));
            beyond.sum += y;
            beyond.squares += y * y;
            continue;
        }
        let slot = pool.int_of(IntField::Slot, at) as usize;
        for (j, value) in radiance.into_iter().enumerate() {
            results.radiance[j * results.capacity + slot] = value;
        }
    }
}
