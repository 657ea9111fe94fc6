//! Tiles: the unit of work of one thread.

use std::fmt;
use std::ops::Range;

use super::bins::Bins;
use crate::film::pixels::{Pixels, is_finite};
use crate::integrate::chunk::{self, CHUNK, Workspace};
use crate::integrate::develop::Spectrometer;
use crate::integrate::dispatch::Runs;
use crate::integrate::intersect::Tiers;
use crate::integrate::model::Model;
use crate::math::instructions::Instructions;
use crate::math::lanes::Scalar;
use crate::sample::replicates::Replicates;

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

/// A window that is empty, or not all in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{window} is not inside the picture of {}x{} pixels", size[0], size[1])]
pub struct Outside {
    /// The window asked for.
    pub window: Window,
    /// Width and height of the picture.
    pub size: [u32; 2],
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { x0, y0, x1, y1 } = self;
        write!(f, "{x0},{y0},{x1},{y1}")
    }
}

impl Window {
    /// All pixels of an image of this width and height.
    pub fn whole([x1, y1]: [u32; 2]) -> Self {
        Self {
            x0: 0,
            y0: 0,
            x1,
            y1,
        }
    }

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

    /// Whether the window has pixels, all of them in `whole`.
    pub fn is_inside(&self, whole: &Self) -> bool {
        let within =
            |from: u32, to: u32, [least, most]: [u32; 2]| least <= from && from < to && to <= most;
        within(self.x0, self.x1, [whole.x0, whole.x1])
            && within(self.y0, self.y1, [whole.y0, whole.y1])
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

/// The sums of a tile.
#[derive(Debug, Clone)]
pub struct Tile {
    /// The pixels of the tile.
    pub window: Window,
    /// Sums of each pixel, row by row.
    pub pixels: Pixels,
    /// Spectral sums of each pixel, where they are wanted.
    pub bins: Option<Bins>,
    /// Number of rays that each arithmetic decided.
    pub tiers: Tiers,
    /// Sum and sum of squares of the luminance beyond `max_depth`, by sample.
    pub beyond: chunk::Beyond,
    /// Samples left out because they were not numbers.
    pub not_a_number: u64,
    /// The first sample left out.
    pub first_not_a_number: Option<chunk::Request>,
}

impl Tile {
    /// An empty tile for at most `samples` samples a pixel.
    pub fn new(window: Window, replicates: Replicates, samples: u32) -> Self {
        Self {
            window,
            pixels: Pixels::new(window.pixels(), replicates, samples),
            bins: None,
            tiers: Tiers::default(),
            beyond: chunk::Beyond::default(),
            not_a_number: 0,
            first_not_a_number: None,
        }
    }

    /// Adds samples `from .. to` of every pixel.
    pub fn add<T: Runs<C>, const C: usize>(
        &mut self,
        level: Instructions,
        scene: &(Model<T>, Spectrometer<T>),
        from: u32,
        to: u32,
        worker: &mut Worker<T, C>,
    ) {
        let Worker {
            workspace,
            requests,
            runs,
        } = worker;
        workspace.tiers = Tiers::default();
        workspace.beyond = chunk::Beyond::default();
        let mut pixel = 0;
        let mut sample = from;
        let pixels = self.window.pixels() as u32;
        while pixel < pixels {
            requests.clear();
            runs.clear();
            while requests.len() < CHUNK && pixel < pixels {
                let end = to.min(sample.saturating_add((CHUNK - requests.len()) as u32));
                let (x, y) = self.place(pixel);
                requests.push(x, y, sample, end);
                runs.push(Run {
                    pixel,
                    samples: sample..end,
                });
                sample = end;
                if sample == to {
                    (pixel, sample) = (pixel + 1, from);
                }
            }
            T::chunk(level, scene, requests, workspace);
            self.collect(runs, workspace);
        }
        self.tiers = self.tiers.joined(workspace.tiers);
        self.beyond.sum += workspace.beyond.sum;
        self.beyond.squares += workspace.beyond.squares;
    }

    /// Column and row of one of the tile's pixels.
    fn place(&self, pixel: u32) -> (u32, u32) {
        let width = self.window.width();
        (
            self.window.x0 + pixel % width,
            self.window.y0 + pixel / width,
        )
    }

    fn collect<T: Scalar, const C: usize>(&mut self, runs: &[Run], workspace: &Workspace<T, C>) {
        let mut slot = 0;
        for run in runs {
            let pixel = run.pixel as usize;
            let samples = run.samples.clone();
            let end = slot + samples.len();
            let values = &workspace.tristimulus[slot..end];
            let rejected = self.pixels.add(pixel, samples, values);
            if rejected > 0 {
                self.report(run, values);
                self.not_a_number += rejected;
            }
            if let Some(bins) = &mut self.bins {
                let rows = &workspace.rows;
                for ((slot, sample), xyz) in (slot..end).zip(run.samples.clone()).zip(values) {
                    if is_finite(xyz) {
                        let radiance = &rows.paths[slot].radiance;
                        bins.add(pixel, sample, radiance, rows.row[slot]);
                    }
                }
            }
            slot = end;
        }
    }

    /// Notes the first sample that is not a number.
    #[cold]
    fn report<T: Scalar>(&mut self, run: &Run, values: &[[T; 3]]) {
        let first = run.samples.clone().zip(values);
        if let Some((sample, _)) = first.into_iter().find(|(_, xyz)| !is_finite(xyz)) {
            let (x, y) = self.place(run.pixel);
            let request = chunk::Request { x, y, sample };
            self.first_not_a_number.get_or_insert(request);
        }
    }
}

/// Samples of one pixel that follow each other.
#[derive(Debug, Clone)]
struct Run {
    pixel: u32,
    samples: Range<u32>,
}

/// Buffers of a thread.
#[derive(Debug, Default)]
pub struct Worker<T: Scalar, const C: usize> {
    workspace: Workspace<T, C>,
    requests: chunk::Requests,
    runs: Vec<Run>,
}
