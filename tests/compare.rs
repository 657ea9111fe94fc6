//! `etalon compare` from outside, on pictures whose noise is known.

use std::path::Path;

use etalon::inside::compare::{LEVEL, flip, judge};
use etalon::inside::film::hash;
use etalon::inside::film::spectral::channel_name;
use etalon::inside::film::{exr, names};
use etalon::inside::stats::student;
use etalon::{Attribute, Channel, Estimate, Picture, Side, Values};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::Value;

use crate::support::{Finished, Folder, assert_says, words};
use crate::truth_file::{list, number};

/// Edge of the pictures, pixels.
const EDGE: usize = 32;
/// Independent parts of each pixel.
const REPLICATES: usize = 8;
/// Standard deviation of a part over the pixel's truth.
const NOISE: f64 = 0.1;

#[derive(Clone, Copy)]
struct Drawn {
    seed: u64,
    /// Factor on the truth of all pixels.
    factor: f64,
    /// Factor on the truth of the pixels of one block of 8×8.
    block: f64,
    /// Factor on the standard errors that are told.
    told: f64,
}

const HONEST: Drawn = Drawn {
    seed: 1,
    factor: 1.0,
    block: 1.0,
    told: 1.0,
};

impl Drawn {
    fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// R, G, B and a band with normal noise; standard errors, or variances as references have them.
    fn picture(self, variances: bool) -> Picture {
        let mut random = Pcg64Mcg::seed_from_u64(self.seed);
        let mut normal = || {
            let u: f64 = random.random::<f64>().max(1e-12);
            let v: f64 = random.random();
            (-2.0 * libm::log(u)).sqrt() * libm::cos(std::f64::consts::TAU * v)
        };
        let mut picture = Picture::new(EDGE, EDGE);
        let band = channel_name(450.0);
        for (index, name) in names::RGB.into_iter().chain([band.as_str()]).enumerate() {
            let (mut values, mut errors) = (Vec::new(), Vec::new());
            for pixel in 0..EDGE * EDGE {
                let (x, y) = (pixel % EDGE, pixel / EDGE);
                let inside = x < 8 && (8..16).contains(&y);
                let factor = self.factor * if inside { self.block } else { 1.0 };
                let truth = factor * (index + 1) as f64 * (1.0 + x as f64);
                let parts = [(); REPLICATES].map(|()| truth * (1.0 + NOISE * normal()));
                let mean = Estimate::mean(&parts);
                let error = mean.standard_error * self.told;
                values.push(mean.value as f32);
                errors.push((if variances { error * error } else { error }) as f32);
            }
            let layer = ["variance", names::STANDARD_ERROR][usize::from(!variances)];
            picture.channels.push(Channel::float(name, values));
            let name = names::in_layer(layer, name);
            picture.channels.push(Channel::float(name, errors));
        }
        let replicates = Attribute::Int(REPLICATES as i32);
        set(&mut picture, "replicates", replicates);
        picture
    }

    fn side(self) -> Side {
        Side::of_picture(Path::new("drawn"), self.picture(false)).unwrap()
    }
}

fn set(picture: &mut Picture, name: &str, value: Attribute) {
    picture.attributes.retain(|(other, _)| other != name);
    picture.attributes.push((name.to_owned(), value));
}

/// What the command says of two pictures in a folder with a scene file, with this exit code.
#[track_caller]
fn compare(a: &Picture, b: Option<&Picture>, more: &str, code: i32) -> (Finished, Folder) {
    let folder = Folder::new(SCENE);
    exr::write(&folder.path("a.exr"), a).unwrap();
    let mut command = "compare a.exr".to_owned();
    if let Some(b) = b {
        exr::write(&folder.path("b.exr"), b).unwrap();
        command += " b.exr";
    }
    let said = folder.run(&words(&(command + more)));
    assert_eq!(said.code, Some(code), "{said:?}");
    (said, folder)
}

const SCENE: &str = "[camera]\n# another text\n";

/// The exit code, and words of the answer or the message.
#[track_caller]
fn expect(a: &Picture, b: &Picture, code: i32, words: &[&str]) {
    let (said, _) = compare(a, Some(b), "", code);
    assert_says(&(said.out + &said.err), words);
}

#[test]
fn honest_pictures_are_consistent() {
    let b = HONEST.seed(2).picture(true);
    let (said, folder) = compare(&HONEST.picture(false), Some(&b), " --heatmap map.png", 0);
    let caught = "caught from a bias of";
    assert_says(&said.out, &["\nconsistent", caught, "relMSE", "heat map"]);
    assert!(folder.path("map.png").exists());
}

/// 2 % in the mean are eleven of its standard errors here, 5 % in one block are eight.
#[test]
fn a_bias_of_all_or_of_a_block_is_seen() {
    let b = HONEST.seed(2).picture(true);
    let [mut all, mut block] = [HONEST; 2];
    all.factor = 1.02;
    let words = ["NOT consistent", "the image mean is off by +"];
    expect(&all.picture(false), &b, 1, &words);
    block.block = 0.95;
    let words = ["the block of 8x8 pixels at 0,8 is off by"];
    expect(&block.picture(false), &b, 1, &words);
}

/// Error bars that are too small show in the distribution of the blocks, not in their means.
#[test]
fn dishonest_error_bars_are_seen() {
    let mut told = HONEST;
    told.told = 0.5;
    let judged = judge(&told.seed(3).side(), &told.seed(4).side(), LEVEL).unwrap();
    let mut rejected = judged.channels.iter().flat_map(|c| &c.rejected);
    assert!(rejected.any(|words| words.contains("distributed")));
}

/// Over many honest pairs the alarms are as frequent as the level says, and what is said to be
/// caught 39 times in 40 is.
#[test]
fn level_and_power_are_as_stated() {
    let (runs, level) = (200, 0.1);
    let judged = |a: Drawn, b: Drawn| judge(&a.side(), &b.side(), level).unwrap();
    let honest = |run: u64| judged(HONEST.seed(100 + 2 * run), HONEST.seed(101 + 2 * run));
    let alarms = (0..runs).filter(|run| !honest(*run).consistent).count() as f64;
    // 20 expected at most (tests of one picture are independent here), standard deviation 4.2.
    assert!((3.0..37.0).contains(&alarms), "{alarms}");
    let smallest = judged(HONEST, HONEST.seed(2)).channels[0].smallest_caught;
    let runs = 100;
    let mut biased = HONEST;
    biased.factor = 1.0 + smallest;
    let is_caught = |run: &u64| {
        let judged = judged(biased.seed(1000 + 2 * run), HONEST.seed(1001 + 2 * run));
        let mut rejected = judged.channels[0].rejected.iter();
        rejected.any(|words| words.contains("mean"))
    };
    let caught = (0..runs).filter(is_caught).count();
    assert!(caught >= 92, "{caught} of {runs}");
}

#[test]
fn a_number_can_be_the_truth() {
    // The mean of 1 + x over 32 columns is 16.5; of R only, so the others are taken out.
    let mut a = HONEST.picture(false);
    a.channels
        .retain(|c| c.name == "R" || c.name == "standard_error.R");
    for (arguments, code, words) in [
        (" --truth 16.5", 0, "consistent"),
        (" --truth 16.6", 1, "NOT consistent"),
        ("", 2, "B.exr"),
    ] {
        let (said, _) = compare(&a, None, arguments, code);
        assert_says(&(said.out + &said.err), &[words]);
    }
}

#[test]
fn a_band_that_is_black_in_both_pictures_is_said_to_be() {
    let dark = |seed: u64| {
        let mut picture = HONEST.seed(seed).picture(false);
        let of_blue = ["B", "standard_error.B"];
        let blue = picture.channels.iter_mut();
        for channel in blue.filter(|c| of_blue.contains(&c.name.as_str())) {
            channel.values = Values::F32(vec![0.0; EDGE * EDGE]);
        }
        picture
    };
    let (said, _) = compare(&dark(1), Some(&dark(2)), "", 0);
    let words = ["black in both pictures", "undefined", "consistent"];
    assert_says(&said.out, &words);
    assert!(!said.out.contains("NaN"), "{said:?}");
    assert_eq!(said.out.matches("black").count(), 1, "{said:?}");
    // Black in one picture only is a difference.
    let (said, _) = compare(&HONEST.picture(false), Some(&dark(2)), "", 1);
    assert_says(&said.out, &["B: the image mean is off", "NOT consistent"]);
    assert!(!said.out.contains("black"), "{said:?}");
}

#[test]
fn json_holds_everything() {
    let b = HONEST.seed(2).picture(true);
    let (said, _) = compare(&HONEST.picture(false), Some(&b), " --json", 0);
    let json: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(json["judgement"]["consistent"], true);
    let channels = list(&json["channels"]).iter();
    let names: Vec<&str> = channels.map(|c| c["channel"].as_str().unwrap()).collect();
    assert_eq!(names, ["R", "G", "B", channel_name(450.0).as_str()]);
    let metrics = &json["channels"][0]["metrics"];
    for name in words("mean_error relative_mean_error rmse relmse smape") {
        assert!(metrics[name]["value"].is_number(), "{name}");
        assert!(metrics[name]["standard_error"].is_number(), "{name}");
    }
    // Two pictures with a noise of 0.1/√8 each: their relative squared error is 2 · 0.01/8, and the
    // variance of the reference is half of it.
    let relmse = number(&metrics["relmse"]["value"]);
    let without = number(&metrics["relmse_without_reference_variance"]["value"]);
    assert!((relmse / 2.5e-3 - 1.0).abs() < 0.2, "{relmse}");
    assert!((without / 1.25e-3 - 1.0).abs() < 0.3, "{without}");
}

#[test]
fn what_cannot_be_compared_is_said() {
    let a = HONEST.picture(false);
    let b = HONEST.seed(2).picture(true);
    let refused = |b: &Picture, words: &[&str]| expect(&a, b, 2, words);
    // One channel of ones, but for a pixel.
    let ones = |edge: usize, name: &str| {
        let mut picture = Picture::new(edge, edge);
        picture.channels = vec![Channel::float(name, vec![1.0; edge * edge])];
        picture
    };
    refused(&ones(4, "R"), &["a.exr has 32x32 pixels and b.exr has 4x4"]);
    let none = "b.exr has neither R, G, B nor spectral channels";
    refused(&ones(EDGE, "depth.Z"), &[none]);
    let bands = ones(EDGE, &channel_name(600.0));
    refused(&bands, &["share no channel", "S0.600,000000nm"]);

    let mut broken = b.clone();
    let mut values = vec![1.0f32; EDGE * EDGE];
    values[3 * EDGE + 5] = f32::NAN;
    broken.channels[0] = Channel::float("R", values);
    let words = ["1 values that are not finite in channel R", "5,3"];
    refused(&broken, &words);

    let mut bare = b.clone();
    bare.channels.retain(|c| !c.name.starts_with("variance."));
    refused(&bare, &["no verdict", "b.exr says no variance", "relMSE"]);

    let mut single = b.clone();
    set(&mut single, "replicates", Attribute::Int(1));
    refused(&single, &["no verdict", "at least 2"]);

    let mut negative = b;
    negative.channels[1] = Channel::float("variance.R", vec![-1.0; EDGE * EDGE]);
    refused(&negative, &["is negative or not finite in channel R"]);
}

#[test]
fn stale_references_and_other_scenes_are_told() {
    let mut a = HONEST.picture(false);
    let mut b = HONEST.seed(2).picture(true);
    let text = |text: &str| Attribute::Text(text.to_owned());
    let of = |picture: &mut Picture, hash: &str| {
        set(picture, "sceneFile", text("scene.toml"));
        set(picture, "sceneHash", text(hash));
    };
    of(&mut b, &hash("[camera]\n"));
    let stale = "b.exr is stale";
    expect(&a, &b, 2, &[stale, "scene.toml has changed since"]);
    of(&mut a, &hash(SCENE));
    expect(&a, &b, 2, &["not of the same scene file", stale]);
    of(&mut b, &hash(SCENE));
    expect(&a, &b, 0, &["consistent"]);
    set(&mut b, "panel", text("b"));
    let panels = "a.exr is of panel none and b.exr of panel b";
    expect(&a, &b, 2, &[panels]);
}

/// Values of the authors' own program, flip-evaluator 1.7 (`evaluate(…, "HDR", applyMagma=False)`), on
/// the same picture; it computes in single precision.
#[test]
fn flip_is_that_of_its_authors() {
    let (width, height) = (40, 30);
    let (mut reference, mut test) = (Vec::new(), Vec::new());
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let lamp = if x > 20 && y < 12 { 4.0 } else { 0.0 };
        let pixel = [
            0.8 * libm::exp(libm::sin(0.2 * x as f64)),
            0.5 * libm::exp(libm::cos(0.3 * y as f64)),
            0.3 + 0.02 * x as f64 + lamp,
        ];
        let factor = 1.0 + 0.06 * (((7 * x + 13 * y) % 5) as f64 - 2.0);
        reference.push(pixel);
        let [r, g, b] = pixel;
        test.push([r * factor, g * factor, b * (2.0 - factor)]);
    }
    let map = flip(&reference, &test, width);
    let mean = map.iter().sum::<f64>() / map.len() as f64;
    for (own, authors) in [
        (mean, 0.024_166_22),
        (map[0], 0.109_879_8),
        (map[10 * width + 25], 0.032_569_5),
        (map[29 * width + 39], 0.127_311_7),
    ] {
        assert!((own / authors - 1.0).abs() < 3e-4, "{own} and {authors}");
    }
    let same = flip(&reference, &reference, width);
    assert!(same.iter().all(|difference| *difference == 0.0));
}

/// What `compare` calls a p-value is one.
#[test]
fn p_values_are_students() {
    let judged = judge(&HONEST.side(), &HONEST.seed(2).side(), LEVEL).unwrap();
    for channel in &judged.channels {
        let score = channel.relative_bias / channel.standard_error;
        let (found, p) = (channel.p_value, student::two_sided(score, channel.freedom));
        // Rounding of single precision is allowed for, a millionth beside an error of 0.15 %.
        assert!((found - p).abs() < 0.01, "{found} and {p}");
    }
}
