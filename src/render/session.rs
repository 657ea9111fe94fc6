//! Rendering in passes over all tiles, and the estimates made of their sums.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::bins::{BinGrid, Bins};
use super::tile::{Outside, Tile, Window, Worker};
use crate::film::pixels;
use crate::integrate::chunk;
use crate::integrate::develop::Spectrometer;
use crate::integrate::dispatch::Runs;
use crate::integrate::intersect::Tiers;
use crate::integrate::model::Model;
use crate::math::instructions::Instructions;
use crate::plan::{Plan, Tables};
use crate::sample::replicates::Replicates;
use crate::spectrum::observer::xyz_to_linear_srgb;
use crate::stats::Estimate;
use crate::stats::blocks::{EDGE, members};

/// What to render besides what the plan says.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// The pixels wanted; coordinates are those of the whole image.
    pub window: Window,
    /// Samples a pixel at most.
    pub samples: u32,
    /// Wall-clock time after which no further pass begins.
    pub time: Option<Duration>,
    /// Instruction set; the bits are the same with each.
    pub instructions: Instructions,
    /// Bins of wavelength that radiance is summed in besides.
    pub bins: Option<&'a BinGrid>,
}

/// Watches a render between its passes, and may stop it.
pub trait Progress {
    /// Called after each pass with the samples a pixel done and wanted, the time spent, and the
    /// standard error of the mean luminance over the mean, where it is known; `false` stops the render.
    fn passed(&mut self, done: u32, wanted: u32, spent: Duration, error: Option<f64>) -> bool;
}

/// Never stops a render.
#[derive(Debug, Clone, Copy)]
pub struct Unwatched;

impl Progress for Unwatched {
    fn passed(&mut self, _: u32, _: u32, _: Duration, _: Option<f64>) -> bool {
        true
    }
}

/// A finished render.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The pixels that were rendered.
    pub window: Window,
    /// Samples a pixel.
    pub samples: u32,
    /// Wall-clock seconds of all passes.
    pub seconds: f64,
    /// Number of rays that each arithmetic decided.
    pub tiers: Tiers,
    /// Samples left out because they were not numbers.
    pub not_a_number: u64,
    /// The first sample left out, to be replayed.
    pub first_not_a_number: Option<chunk::Request>,
    /// Mean luminance after the last pass.
    luminance: Estimate,
    replicates: Replicates,
    tiles: Vec<Tile>,
}

impl Request<'_> {
    /// All of a picture, with the best instructions there are and no limit of time.
    pub fn whole(size: [u32; 2], samples: u32) -> Self {
        Self {
            window: Window::whole(size),
            samples,
            time: None,
            instructions: Instructions::best(),
            bins: None,
        }
    }
}

/// Renders. Passes are over the whole window and their sizes are fixed before they begin, so that
/// stopping between them favours no sample.
pub fn render(plan: &Plan, request: &Request, progress: &mut dyn Progress) -> Rendered {
    let (replicates, samples) = (plan.choices.replicates, request.samples);
    let shares = request.bins.map(|grid| Arc::new(grid.shares(&plan.grid)));
    let bins = |pixels: usize| Some(Bins::new(pixels, shares.clone()?, replicates, samples));
    let tiles = request.window.tiles().into_iter().map(|window| Tile {
        bins: bins(window.pixels()),
        ..Tile::new(window, replicates, samples)
    });
    let mut rendered = Rendered {
        window: request.window,
        samples: 0,
        seconds: 0.0,
        tiers: Tiers::default(),
        not_a_number: 0,
        first_not_a_number: None,
        luminance: Estimate::exact(f64::NAN),
        replicates,
        tiles: tiles.collect(),
    };
    let start = Instant::now();
    while rendered.samples < request.samples {
        let size = next_pass(&rendered, request, start.elapsed());
        let (from, to) = (rendered.samples, rendered.samples + size);
        pass(plan, request.instructions, &mut rendered.tiles, from, to);
        rendered.samples = to;
        rendered.seconds = start.elapsed().as_secs_f64();
        rendered.luminance = rendered.luminance_of_tiles();
        let error = rendered.luminance.relative_error();
        let goes_on = progress.passed(to, request.samples, start.elapsed(), error);
        let late = request.time.is_some_and(|time| start.elapsed() >= time);
        if !goes_on || late {
            break;
        }
    }
    for tile in &rendered.tiles {
        rendered.tiers = rendered.tiers.joined(tile.tiers);
        rendered.not_a_number += tile.not_a_number;
        rendered.first_not_a_number = rendered.first_not_a_number.or(tile.first_not_a_number);
    }
    rendered
}

/// Adds samples `from .. to` of every pixel of every tile, on the threads of the current pool.
fn pass(plan: &Plan, level: Instructions, tiles: &mut [Tile], from: u32, to: u32) {
    match (&plan.tables, plan.choices.wavelengths) {
        (Tables::Single(scene), 4) => spread::<f32, 4>(scene, level, tiles, from, to),
        (Tables::Single(scene), _) => spread::<f32, 8>(scene, level, tiles, from, to),
        (Tables::Double(scene), 4) => spread::<f64, 4>(scene, level, tiles, from, to),
        (Tables::Double(scene), _) => spread::<f64, 8>(scene, level, tiles, from, to),
    }
}

fn spread<T: Runs<C>, const C: usize>(
    scene: &(Model<T>, Spectrometer<T>),
    level: Instructions,
    tiles: &mut [Tile],
    from: u32,
    to: u32,
) {
    // A bridge asks for buffers once a thread; splitting the slice would ask at every split.
    tiles
        .iter_mut()
        .par_bridge()
        .for_each_init(Worker::<T, C>::default, |worker, tile| {
            tile.add(level, scene, from, to, worker);
        });
}

/// Longest a pass should take, seconds, so that stopping is never far away.
const LONGEST_PASS: f64 = 2.0;
/// Samples of the first pass, before the speed is known.
const FIRST_PASS: u32 = 4;

/// Samples of the next pass: from the speed so far, as many as [`LONGEST_PASS`] and the time left
/// allow, at most as many as there are already (so that sizes double), at least one.
fn next_pass(rendered: &Rendered, request: &Request, spent: Duration) -> u32 {
    let left = request.samples - rendered.samples;
    if rendered.samples == 0 {
        return left.min(FIRST_PASS);
    }
    let rate = f64::from(rendered.samples) / rendered.seconds.max(1e-9);
    let seconds = match request.time {
        Some(time) => time.saturating_sub(spent).as_secs_f64().min(LONGEST_PASS),
        None => LONGEST_PASS,
    };
    let fitting = (rate * seconds) as u32;
    fitting.clamp(1, 7 * rendered.samples).min(left)
}

/// Means over a region of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// Y: radiance weighted by the luminous efficiency ȳ, W·m⁻²·sr⁻¹·nm⁻¹; of light of constant
    /// spectral radiance it is that radiance.
    pub luminance: Estimate,
    /// Linear R, G, B (Rec. ITU-R BT.709 primaries, white D65).
    pub rgb: [Estimate; 3],
}

impl Rendered {
    /// Every pixel's estimate in linear Rec. 709, row by row.
    pub fn rgb(&self) -> Vec<pixels::Estimate> {
        self.estimates(xyz_to_linear_srgb)
    }

    /// Every pixel's estimate in X, Y, Z, row by row.
    pub fn xyz(&self) -> Vec<pixels::Estimate> {
        self.estimates(|xyz| xyz)
    }

    /// Every pixel's estimate of radiance in a bin, row by row; `None` where bins were not asked
    /// for.
    pub fn bin(&self, bin: usize) -> Option<Vec<pixels::Estimate<1>>> {
        let counts = self.counts();
        let unknown = pixels::Estimate::UNKNOWN;
        let estimate = |tile: &Tile, pixel: usize| {
            let bins = tile.bins.as_ref();
            bins.map_or(unknown, |bins| bins.estimate(pixel, bin, &counts))
        };
        let wanted = self.tiles.iter().all(|tile| tile.bins.is_some());
        wanted.then(|| self.image(unknown, estimate))
    }

    /// Luminance of every pixel, row by row, in each of its replicates.
    pub fn replicate_luminances(&self) -> Vec<Vec<f64>> {
        let counts = self.counts();
        self.image(Vec::new(), |tile, pixel| {
            let means = tile.pixels.replicate_means(pixel, &counts);
            means.map(|xyz| xyz[1]).collect()
        })
    }

    /// Replicates that every pixel has.
    pub fn replicates(&self) -> u32 {
        self.replicates.count(self.samples)
    }

    /// Samples of each replicate, the same for every pixel.
    fn counts(&self) -> Vec<f64> {
        self.replicates.counts(self.samples)
    }

    fn estimates(&self, channels: impl Fn([f64; 3]) -> [f64; 3] + Copy) -> Vec<pixels::Estimate> {
        let counts = self.counts();
        self.image(pixels::Estimate::UNKNOWN, |tile, pixel| {
            tile.pixels.estimate(pixel, &counts, channels)
        })
    }

    /// The values that a tile has for its own pixels, for every pixel of the image, row by row.
    fn image<V: Clone>(&self, empty: V, value: impl Fn(&Tile, usize) -> V) -> Vec<V> {
        let mut image = vec![empty; self.window.pixels()];
        let width = self.window.width() as usize;
        for tile in &self.tiles {
            let tile_width = tile.window.width() as usize;
            for pixel in 0..tile.window.pixels() {
                let x = (tile.window.x0 - self.window.x0) as usize + pixel % tile_width;
                let y = (tile.window.y0 - self.window.y0) as usize + pixel / tile_width;
                image[y * width + x] = value(tile, pixel);
            }
        }
        image
    }

    /// Means over the pixels of a region, which are scrambled independently of each other; standard
    /// errors are NaN with a single replicate.
    ///
    /// # Errors
    /// [`Outside`] where the region is empty or not all of it was rendered.
    pub fn mean(&self, region: Window) -> Result<Mean, Outside> {
        if !region.is_inside(&self.window) {
            let size = [self.window.width(), self.window.height()];
            return Err(Outside {
                window: region,
                size,
            });
        }
        let (xyz, rgb) = (self.xyz(), self.rgb());
        let row = |y: u32| {
            let start = (y - self.window.y0) * self.window.width() - self.window.x0;
            (region.x0..region.x1).map(move |x| (start + x) as usize)
        };
        let pixels: Vec<usize> = (region.y0..region.y1).flat_map(row).collect();
        Ok(Mean {
            luminance: self.mean_of(&xyz, &pixels, 1),
            rgb: [0, 1, 2].map(|channel| self.mean_of(&rgb, &pixels, channel)),
        })
    }

    /// Mean luminance of each block of 8 × 8 pixels, row by row.
    pub fn block_luminances(&self) -> Vec<Estimate> {
        let [width, height] = [self.window.width(), self.window.height()].map(|n| n as usize);
        let (image, blocks) = (self.xyz(), members(width, height, EDGE));
        let blocks = blocks.iter();
        blocks.map(|block| self.mean_of(&image, block, 1)).collect()
    }

    /// The mean of a channel of an image of this render over some of its pixels.
    fn mean_of(&self, image: &[pixels::Estimate], pixels: &[usize], channel: usize) -> Estimate {
        let values: Vec<f64> = pixels.iter().map(|&i| image[i].mean[channel]).collect();
        let errors = pixels.iter().map(|&i| image[i].standard_error[channel]);
        let variances: Vec<f64> = errors.map(|e| e * e).collect();
        Estimate::mean_of(&values, &variances, f64::from(self.replicates()) - 1.0)
    }

    /// Mean luminance; pixels are scrambled independently, so their squared standard errors add. The
    /// standard error is NaN with a single replicate.
    pub fn mean_luminance(&self) -> Estimate {
        self.luminance
    }

    fn luminance_of_tiles(&self) -> Estimate {
        // Tiles side by side, then their sums in order: the same bits on any number of threads.
        let counts = self.counts();
        let tiles = self.tiles.par_iter();
        let sums: Vec<[f64; 3]> = tiles.map(|tile| luminance(tile, &counts)).collect();
        let [mut sum, mut variance, mut squares] = [0.0; 3];
        for [own_sum, own_variance, own_squares] in sums {
            sum += own_sum;
            variance += own_variance;
            squares += own_squares;
        }
        let freedom = f64::from(self.replicates()) - 1.0;
        Estimate::of_sums(self.window.pixels(), sum, [variance, squares], freedom)
    }

    /// Camera paths a second.
    pub fn samples_per_second(&self) -> f64 {
        self.window.pixels() as f64 * f64::from(self.samples) / self.seconds
    }

    /// Share of the luminance that `max_depth` cuts off.
    pub fn cut_off(&self) -> Estimate {
        let samples = self.window.pixels() as f64 * f64::from(self.samples);
        let (mut sum, mut squares) = (0.0, 0.0);
        for tile in &self.tiles {
            sum += tile.beyond.sum;
            squares += tile.beyond.squares;
        }
        let mean = sum / samples;
        let error = ((squares / samples - mean * mean).max(0.0) / samples).sqrt();
        let whole = self.mean_luminance().value + mean;
        if whole > 0.0 {
            Estimate {
                value: mean / whole,
                standard_error: error / whole,
                freedom: samples - 1.0,
            }
        } else {
            Estimate::exact(0.0)
        }
    }
}

/// Σ Y, Σ v and Σ v² of a tile's pixels, where v is the squared standard error of Y.
fn luminance(tile: &Tile, counts: &[f64]) -> [f64; 3] {
    let [mut sum, mut variance, mut squares] = [0.0; 3];
    for pixel in 0..tile.window.pixels() {
        let estimate = tile.pixels.estimate(pixel, counts, |xyz| xyz);
        let own = estimate.standard_error[1] * estimate.standard_error[1];
        sum += estimate.mean[1];
        variance += own;
        squares += own * own;
    }
    [sum, variance, squares]
}
