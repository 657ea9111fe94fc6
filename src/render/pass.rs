//! One pass of samples over the image.

use rayon::prelude::*;

use super::tile::{Tile, Worker};
use crate::integrate::develop::Spectrometer;
use crate::integrate::dispatch::Runs;
use crate::integrate::model::Model;
use crate::math::instructions::Instructions;
use crate::plan::{Plan, Tables};

/// Adds samples `from .. to` of every pixel of every tile, on the threads of the current pool.
pub fn run(plan: &Plan, level: Instructions, tiles: &mut [Tile], from: u32, to: u32) {
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
