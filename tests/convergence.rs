//! Errors fall with the number of samples as theory says, and the variance that pictures report is
//! the variance that they have.
//!
//! The whole module raises a false alarm with probability below [`LEVEL`]; seeds are fixed.

use std::path::Path;

use crate::agreement::case::Case;
use crate::sampling::KINDS;
use etalon::inside::scene::{SamplerKind, load};
use etalon::inside::stats::family::sidak;
use etalon::{BinGrid, Estimate, Overrides, Side};
use rayon::prelude::*;

/// Probability of any false alarm here.
const LEVEL: f64 = 1e-4;
/// More than the number of tests here.
const TESTS: usize = 60;
/// Pictures with seeds of their own.
const PICTURES: u64 = 40;

fn level() -> f64 {
    sidak(LEVEL, TESTS)
}

/// Diffuse walls under a lamp, small, with two bands.
fn case(sampler: SamplerKind) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell_box.toml");
    let overrides = Overrides {
        set: vec![("image.size".to_owned(), "[12, 12]".to_owned())],
        ..Overrides::default()
    };
    let mut scene = load(&path, &overrides).unwrap();
    scene.image.sampler = sampler;
    let bands = BinGrid::new(500.0, 600.0, 100.0).unwrap();
    Case::new("cornell box", scene, Some(bands)).unwrap()
}

fn pictures(case: &Case, spp: u32) -> Vec<Side> {
    (0..PICTURES)
        .map(|seed| case.render(spp, u64::from(spp) << 20 | seed).unwrap())
        .collect()
}

/// For each pixel of a channel: variance over the pictures, and the mean of the reported ones.
fn variances(pictures: &[Side], channel: usize) -> Vec<[f64; 2]> {
    let pixels = pictures[0].channels[channel].values.len();
    let of_pixel = |pixel: usize| {
        let channels = pictures.iter().map(|picture| &picture.channels[channel]);
        let values: Vec<f64> = channels.clone().map(|c| c.values[pixel]).collect();
        let error = Estimate::mean(&values).standard_error;
        let reported = channels.map(|c| c.variances.as_ref().unwrap()[pixel]);
        let reported: f64 = reported.sum();
        [error * error * PICTURES as f64, reported / PICTURES as f64]
    };
    (0..pixels).map(of_pixel).collect()
}

/// Reported over actual variance of a channel, with `factor` on what is reported.
fn honesty(pictures: &[Side], channel: usize, factor: f64) -> f64 {
    // Over the size of the pixel's variance, so that no few pixels rule.
    let terms: Vec<f64> = variances(pictures, channel)
        .iter()
        .map(|[actual, reported]| (factor * reported - actual) / (reported + actual))
        .filter(|term| term.is_finite())
        .collect();
    assert!(terms.len() > 50);
    Estimate::mean(&terms).p_value(0.0, 0.0)
}

/// In each channel and band, with each sampler. A quarter more or less would be seen.
#[test]
fn the_reported_variance_is_the_variance() {
    for sampler in KINDS {
        let case = case(sampler);
        let pictures = pictures(&case, 64);
        for channel in 0..pictures[0].channels.len() {
            let name = &pictures[0].channels[channel].name;
            let p = honesty(&pictures, channel, 1.0);
            assert!(p > level(), "{sampler:?}, {name}: p = {p:.1e}");
            for factor in [0.75, 1.33] {
                let p = honesty(&pictures, channel, factor);
                assert!(p < level(), "{sampler:?}, {name}, {factor}: p = {p:.1e}");
            }
        }
    }
}

/// log₂ of the ratio of variances of a picture's pixels from N to 16 N samples, over log₂ 16: the
/// slope of the squared error. Its standard error from the spread over pixels.
fn slope(few: &[Side], many: &[Side]) -> Estimate {
    let pixels = variances(few, 1).into_iter().zip(variances(many, 1));
    let slopes = pixels.map(|([few, _], [many, _])| libm::log2(many / few) / 4.0);
    Estimate::mean(&slopes.filter(|slope| slope.is_finite()).collect::<Vec<_>>())
}

/// −1 for independent samples; steeper for the others, whose points fill space evenly. A picture
/// whose error does not fall at all, or falls by a fifth less than it should, is seen.
#[test]
fn squared_errors_fall_as_they_should() {
    let measured = KINDS.into_par_iter().map(|sampler| {
        let case = case(sampler);
        let (few, many) = (pictures(&case, 16), pictures(&case, 256));
        (sampler, slope(&few, &many), slope(&few, &few))
    });
    let measured: Vec<(SamplerKind, Estimate, Estimate)> = measured.collect();
    for (sampler, slope, none) in measured {
        println!("{sampler:?}: slope {slope}");
        match sampler {
            SamplerKind::Independent => {
                let p = slope.p_value(-1.0, 0.0);
                assert!(p > level(), "slope {} (p = {p:.1e})", slope.value);
                assert!(slope.p_value(-0.8, 0.0) < level(), "{slope:?}");
            }
            _ => assert!(
                slope.value < -1.0 && slope.p_value(-1.0, 0.0) < level(),
                "{sampler:?}: slope {slope:?} is not steeper than −1"
            ),
        }
        assert_eq!(none.value, 0.0);
    }
}
