//! Which instruction set to run, and one pass of samples over the image.

use fearless_simd::Level;
use rayon::prelude::*;

use super::tile::{Instructions, Runs, Tile, Worker};
use crate::integrate::develop::Spectrometer;
use crate::integrate::model::Model;
use crate::plan::{Plan, Tables};

/// Instruction sets by name, best first.
pub const INSTRUCTION_NAMES: [&str; 4] = ["avx512", "avx2", "sse2", "neon"];

/// The instruction set of that name if this machine has it; `None` as name takes the best.
pub fn instructions(name: Option<&str>) -> Option<Instructions> {
    let level = Level::new();
    let wanted = |own: &str| name.is_none_or(|name| name == own);
    #[cfg(target_arch = "x86_64")]
    {
        if wanted("avx512")
            && let Some(simd) = level.as_avx512()
        {
            return Some(Instructions::Avx512(simd));
        }
        if wanted("avx2")
            && let Some(simd) = level.as_avx2()
        {
            return Some(Instructions::Avx2(simd));
        }
        if wanted("sse2")
            && let Some(simd) = level.as_sse2()
        {
            return Some(Instructions::Sse2(simd));
        }
        None
    }
    #[cfg(target_arch = "aarch64")]
    {
        return match level.as_neon() {
            Some(simd) if wanted("neon") => Some(Instructions::Neon(simd)),
            _ => None,
        };
    }
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    {
        let _ = (level, wanted);
        None
    }
}

/// Adds samples `from .. to` of every pixel of every tile, on the threads of the current pool.
pub fn run(plan: &Plan, level: Instructions, tiles: &mut [Tile], from: u32, to: u32) {
    match (&plan.tables, plan.choices.wavelengths) {
        (Tables::Single(scene), 4) => spread::<f32, 4>(scene, level, tiles, from, to),
        (Tables::Single(scene), _) => spread::<f32, 8>(scene, level, tiles, from, to),
        (Tables::Double(scene), 4) => spread::<f64, 4>(scene, level, tiles, from, to),
        (Tables::Double(scene), _) => spread::<f64, 8>(scene, level, tiles, from, to),
    }
}

fn spread<T: Runs, const C: usize>(
    scene: &(Model<T>, Spectrometer<T>),
    level: Instructions,
    tiles: &mut [Tile],
    from: u32,
    to: u32,
) {
    tiles
        .par_iter_mut()
        .for_each_init(Worker::<T, C>::default, |worker, tile| {
            T::run(level, scene, tile, from, to, worker);
        });
}
