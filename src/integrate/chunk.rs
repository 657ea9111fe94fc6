//! A chunk of samples from camera to tristimulus values.

use super::bounce::bounce;
use super::develop::Spectrometer;
use super::intersect::{NOTHING, Rungs};
use super::model::Model;
use super::pool::{IntField, Pool, RealField, Rows, WIDEST, array, flags, int_array};
use super::replay::Vertex;
use crate::math::lanes::{Lanes, Scalar};
use crate::spectrum::grid::CELLS;

/// Paths in flight: a multiple of every lane count, small enough to stay in the cache beside the
/// results.
pub const POOL: usize = 512;
/// Most samples of a chunk.
pub const CHUNK: usize = 4096;

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
    pool: Pool<T>,
    /// Spectra by sample; behind [`CHUNK`] those of the paths that go on beyond `max_depth`.
    pub rows: Rows<T, C>,
    /// Samples of this chunk whose paths went on.
    beyond_slots: Vec<u32>,
    /// X, Y, Z by sample.
    pub tristimulus: Vec<[T; 3]>,
    /// Which arithmetic decided.
    pub rungs: Rungs,
    /// What `max_depth` cut off.
    pub beyond: Beyond,
    /// The vertices of a single request, to be written down.
    pub trace: Option<Vec<Vertex>>,
}

impl<T: Scalar, const C: usize> Workspace<T, C> {
    /// Allocates the buffers.
    pub fn new() -> Self {
        Self {
            pool: Pool::new(POOL),
            rows: Rows::new(2 * CHUNK),
            beyond_slots: Vec::new(),
            tristimulus: Vec::new(),
            rungs: Rungs::default(),
            beyond: Beyond::default(),
            trace: None,
        }
    }
}

impl<T: Scalar, const C: usize> Default for Workspace<T, C> {
    fn default() -> Self {
        Self::new()
    }
}

/// Renders up to [`CHUNK`] requested samples; their tristimulus values are then in
/// `workspace.tristimulus`, by request. A single request is written down vertex by vertex where
/// `workspace.trace` asks for it.
#[inline(never)]
pub fn render<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    spectrometer: &Spectrometer<L::Scalar>,
    requests: &[Request],
    workspace: &mut Workspace<L::Scalar, C>,
) {
    l.vectorize(
        #[inline(always)]
        || render_inlined(l, model, spectrometer, requests, workspace),
    );
}

#[inline(always)]
fn render_inlined<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    spectrometer: &Spectrometer<L::Scalar>,
    requests: &[Request],
    workspace: &mut Workspace<L::Scalar, C>,
) {
    let Workspace {
        pool,
        rows,
        beyond_slots,
        tristimulus,
        rungs,
        beyond,
        trace,
    } = workspace;
    pool.length = 0;
    pool.alive = 0;
    beyond_slots.clear();
    let mut taken = 0;
    loop {
        let waiting = taken < requests.len();
        let holes = pool.length - pool.alive;
        let open = POOL - pool.alive;
        // Compaction moves every field of every path: only when a quarter of the places gains.
        if holes * 4 >= pool.length.max(1) || (waiting && open * 4 >= POOL) {
            pool.compact(l);
            while taken < requests.len() && pool.length + L::COUNT <= POOL {
                let end = requests.len().min(taken + L::COUNT);
                start(l, model, &requests[taken..end], taken, pool, rows);
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
            let survivors =
                bounce(l, model, pool, rows, beyond_slots, at, active, rungs, trace) & active;
            pool.masks[packet] = survivors;
            alive += survivors.count_ones() as usize;
        }
        pool.alive = alive;
    }
    tristimulus.clear();
    for slot in 0..requests.len() {
        tristimulus.push(spectrometer.tristimulus(rows, slot));
    }
    // In the order of the samples, not of the paths' ends.
    beyond_slots.sort_unstable();
    for &slot in beyond_slots.iter() {
        let y = spectrometer.tristimulus(rows, slot as usize)[1].to_f64();
        beyond.sum += y;
        beyond.squares += y * y;
    }
}

/// Puts the camera rays of at most one packet of requests at the end of the pool; their rows are
/// `first ..`.
#[inline(always)]
fn start<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    requests: &[Request],
    first: usize,
    pool: &mut Pool<L::Scalar>,
    rows: &mut Rows<L::Scalar, C>,
) {
    let mut numbers = [[0u32; WIDEST]; 5];
    let replicates = model.sequence.replicates;
    for (i, request) in requests.iter().enumerate() {
        numbers[0][i] = request.x;
        numbers[1][i] = request.y;
        (numbers[2][i], numbers[3][i]) = replicates.place(request.sample);
        numbers[4][i] = (first + i) as u32;
    }
    let [x, y, replicate, index, slot] = [
        l.load_int(&numbers[0]),
        l.load_int(&numbers[1]),
        l.load_int(&numbers[2]),
        l.load_int(&numbers[3]),
        l.load_int(&numbers[4]),
    ];
    let id = model.sequence.identity(l, x, y, replicate, index);
    let sample = model.sequence.camera(l, id, model.needs.lens);
    let (origin, direction) = model.camera.rays(l, x, y, &sample);

    // The hero's cell, and from it the row that all C wavelengths share.
    let position = sample.wavelength * l.real(CELLS as f64);
    let cell = l.truncate(position);
    let cells = int_array(l, cell);
    let fractions = array(l, position - l.to_real(cell));
    let per_wavelength = (CELLS / C) as u32;
    for i in 0..requests.len() {
        let slot = first + i;
        rows.row[slot] = cells[i] % per_wavelength;
        rows.hero[slot] = cells[i] / per_wavelength;
        rows.fraction[slot] = fractions[i];
        rows.radiance[slot] = [L::Scalar::default(); C];
        rows.throughput[slot] = [L::Scalar::from_f64(1.0); C];
    }

    let at = pool.length;
    for (field, v) in [
        (RealField::Origin, origin),
        (RealField::Direction, direction),
    ] {
        pool.set_real(l, field, 0, at, v.x);
        pool.set_real(l, field, 1, at, v.y);
        pool.set_real(l, field, 2, at, v.z);
    }
    pool.set_real(l, RealField::Pdf, 0, at, l.real(0.0));
    pool.set_int(l, IntField::Departure, at, l.int(NOTHING));
    pool.set_int(l, IntField::Flags, at, l.int(flags::SPECULAR));
    pool.set_int(l, IntField::Depth, at, l.int(0));
    pool.set_int(l, IntField::Key, at, id.key);
    pool.set_int(l, IntField::Index, at, id.index);
    pool.set_int(l, IntField::Slot, at, slot);
    pool.length += requests.len();
}
