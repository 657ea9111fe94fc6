//! A chunk of samples from camera to tristimulus values.

use std::ops::Range;

use super::bounce::bounce;
use super::develop::Spectrometer;
use super::intersect::{NOTHING, Tiers};
use super::model::Model;
use super::pool::{Carried, POOL, Paths, Pool, Rows, WIDEST, flags};
use super::replay::Vertex;
use crate::math::lanes::{Int, Lanes, Scalar};
use crate::spectrum::grid::CELLS;

/// Most samples of a chunk.
pub const CHUNK: usize = 4096;
/// The number of each lane.
const LANE_NUMBERS: [u32; WIDEST] = {
    let mut numbers = [0; WIDEST];
    let mut i = 0;
    while i < WIDEST {
        numbers[i] = i as u32;
        i += 1;
    }
    numbers
};

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

/// Camera samples to take, by column; packets may read past the last one.
#[derive(Debug, Clone, Default)]
pub struct Requests {
    x: Vec<u32>,
    y: Vec<u32>,
    sample: Vec<u32>,
    length: usize,
}

impl Requests {
    #[inline]
    pub fn clear(&mut self) {
        for column in [&mut self.x, &mut self.y, &mut self.sample] {
            column.clear();
            column.resize(WIDEST, 0);
        }
        self.length = 0;
    }

    /// Adds samples `from .. to` of a pixel.
    #[inline]
    pub fn push(&mut self, x: u32, y: u32, from: u32, to: u32) {
        let length = self.length + (to - from) as usize;
        for (column, value) in [(&mut self.x, x), (&mut self.y, y)] {
            column.truncate(self.length);
            column.resize(length, value);
            column.resize(length + WIDEST, 0);
        }
        self.sample.truncate(self.length);
        self.sample.extend(from..to);
        self.sample.resize(length + WIDEST, 0);
        self.length = length;
    }

    #[inline]
    pub fn len(&self) -> usize {
        self.length
    }

    #[inline]
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }
}

/// What `max_depth` cuts off, as sums over camera samples of their luminance beyond it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beyond {
    /// Σ Y over the samples.
    pub sum: f64,
    /// Σ Y² over the samples.
    pub squares: f64,
}

/// Buffers of one worker, used again for every chunk.
#[derive(Debug)]
pub struct Workspace<T, const C: usize> {
    /// Paths in flight.
    pub pool: Pool<T>,
    /// Spectra by sample; behind [`CHUNK`] those of the paths that go on beyond `max_depth`.
    pub rows: Rows<T, C>,
    /// Samples of this chunk whose paths went on.
    pub(super) beyond_slots: Vec<u32>,
    /// The bsdf of each lane of a packet towards its sampled light.
    pub(super) values: [[T; C]; WIDEST],
    /// X, Y, Z by sample.
    pub tristimulus: Vec<[T; 3]>,
    /// Which arithmetic decided about rays.
    pub tiers: Tiers,
    /// What `max_depth` cut off.
    pub beyond: Beyond,
    /// The vertices of a single request, where they are to be written down.
    pub trace: Option<Vec<Vertex>>,
}

impl<T: Scalar, const C: usize> Default for Workspace<T, C> {
    fn default() -> Self {
        Self {
            pool: Pool::default(),
            rows: Rows::new(2 * CHUNK),
            beyond_slots: Vec::new(),
            values: [[T::default(); C]; WIDEST],
            tristimulus: Vec::new(),
            tiers: Tiers::default(),
            beyond: Beyond::default(),
            trace: None,
        }
    }
}

impl<T: Scalar, const C: usize> Workspace<T, C> {
    /// Turns the radiance of so many samples into tristimulus values.
    #[inline(always)]
    fn develop(&mut self, spectrometer: &Spectrometer<T>, samples: usize) {
        self.tristimulus.resize(samples, [T::default(); 3]);
        for (slot, xyz) in self.tristimulus.iter_mut().enumerate() {
            *xyz = spectrometer.tristimulus(&self.rows, slot);
        }
        // In the order of the samples, not of the paths' ends.
        self.beyond_slots.sort_unstable();
        for &slot in &self.beyond_slots {
            let y = spectrometer.tristimulus(&self.rows, slot as usize)[1].to_f64();
            self.beyond.sum += y;
            self.beyond.squares += y * y;
        }
    }
}

/// Renders up to [`CHUNK`] requested samples; their tristimulus values are then in
/// `workspace.tristimulus`, by request. A single request is written down vertex by vertex where
/// `workspace.trace` asks for it.
#[inline(always)]
pub fn render<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    spectrometer: &Spectrometer<L::Scalar>,
    requests: &Requests,
    workspace: &mut Workspace<L::Scalar, C>,
) {
    workspace.pool.length = 0;
    workspace.beyond_slots.clear();
    let mut taken = 0;
    loop {
        while taken < requests.len() && workspace.pool.length + L::COUNT <= POOL {
            let end = requests.len().min(taken + L::COUNT);
            start(l, model, requests, taken..end, workspace);
            taken = end;
        }
        if workspace.pool.length == 0 {
            break;
        }
        let mut going_on = 0;
        for at in (0..workspace.pool.length).step_by(L::COUNT) {
            // Survivors never reach beyond the packet that is being worked on.
            going_on += bounce(l, model, workspace, at, going_on);
        }
        workspace.pool.length = going_on;
    }
    workspace.develop(spectrometer, requests.len());
}

/// Puts the camera rays of the requests in `range`, at most one packet, at the end of the pool.
#[inline(always)]
fn start<L: Lanes, const C: usize>(
    l: L,
    model: &Model<L::Scalar>,
    requests: &Requests,
    range: Range<usize>,
    workspace: &mut Workspace<L::Scalar, C>,
) {
    let Workspace { pool, rows, .. } = workspace;
    let first = range.start;
    let count = range.len();
    let x = l.load_int(&requests.x[first..]);
    let y = l.load_int(&requests.y[first..]);
    let sample = l.load_int(&requests.sample[first..]);
    let (replicate, index) = model.sequence.replicates.places(l, sample);
    let id = model.sequence.identity(l, x, y, replicate, index);
    let sample = model.sequence.camera(l, id, model.needs.lens);
    let (origin, direction) = model.camera.rays(l, x, y, &sample);

    // The hero's cell, and from it the row that all C wavelengths share.
    let position = sample.wavelength * l.real(CELLS as f64);
    let cell = l.truncate(position);
    let row = cell & l.int((CELLS / C) as u32 - 1);
    l.store_int(row, &mut rows.row[first..]);
    l.store_int(
        cell.right((CELLS / C).trailing_zeros()),
        &mut rows.hero[first..],
    );
    l.store(position - l.to_real(cell), &mut rows.fraction[first..]);
    rows.paths[range].fill(Carried::default());

    let paths = Paths {
        origin,
        direction,
        pdf: l.real(0.0),
        leaving: l.int(NOTHING),
        flags: l.int(flags::SPECULAR),
        id,
        slot: l.load_int(&LANE_NUMBERS).plus(l.int(first as u32)),
        row,
    };
    pool.write(l, pool.length, &paths);
    pool.length += count;
}
