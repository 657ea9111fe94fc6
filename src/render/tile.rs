//! Tiles: the unit of work of one thread.

use super::bins::Bins;
use crate::film::pixels::Pixels;
use crate::integrate::chunk::{self, CHUNK, Workspace};
use crate::integrate::develop::Spectrometer;
use crate::integrate::intersect::Rungs;
use crate::integrate::model::Model;
use crate::math::lanes::{Double, Lanes, Scalar, Single};
use crate::sample::sequence::Replicates;

/// Edge of a tile in pixels.
pub const EDGE: u32 = 16;

/// A rectangle of pixels [x0, x1) × [y0, y1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub x0: u32,
    /// First row, from the top.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Window {
    /// Number of columns.
    pub fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Number of rows.
    pub fn height(&self) -> u32 {
        self.y1 - self.y0
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width() as usize * self.height() as usize
    }

    /// Cuts the window into tiles, row by row.
    pub fn tiles(&self) -> Vec<Self> {
        let mut tiles = Vec::new();
        for y0 in (self.y0..self.y1).step_by(EDGE as usize) {
            for x0 in (self.x0..self.x1).step_by(EDGE as usize) {
                tiles.push(Self {
                    x0,
                    y0,
                    x1: (x0 + EDGE).min(self.x1),
                    y1: (y0 + EDGE).min(self.y1),
                });
            }
        }
        tiles
    }
}

/// What a tile has gathered.
#[derive(Debug, Clone)]
pub struct Tile {
    /// Where it is.
    pub window: Window,
    /// Its sums, row by row.
    pub pixels: Pixels,
    /// Its spectral sums, where they are wanted.
    pub bins: Option<Bins>,
    /// Which arithmetic decided its rays.
    pub rungs: Rungs,
    /// Sum and sum of squares of the luminance beyond `max_depth`, by sample.
    pub beyond: chunk::Beyond,
    /// Samples that were not a number, and were left out.
    pub not_a_number: u64,
    /// The first of them.
    pub first_not_a_number: Option<chunk::Request>,
}

impl Tile {
    /// An empty tile.
    pub fn new(window: Window, replicates: Replicates) -> Self {
        Self {
            window,
            pixels: Pixels::new(window.pixels(), replicates),
            bins: None,
            rungs: Rungs::default(),
            beyond: chunk::Beyond::default(),
            not_a_number: 0,
            first_not_a_number: None,
        }
    }

    /// Adds samples `from .. to` of every pixel.
    #[inline(always)]
    fn add<L: Lanes, const C: usize>(
        &mut self,
        l: L,
        model: &Model<L::Scalar>,
        spectrometer: &Spectrometer<L::Scalar>,
        from: u32,
        to: u32,
        workspace: &mut Workspace<L::Scalar, C>,
        requests: &mut Vec<chunk::Request>,
    ) {
        workspace.rungs = Rungs::default();
        workspace.beyond = chunk::Beyond::default();
        let width = self.window.width();
        let mut pixel = 0;
        let mut sample = from;
        let pixels = self.window.pixels() as u32;
        while pixel < pixels {
            requests.clear();
            while requests.len() < CHUNK && pixel < pixels {
                let end = to.min(sample.saturating_add((CHUNK - requests.len()) as u32));
                let (x, y) = (
                    self.window.x0 + pixel % width,
                    self.window.y0 + pixel / width,
                );
                requests.extend((sample..end).map(|sample| chunk::Request { x, y, sample }));
                sample = end;
                if sample == to {
                    (pixel, sample) = (pixel + 1, from);
                }
            }
            chunk::render(l, model, spectrometer, requests, workspace);
            self.collect(requests, workspace);
        }
        self.rungs = self.rungs.joined(workspace.rungs);
        self.beyond.sum += workspace.beyond.sum;
        self.beyond.squares += workspace.beyond.squares;
    }

    fn collect<T: Scalar, const C: usize>(
        &mut self,
        requests: &[chunk::Request],
        workspace: &Workspace<T, C>,
    ) {
        let width = self.window.width();
        for (slot, (request, xyz)) in requests.iter().zip(&workspace.tristimulus).enumerate() {
            let xyz = xyz.map(Scalar::to_f64);
            if xyz.iter().all(|v| v.is_finite()) {
                let pixel = (request.y - self.window.y0) * width + request.x - self.window.x0;
                self.pixels.add(pixel as usize, request.sample, xyz);
                if let Some(bins) = &mut self.bins {
                    let rows = &workspace.rows;
                    bins.add(pixel as usize, &rows.radiance[slot], rows.row[slot]);
                }
            } else {
                self.not_a_number += 1;
                self.first_not_a_number.get_or_insert(*request);
            }
        }
    }
}

/// Buffers of a worker in either precision.
#[derive(Debug, Default)]
pub struct Worker<T, const C: usize>
where
    T: Scalar,
{
    workspace: Workspace<T, C>,
    requests: Vec<chunk::Request>,
}

/// A scalar whose lanes every instruction set can run.
pub trait Runs: Scalar {
    /// Adds samples `from .. to` of every pixel to a tile, on the given instruction set.
    fn run<const C: usize>(
        level: Instructions,
        scene: &(Model<Self>, Spectrometer<Self>),
        tile: &mut Tile,
        from: u32,
        to: u32,
        worker: &mut Worker<Self, C>,
    );
}

/// The instruction sets that a compiled copy of the loop exists for.
#[derive(Debug, Clone, Copy)]
pub enum Instructions {
    /// x86-64 with AVX-512 (Ice Lake and later).
    #[cfg(target_arch = "x86_64")]
    Avx512(fearless_simd::Avx512),
    /// x86-64 with AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    Avx2(fearless_simd::Avx2),
    /// Any x86-64.
    #[cfg(target_arch = "x86_64")]
    Sse2(fearless_simd::Sse2),
    /// Arm with Neon.
    #[cfg(target_arch = "aarch64")]
    Neon(fearless_simd::Neon),
    /// No vector unit that is known.
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    Fallback(fearless_simd::Fallback),
}

macro_rules! runs {
    ($scalar:ty, $lanes:ident) => {
        impl Runs for $scalar {
            fn run<const C: usize>(
                level: Instructions,
                scene: &(Model<Self>, Spectrometer<Self>),
                tile: &mut Tile,
                from: u32,
                to: u32,
                worker: &mut Worker<Self, C>,
            ) {
                use fearless_simd::Simd;
                macro_rules! on {
                    ($simd:expr) => {{
                        let simd = $simd;
                        simd.vectorize(
                            #[inline(always)]
                            || {
                                tile.add(
                                    $lanes(simd),
                                    &scene.0,
                                    &scene.1,
                                    from,
                                    to,
                                    &mut worker.workspace,
                                    &mut worker.requests,
                                )
                            },
                        )
                    }};
                }
                match level {
                    #[cfg(target_arch = "x86_64")]
                    Instructions::Avx512(simd) => on!(simd),
                    #[cfg(target_arch = "x86_64")]
                    Instructions::Avx2(simd) => on!(simd),
                    #[cfg(target_arch = "x86_64")]
                    Instructions::Sse2(simd) => on!(simd),
                    #[cfg(target_arch = "aarch64")]
                    Instructions::Neon(simd) => on!(simd),
                    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
                    Instructions::Fallback(simd) => on!(simd),
                }
            }
        }
    };
}

runs!(f32, Single);
runs!(f64, Double);
