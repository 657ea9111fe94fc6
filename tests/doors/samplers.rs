//! Random numbers and what is made of them.

use etalon_lanes::math::instructions::{Instructions, Job, Precision};
use etalon_lanes::math::lanes::{Lanes, Scalar, WIDEST};
use etalon_lanes::math::packet::{array, int_array};
use etalon_lanes::sample::Slot;
use etalon_lanes::sample::mis::power_weight;
use etalon_lanes::sample::permute::permute;
use etalon_lanes::sample::sequence::Sequence;
use etalon_lanes::sample::sobol::nested_scramble;
use etalon_lanes::sample::warp::{
    cosine_hemisphere, cosine_hemisphere_pdf, square_to_disk, uniform_sphere,
};

use crate::columns::{columns, jobs};

/// Which numbers of a sample.
#[derive(Debug, Clone, Copy)]
pub enum Numbers {
    /// Position in the pixel (two), wavelength, position on the lens (two).
    Camera,
    /// The pair of a slot at a bounce.
    Pair(Slot, u32),
    /// The single number of a slot at a bounce.
    Single(Slot, u32),
}

impl Numbers {
    pub fn width(self) -> usize {
        match self {
            Self::Camera => 5,
            Self::Pair(..) => 2,
            Self::Single(..) => 1,
        }
    }
}

jobs! {
    /// Numbers of samples (x, y, replicate, index), the others of the five zero.
    sample_numbers<'a>(
        l: L, sequence: &'a Sequence, numbers: Numbers, samples: &'a [[u32; 4]]
    ) -> Vec<[f64; 5]> {
        let mut all = Vec::with_capacity(samples.len());
        for samples in samples.chunks(L::COUNT) {
            let [x, y, replicate, index] = columns_of(samples).map(|column| l.load_int(&column));
            let mut id = sequence.identity(l, x, y, replicate, index);
            let zero = l.real(0.0);
            let numbers = match numbers {
                Numbers::Camera => {
                    let sample = sequence.camera(l, id, true);
                    let ([u, v], [s, t]) = (sample.pixel, sample.lens);
                    [u, v, sample.wavelength, s, t]
                }
                Numbers::Pair(slot, bounce) => {
                    id.bounce = l.int(bounce);
                    let [u, v] = sequence.pair(l, id, slot);
                    [u, v, zero, zero, zero]
                }
                Numbers::Single(slot, bounce) => {
                    id.bounce = l.int(bounce);
                    [sequence.single(l, id, slot), zero, zero, zero, zero]
                }
            };
            let columns = numbers.map(|x| array(l, x));
            all.extend((0..samples.len()).map(|i| columns.map(|column| column[i].to_f64())));
        }
        all
    }

    /// The images of words, each with its seed.
    shuffled<'a>(l: L, shuffle: Shuffle, words: &'a [[u32; 2]]) -> Vec<u32> {
        let mut all = Vec::with_capacity(words.len());
        for words in words.chunks(L::COUNT) {
            let [x, seed] = columns_of(words).map(|column| l.load_int(&column));
            let image = match shuffle {
                Shuffle::Scramble => nested_scramble(l, x, seed),
                Shuffle::Permutation(count) => permute(l, x, count, seed),
            };
            all.extend(&int_array(l, image)[..words.len()]);
        }
        all
    }
}

/// Rows as columns, the places that are left over zero.
fn columns_of<const N: usize>(rows: &[[u32; N]]) -> [[u32; WIDEST]; N] {
    let mut columns = [[0; WIDEST]; N];
    for (i, row) in rows.iter().enumerate() {
        for (column, &number) in columns.iter_mut().zip(row) {
            column[i] = number;
        }
    }
    columns
}

/// A bijection of words that a seed chooses.
#[derive(Debug, Clone, Copy)]
pub enum Shuffle {
    /// Nested scrambling of all words.
    Scramble,
    /// A permutation of the words below a number.
    Permutation(u32),
}

columns! {
    /// The weights of two strategies with densities p and q.
    power_weights(l, [p, q]: 2) -> 2 {
        [power_weight(l, p, q), power_weight(l, q, p)]
    }

    /// Points of the disk (two numbers), of the hemisphere by cosine and of the sphere (three each),
    /// and the density of the second.
    warps(l, [u, v]: 2) -> 9 {
        let (x, y) = square_to_disk(l, u, v);
        let h = cosine_hemisphere(l, u, v);
        let s = uniform_sphere(l, u, v);
        [x, y, h.x, h.y, h.z, s.x, s.y, s.z, cosine_hemisphere_pdf(l, h.z)]
    }
}
