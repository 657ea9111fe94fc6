//! Power laws: intervals that hold as often as they say, wrong laws that are caught, and the laws
//! of the samplers.

use etalon::inside::sample::Slot;
use etalon::inside::scene::SamplerKind;
use etalon::inside::stats::slope::{Replicates, Slope};
use etalon::{Plan, Scene};
use etalon_doors::samplers::Numbers;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::lanes_support::Precision;
use crate::sampling::{pixels_of, sequence};
use crate::support::rendered;

/// Values about a power law: `spread` is their relative standard deviation.
fn planted(rng: &mut Pcg64Mcg, slope: f64, spread: f64, replicates: usize) -> Vec<Replicates> {
    // A sum of twelve uniform numbers is as good as normal here (variance 1).
    let mut normal = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
    let mut point = |k: u32| {
        let x = f64::from(1u32 << k);
        let value = 3.0 * x.powf(slope);
        let values = (0..replicates).map(|_| value * (1.0 + spread * normal()));
        let values = values.collect();
        Replicates { x, values }
    };
    (0..7).map(&mut point).collect()
}

#[test]
fn intervals_of_slopes_hold_as_often_as_they_say() {
    const TRIALS: u32 = 2000;
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut held = 0;
    for _ in 0..TRIALS {
        let fit = Slope::fit(&planted(&mut rng, -1.0, 0.1, 16)).unwrap();
        let [low, high] = fit.interval();
        held += u32::from(low <= -1.0 && -1.0 <= high);
    }
    // 95 % with a binomial standard error of 0.5 % (2000 trials); weights that are estimated from
    // 16 values have 15 degrees of freedom, which lengthens the true spread by up to 1/15 and may
    // cost 1.5 %; beyond four standard errors of that it is wrong.
    let share = f64::from(held) / f64::from(TRIALS);
    assert!((0.915..=0.97).contains(&share), "{share}");
}

#[test]
fn a_wrong_slope_is_caught() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let fit = Slope::fit(&planted(&mut rng, -0.9, 0.1, 16)).unwrap();
    let [low, high] = fit.interval();
    assert!(low <= -0.9 && -0.9 <= high && fit.straight, "{fit:?}");
    // A mean square that falls with −0.9 is no independent sampling.
    assert!(high < -0.8 && low > -1.0, "{fit:?}");
    let root = fit.of_root(2.0);
    assert!((root.value + 0.45).abs() < 0.05 && root.interval()[0] > -0.5);
}

#[test]
fn a_curve_that_bends_is_no_line() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut points = planted(&mut rng, -1.0, 0.02, 16);
    assert!(Slope::fit(&points).unwrap().straight);
    // A bias that does not fall.
    for point in &mut points {
        for value in &mut point.values {
            *value += 0.1;
        }
    }
    let bent = Slope::fit(&points).unwrap();
    assert!(!bent.straight);
    assert!(bent.interval()[1] - bent.interval()[0] > 0.1, "{bent:?}");
}

#[test]
fn what_has_no_law_has_no_slope() {
    let point = |x: f64, values: &[f64]| Replicates {
        x,
        values: values.to_vec(),
    };
    assert_eq!(Slope::fit(&[]), None);
    assert_eq!(Slope::fit(&[point(1.0, &[1.0, 1.1])]), None);
    // Means that are not above zero, single replicates, no spread.
    let dead = [
        point(1.0, &[-1.0, 0.5]),
        point(2.0, &[1.0]),
        point(4.0, &[1.0, 1.0]),
        point(8.0, &[0.9, 1.1]),
    ];
    assert_eq!(Slope::fit(&dead), None);
}

/// Root-mean-square slope of a sampler's error in the mean of f over the square, the truth given,
/// for numbers of samples that are squares and powers of two.
fn slope_of(kind: SamplerKind, f: impl Fn(u32, f64, f64) -> f64, truth: f64) -> Slope {
    const PIXELS: u32 = 64;
    const SETS: u64 = 16;
    let square_error = |n: u32, seed: u64| {
        let what = Numbers::Pair(Slot::Light, 0);
        let drawn = pixels_of(Precision::Double, sequence(kind, seed, n), what, PIXELS, n);
        let square = |(pixel, points): (u32, &[[f64; 5]])| {
            let sum: f64 = points.iter().map(|p| f(pixel, p[0], p[1])).sum();
            (sum / f64::from(n) - truth).powi(2)
        };
        let squares = (0..PIXELS).zip(drawn.chunks(n as usize)).map(square);
        squares.sum::<f64>() / f64::from(PIXELS)
    };
    root_slope(SETS, |n, seed| square_error(n, 100 + seed))
}

/// The slope of the root of squares over numbers of samples, from so many replicates.
fn root_slope(replicates: u64, square: impl Fn(u32, u64) -> f64) -> Slope {
    let point = |n: u32| Replicates {
        x: f64::from(n),
        values: (0..replicates).map(|k| square(n, k)).collect(),
    };
    Slope::fit(&[16, 64, 256, 1024].map(point))
        .unwrap()
        .of_root(2.0)
}

/// Whether a slope is within its own interval of what theory says, give or take `bend`.
fn agrees(slope: Slope, theory: f64, bend: f64) {
    let [low, high] = slope.interval();
    let within = (low - bend..=high + bend).contains(&theory);
    assert!(within, "{theory}: {slope:?}");
    // The interval is narrow enough to tell −1/2, −3/4, −1 and −3/2 apart.
    assert!(high - low < 0.12, "{slope:?}");
}

#[test]
fn samplers_have_the_slopes_of_theory_where_the_integrand_is_smooth() {
    // The sum of both coordinates has an exact law with each: N independent points have the
    // variance 1/6N, jittered ones 1/6N² (each alone in its square of area 1/N), scrambled nets,
    // whose coordinates are stratified N times each, 1/6N³.
    let sum = |_: u32, u: f64, v: f64| u + v;
    agrees(slope_of(SamplerKind::Independent, sum, 1.0), -0.5, 0.0);
    agrees(slope_of(SamplerKind::Stratified, sum, 1.0), -1.0, 0.0);
    agrees(slope_of(SamplerKind::Sobol, sum, 1.0), -1.5, 0.0);
}

#[test]
fn samplers_fall_back_at_edges() {
    // A straight edge through the middle, turned another way in each pixel: of N squares about √N
    // are cut, each by chance. Squares at the border are cut in part only, a number of them that
    // does not grow: about one of the four that are cut at N = 16 and of the 32 at N = 1024, which
    // bends the law by ln(1 + 1/8)/ln 64 = 0.03.
    let edge = |pixel: u32, u: f64, v: f64| {
        let angle = 0.1 + f64::from(pixel) * 0.6180339887;
        let side = (u - 0.5) * angle.cos() + (v - 0.5) * angle.sin();
        f64::from(u8::from(side < 0.0))
    };
    // A line through the centre halves the square.
    agrees(slope_of(SamplerKind::Independent, edge, 0.5), -0.5, 0.0);
    agrees(slope_of(SamplerKind::Stratified, edge, 0.5), -0.75, 0.03);
    // Boxes of a net are of all shapes, and those that an edge cuts are no more than of squares.
    agrees(slope_of(SamplerKind::Sobol, edge, 0.5), -0.75, 0.06);
}

/// Pictures of 8 × 8 pixels, one replicate each, of a scene with a camera that looks down the z axis.
fn picture(objects: &str, kind: SamplerKind, spp: u32, seed: u64) -> Vec<f64> {
    let text = format!(
        "camera = {{ from = [0, 0, 4], to = [0, 0, 0], fov = 30 }}\n\
         image = {{ size = [8, 8], spp = {spp}, seed = {seed}, replicates = 1, sampler = \"{}\" }}\n\
         {objects}",
        kind.name()
    );
    let scene = Scene::parse(&text).unwrap();
    let plan = Plan::new(&scene, false).unwrap();
    rendered(&scene, &plan)
        .xyz()
        .iter()
        .map(|pixel| pixel.mean[1])
        .collect()
}

/// Slope of the root-mean-square error of luminance, from pairs of pictures: half the square of
/// their difference has the mean of the squared error, whatever the truth is.
fn slope_on(objects: &str, kind: SamplerKind) -> Slope {
    const PAIRS: u64 = 24;
    root_slope(PAIRS, |spp, pair| {
        let [a, b] = [2 * pair, 2 * pair + 1].map(|seed| picture(objects, kind, spp, seed));
        let squares = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b) / 2.0);
        squares.sum::<f64>() / a.len() as f64
    })
}

/// A wall close by under a point light beside the camera.
const SMOOTH: &str = r#"
materials.wall = { diffuse = 0.8 }
object = [{ shape = "plane", material = "wall" }]
[[light]]
point = [0.5, 0.5, 1]
intensity = 1
"#;

/// A round lamp in the dark.
const EDGE: &str = r#"
materials.lamp = { emit = 1 }
object = [{ shape = { disk = { radius = 0.7 } }, material = "lamp" }]
"#;

#[test]
fn samplers_have_these_slopes_on_scenes_too() {
    // All that varies is smooth: the place in the pixel, and the wavelengths' part in the luminance. Jittered
    // samples have the law of the sum above; at 1 024 the nets' mean squares are a
    // millionth of those at 16, and interactions of the two begin to show.
    agrees(slope_on(SMOOTH, SamplerKind::Independent), -0.5, 0.0);
    agrees(slope_on(SMOOTH, SamplerKind::Stratified), -1.0, 0.0);
    agrees(slope_on(SMOOTH, SamplerKind::Sobol), -1.5, 0.0);
    // Pixels along an outline, bent as above.
    agrees(slope_on(EDGE, SamplerKind::Independent), -0.5, 0.0);
    agrees(slope_on(EDGE, SamplerKind::Stratified), -0.75, 0.03);
    agrees(slope_on(EDGE, SamplerKind::Sobol), -0.75, 0.06);
}
