//! `etalon render` and `etalon info` from outside: pictures, their bits, and what is refused.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed, and the panic says where"
)]

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use etalon::inside::film::{exr, names};
use etalon::{Attribute, Picture, Values};
use tempfile::TempDir;

/// A checkered floor, a glass ball, a mirror, a lamp and a dim sky: every kind of path.
const SCENE: &str = r#"
environment = 0.05
[camera]
from = [0, 1, 5]
to = [0, 0.5, 0]
fov = 40
[image]
size = [21, 17]
spp = 24
max_depth = 6
[materials]
floor = { checkerboard = [0.2, 0.7], cell = 1 }
glass = { glass = "N-SF11" }
silver = { mirror = "Ag" }
lamp = { emit = 3 }
[[object]]
name = "floor"
shape = { rectangle = { size = [20, 20] } }
material = "floor"
transform = [{ rotate_x = -90 }]
[[object]]
name = "ball"
shape = { sphere = { radius = 0.8 } }
material = "glass"
transform = [{ translate = [-0.9, 0.8, 0] }]
[[object]]
name = "block"
shape = { cube = { side = 1 } }
material = "silver"
transform = [{ rotate_y = 30 }, { translate = [1, 0.5, 0] }]
[[object]]
name = "lamp"
shape = { disk = { radius = 0.5 } }
material = "lamp"
transform = [{ rotate_x = 90 }, { translate = [0, 4, 1] }]
[[panel]]
name = "a"
spp = 2
[[panel]]
name = "b/c"
size = [5, 4]
spp = 1
"#;

/// A directory with a scene in it.
struct Studio {
    directory: TempDir,
}

impl Studio {
    fn new(scene: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("scene.toml"), scene).unwrap();
        Self { directory }
    }

    fn path(&self) -> &Path {
        self.directory.path()
    }

    fn command(&self, command: &str, arguments: &[&str]) -> Command {
        let mut process = Command::new(env!("CARGO_BIN_EXE_etalon"));
        process
            .current_dir(self.path())
            .args([command, "scene.toml"])
            .args(arguments)
            .stdin(Stdio::null());
        process
    }

    fn run(&self, command: &str, arguments: &[&str]) -> Output {
        self.command(command, arguments).output().unwrap()
    }

    fn read(&self, file: &str) -> Picture {
        exr::read(&self.path().join(file)).unwrap()
    }

    /// The picture that these arguments give, and what was said about it.
    fn render(&self, arguments: &[&str]) -> (Picture, String) {
        let mut all = vec!["-o", "out.exr"];
        all.extend(arguments);
        let output = self.run("render", &all);
        let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {complaint}");
        let said = String::from_utf8(output.stdout).unwrap();
        (self.read("out.exr"), said)
    }

    /// What is said when this is refused.
    fn refused(&self, arguments: &[&str]) -> String {
        let before = self.files();
        let output = self.run("render", arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert_eq!(output.stdout, b"", "{arguments:?}");
        assert_eq!(self.files(), before, "{arguments:?}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.starts_with("error: "), "{message}");
        message
    }

    fn files(&self) -> BTreeSet<String> {
        std::fs::read_dir(self.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }
}

/// Every channel's name and bits.
fn bits(picture: &Picture) -> Vec<(String, Vec<u32>)> {
    let bits = |values: &Values| match values {
        Values::F32(values) => values.iter().map(|v| v.to_bits()).collect(),
        Values::U32(values) => values.clone(),
    };
    let channels = picture.channels.iter();
    channels
        .map(|c| (c.name.clone(), bits(&c.values)))
        .collect()
}

fn text<'a>(picture: &'a Picture, name: &str) -> &'a str {
    match picture.attribute(name) {
        Some(Attribute::Text(text)) => text,
        other => panic!("{name} is {other:?}"),
    }
}

/// The count that "… after 123 spp in …" names.
fn reached(said: &str) -> &str {
    let words: Vec<&str> = said.split_whitespace().collect();
    let at = words.iter().position(|word| *word == "spp").unwrap();
    words[at - 1]
}

#[test]
fn a_picture_says_where_it_comes_from() {
    let studio = Studio::new(SCENE);
    let (picture, said) = studio.render(&["--set", "environment=0.1"]);
    assert_eq!((picture.width, picture.height), (21, 17));
    let channels: Vec<&str> = picture.channels.iter().map(|c| c.name.as_str()).collect();
    let expected = [
        "B",
        "G",
        "R",
        "samples",
        "standard_error.B",
        "standard_error.G",
        "standard_error.R",
    ];
    assert_eq!(channels, expected);
    assert_eq!(picture.attribute("spp"), Some(&Attribute::Int(24)));
    assert_eq!(picture.attribute("replicates"), Some(&Attribute::Int(2)));
    assert_eq!(picture.attribute("maxDepth"), Some(&Attribute::Int(6)));
    assert_eq!(text(&picture, "sceneText"), SCENE);
    assert_eq!(text(&picture, "settings"), "environment=0.1");
    assert_eq!(text(&picture, "sampler"), "sobol");
    assert!(text(&picture, "plan").contains("all but one end where it is refracted by ball"));
    assert!(text(&picture, "rungs").contains("decided in lanes of"));
    for words in [
        "24 spp in ",
        "samples/s",
        " ± ",
        "cut off by max_depth",
        "0 NaN",
    ] {
        assert!(said.contains(words), "{said}");
    }
    assert!(studio.files().contains("out.png"));
}

#[test]
fn a_single_replicate_has_no_standard_error() {
    let studio = Studio::new(SCENE);
    let (picture, said) = studio.render(&["--spp", "1"]);
    assert!(picture.channel("standard_error.R").is_none());
    assert!(picture.attribute("standardError").is_none());
    assert!(said.contains("standard error unknown with 1 replicate"));
}

#[test]
fn bits_are_the_same_on_any_threads_and_instructions() {
    let studio = Studio::new(SCENE);
    let layers = "depth,normal,object,material,spectral:400-700:50";
    let reference = bits(&studio.render(&["--layers", layers]).0);
    let again = bits(&studio.render(&["--layers", layers]).0);
    assert_eq!(again, reference, "run twice");
    for threads in ["1", "2", "3"] {
        let picture = studio.render(&["--threads", threads, "--layers", layers]).0;
        assert_eq!(bits(&picture), reference, "{threads} threads");
    }
    let mut others = 0;
    for instructions in ["avx512", "avx2", "sse2"] {
        let arguments = ["--instructions", instructions, "--layers", layers];
        let mut all = vec!["-o", "other.exr"];
        all.extend(arguments);
        let output = studio.run("render", &all);
        if output.status.code() == Some(2) {
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(message.contains("this machine has no"), "{message}");
            continue;
        }
        others += 1;
        let picture = studio.read("other.exr");
        assert_eq!(text(&picture, "instructions"), instructions);
        assert_eq!(bits(&picture), reference, "{instructions}");
    }
    assert!(others > 0 || !cfg!(target_arch = "x86_64"));
    let other = bits(&studio.render(&["--seed", "1", "--layers", layers]).0);
    assert_ne!(other, reference, "another seed");
}

#[test]
fn a_time_limit_gives_the_bits_of_the_count_it_reached() {
    let studio = Studio::new(SCENE);
    for sampler in ["sobol", "independent", "center"] {
        // Long enough for several passes, and for replicates to grow.
        let limited = studio.render(&["--sampler", sampler, "--time", "0.2"]);
        let count = reached(&limited.1);
        assert!(count.parse::<u32>().unwrap() > 24, "{}", limited.1);
        let counted = studio.render(&["--sampler", sampler, "--spp", count]);
        assert_eq!(bits(&limited.0), bits(&counted.0), "{sampler} {count}");
    }
    let (_, said) = studio.render(&["--time", "100", "--spp", "5"]);
    assert_eq!(
        reached(&said),
        "5",
        "--spp is the most where both are given"
    );
}

#[test]
fn strata_need_a_planned_count() {
    let studio = Studio::new(SCENE);
    let strata = ["--sampler", "stratified", "--time", "0.05"];
    let message = studio.refused(&strata);
    assert!(message.contains("--time needs --spp"), "{message}");
    let (picture, said) = studio.render(&[strata.as_slice(), &["--spp", "1000000"]].concat());
    assert!(said.contains(" spp (of strata for 1000000) in "), "{said}");
    assert_eq!(text(&picture, "sppPlanned"), "1000000");
}

#[test]
fn a_crop_is_a_part_of_the_picture() {
    let studio = Studio::new(SCENE);
    let layers = [
        "--layers",
        "depth,normal,object,material,spectral:450-650:100",
    ];
    let whole = studio.render(&layers).0;
    let (x0, y0, x1, y1) = (3, 2, 20, 17);
    let crop = studio
        .render(&[layers.as_slice(), &["--crop", "3,2,20,17"]].concat())
        .0;
    assert_eq!((crop.width, crop.height), (x1 - x0, y1 - y0));
    assert_eq!(text(&crop, "crop"), "3,2,20,17 of 21x17");
    for ((name, part), (_, all)) in bits(&crop).iter().zip(bits(&whole)) {
        let rows = (y0..y1).flat_map(|y| all[y * 21 + x0..y * 21 + x1].to_vec());
        assert_eq!(*part, rows.collect::<Vec<_>>(), "{name}");
    }
}

#[test]
fn layers_show_what_the_pixels_centre_sees() {
    let studio = Studio::new(
        "[camera]\nfrom = [1, 2, 8]\nto = [1, 2, 3]\nfov = 40\n[image]\nsize = [5, 5]\nspp = 1\n\
         [materials]\nunused = { diffuse = 0 }\nwhite = { diffuse = 0.5 }\n\
         [[object]]\nshape = { sphere = { radius = 0.25 } }\nmaterial = \"white\"\n\
         transform = [{ translate = [1, 2, 3] }]\n",
    );
    let (picture, _) = studio.render(&["--layers", "depth,normal,object,material"]);
    let at = |channel: &str, pixel: usize| picture.floats(channel).unwrap()[pixel];
    let identity = |channel: &str, pixel: usize| match &picture.channel(channel).unwrap().values {
        Values::U32(values) => values[pixel],
        Values::F32(_) => panic!("{channel} is no identity"),
    };
    let (centre, corner) = (12, 0);
    assert_eq!(at(names::DEPTH, centre), 4.75);
    let normal = ["N.X", "N.Y", "N.Z"].map(|channel| at(channel, centre));
    assert_eq!(normal, [0.0, 0.0, 1.0]);
    assert_eq!(identity(names::OBJECT_ID, centre), 0);
    assert_eq!(identity(names::MATERIAL_ID, centre), 1);
    assert_eq!(at(names::DEPTH, corner), f32::INFINITY);
    assert_eq!(at("N.Z", corner), 0.0);
    assert_eq!(identity(names::OBJECT_ID, corner), names::NOTHING);
    assert_eq!(identity(names::MATERIAL_ID, corner), names::NOTHING);
}

#[test]
fn a_flat_environment_is_1_in_every_bin() {
    let studio = Studio::new(
        "environment = 1\n[camera]\nfrom = [0, 0, 1]\nto = [0, 0, 0]\nfov = 40\n\
         [image]\nsize = [16, 16]\nspp = 256\n",
    );
    for wavelengths in ["4", "8"] {
        let arguments = [
            "--wavelengths",
            wavelengths,
            "--layers",
            "spectral:365-825:10",
        ];
        let (picture, _) = studio.render(&arguments);
        let bins = picture
            .channels
            .iter()
            .filter(|c| c.name.starts_with("S0."));
        let mut count = 0;
        for bin in bins {
            count += 1;
            let Values::F32(values) = &bin.values else {
                panic!("{} has no floats", bin.name);
            };
            let n = values.len() as f64;
            let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
            let squares = values.iter().map(|&v| (f64::from(v) - mean).powi(2));
            let error = (squares.sum::<f64>() / (n * (n - 1.0))).sqrt();
            // 94 means at five standard errors: wrong once in 2 × 10⁴ seeds, and this is one.
            assert!(
                (mean - 1.0).abs() < 5.0 * error,
                "{} {mean} ± {error}",
                bin.name
            );
            // A bin is C intervals of the hero's variate, each with two edges in strata of K
            // replicates, and so at most 2 C K/4 variance of the count; at 825 nm 2.4e-4 nm⁻¹ of
            // the density makes 0.6 C counts of 256: 1.7/√C a pixel, and 256 pixels.
            assert!(error < 0.06, "{} ± {error}", bin.name);
        }
        assert_eq!(count, 47);
    }
    let message = studio.refused(&["--layers", "spectral:300-700:10"]);
    assert!(message.contains("the bin at 300 nm"), "{message}");
}

#[test]
fn files_are_named_after_scene_and_panel() {
    let studio = Studio::new(SCENE);
    assert_eq!(studio.run("render", &["--spp", "1"]).status.code(), Some(0));
    let all = studio.run("render", &["--panel", "all"]);
    assert_eq!(all.status.code(), Some(0));
    assert_eq!(String::from_utf8(all.stdout).unwrap().lines().count(), 2);
    let named = ["--panel", "a", "-o", "x.y.exr", "--quiet"];
    assert_eq!(studio.run("render", &named).status.code(), Some(0));
    let each = ["--panel", "all", "-o", "x.y.exr"];
    assert_eq!(studio.run("render", &each).status.code(), Some(0));
    let stems = ["scene", "scene-a", "scene-b_c", "x.y", "x.y-a", "x.y-b_c"];
    let mut expected: BTreeSet<String> = ["scene.toml".to_owned()].into();
    for stem in stems {
        expected.extend(["exr", "png"].map(|extension| format!("{stem}.{extension}")));
    }
    assert_eq!(studio.files(), expected);
    let small = studio.read("scene-b_c.exr");
    assert_eq!((small.width, small.height), (5, 4));
    assert_eq!(text(&small, "panel"), "b/c");
}

#[test]
fn what_cannot_be_done_is_refused_before_it_is_begun() {
    let studio = Studio::new(SCENE);
    let long = ["--spp", "16777216"];
    let refused = |arguments: &[&str]| studio.refused(&[arguments, long.as_slice()].concat());
    let message = refused(&["-o", "missing/out.exr"]);
    assert!(message.contains("missing"), "{message}");
    std::fs::create_dir(studio.path().join("here.exr")).unwrap();
    assert!(refused(&["-o", "here.exr"]).contains("it is a directory"));
    assert!(refused(&["-o", "out.png"]).contains("it is OpenEXR"));
    assert!(refused(&["-o", "./scene.toml"]).contains("that is the scene file"));
    assert!(refused(&["--crop", "0,0,22,17"]).contains("not inside the picture of 21x17"));
    std::fs::create_dir(studio.path().join("seen.png")).unwrap();
    assert!(refused(&["-o", "seen.exr"]).contains("seen.png: it is a directory"));
    let memory = ["--size", "16384x16384", "--layers", "spectral:400-800:0.1"];
    assert!(refused(&memory).contains("MiB of memory"));
    let plain = SCENE.split("[[panel]]").next().unwrap();
    let message = Studio::new(plain).refused(&["--panel", "all"]);
    assert!(message.contains("has no panels"), "{message}");
}

#[test]
fn info_explains_the_plan() {
    let studio = Studio::new(SCENE);
    let output = studio.run("info", &["--panel", "b/c"]);
    assert_eq!(output.status.code(), Some(0));
    let said = String::from_utf8(output.stdout).unwrap();
    for words in [
        "panel b/c: 5 × 4 pixels, 1 camera paths each",
        "1 sphere (dispersive glass)",
        "camera: no lens",
        "sampled by area: lamp (100 %)",
        "only scattered rays find: the environment",
        "of a pixel's width there (allowed 0.01)",
        "a list of 4 objects",
        "at most 6 segments",
    ] {
        assert!(said.contains(words), "{words} is not in:\n{said}");
    }
    let branches = |said: &str, start: &str| {
        let line = said.lines().find(|line| line.starts_with(start)).unwrap();
        line.split_once(": ").unwrap().1.to_owned()
    };
    let kept = branches(&said, "in the loop");
    let left_out = branches(&said, "left out of the loop");
    assert!(
        kept.contains("dispersion") && left_out.contains("lens"),
        "{said}"
    );
    // Nothing is left out of the full plan.
    let full = studio.run("info", &["--panel", "b/c", "--plan", "full"]);
    let full = String::from_utf8(full.stdout).unwrap();
    assert_eq!(
        branches(&full, "left out of the loop"),
        "nothing, as asked for"
    );
    let all = branches(&full, "in the loop");
    let branch = |name: &str| all.split(", ").any(|other| other == name);
    assert!(
        kept.split(", ").chain(left_out.split(", ")).all(branch),
        "{full}"
    );
}

/// Ctrl-C, as a terminal sends it.
#[cfg(target_os = "linux")]
mod interrupts {
    use std::process::Child;
    use std::time::Duration;

    use super::*;

    /// Starts a render that would take hours, and waits until it listens to signals.
    fn started(studio: &Studio, arguments: &[&str]) -> Child {
        let child = studio
            .command("render", arguments)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        while !listens(child.id()) {
            std::thread::sleep(Duration::from_millis(1));
        }
        child
    }

    /// Whether a process has a handler of SIGINT, signal 2 and so bit 1.
    fn listens(id: u32) -> bool {
        let text = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap();
        let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        u64::from_str_radix(caught.unwrap().trim(), 16).unwrap() & 2 != 0
    }

    fn interrupt(child: &Child) {
        let id = child.id().to_string();
        let sent = Command::new("kill").args(["-INT", &id]).status();
        assert!(sent.unwrap().success());
    }

    #[test]
    fn the_first_keeps_what_there_is() {
        let studio = Studio::new(SCENE);
        let child = started(&studio, &["--spp", "16777216"]);
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains("interrupted after "), "{said}");
        let kept = studio.read("scene.exr");
        let counted = studio.render(&["--spp", reached(&said)]).0;
        assert_eq!(bits(&kept), bits(&counted));
    }

    #[test]
    fn the_second_ends_at_once_and_leaves_nothing() {
        let studio = Studio::new(SCENE);
        let before = studio.files();
        // The first pass alone is 4 samples of 16 million pixels.
        let mut child = started(&studio, &["--size", "4096x4096", "--spp", "16777216"]);
        interrupt(&child);
        // Two signals at the same time are one.
        std::thread::sleep(Duration::from_millis(50));
        interrupt(&child);
        assert_eq!(child.wait().unwrap().code(), Some(130));
        assert_eq!(studio.files(), before);
    }
}

/// Over independent pictures the variance of a bin is what the standard errors say it is.
#[test]
fn error_bars_of_bins_are_the_spread_over_seeds() {
    let studio = Studio::new(
        "environment = 1\n[camera]\nfrom = [0, 0, 1]\nto = [0, 0, 0]\nfov = 40\n\
         [image]\nsize = [16, 16]\nspp = 32\nsampler = \"independent\"\n",
    );
    let (name, error) = ("S0.550,000000nm", "standard_error.S0.550,000000nm");
    let layers = ["--layers", "spectral:550-550:20"];
    let seeds: Vec<Vec<f64>> = (0..16)
        .map(|seed| {
            let seed = seed.to_string();
            let arguments = [&layers[..], &["--replicates", "8", "--seed", &seed]].concat();
            let picture = studio.render(&arguments).0;
            let wide = |channel: &str| {
                picture
                    .floats(channel)
                    .unwrap()
                    .iter()
                    .map(|&v| f64::from(v))
            };
            wide(name).chain(wide(error)).collect()
        })
        .collect();
    let (mut reported, mut spread) = (0.0, 0.0);
    let n = seeds.len() as f64;
    for pixel in 0..256 {
        let mean = seeds.iter().map(|values| values[pixel]).sum::<f64>() / n;
        let squares = seeds.iter().map(|values| (values[pixel] - mean).powi(2));
        spread += squares.sum::<f64>() / (n - 1.0);
        reported += seeds
            .iter()
            .map(|values| values[256 + pixel].powi(2))
            .sum::<f64>()
            / n;
    }
    // Both are χ² sums: 256 × 15 degrees of freedom, and 256 × 16 × 7. The ratio's spread is
    // √(2/3840 + 2/28672) = 0.0243 for normal values; five of them are 1 in 1.7 × 10⁶ seeds.
    let ratio = reported / spread;
    assert!((ratio - 1.0).abs() < 5.0 * 0.0243, "{ratio}");
    let picture = studio
        .render(&[&layers[..], &["--replicates", "1"]].concat())
        .0;
    assert!(picture.channel(error).is_none() && picture.channel(name).is_some());
}

/// The sun over nothing but a plane, which has no size that a light's strength could be judged by.
#[test]
fn parallel_light_falls_on_a_plane_alone() {
    let studio = Studio::new(
        "[camera]\nfrom = [0, 1, 0]\nto = [0, 0, 0.1]\nfov = 40\n[image]\nsize = [16, 16]\nspp = 64\n\
         [materials]\nwhite = { diffuse = 0.5 }\n\
         [[object]]\nshape = \"plane\"\nmaterial = \"white\"\ntransform = [{ rotate_x = -90 }]\n\
         [[light]]\ndirection = [0, -1, 0]\nirradiance = 3.141592653589793\n",
    );
    let (picture, _) = studio.render(&["--layers", "spectral:550-550:100"]);
    let bin = picture.floats("S0.550,000000nm").unwrap();
    let error = picture.floats("standard_error.S0.550,000000nm").unwrap();
    let n = bin.len() as f64;
    let mean = bin.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
    let error = error
        .iter()
        .map(|&v| f64::from(v).powi(2))
        .sum::<f64>()
        .sqrt()
        / n;
    // Lambert: 0.5 · π/π; wrong at five standard errors once in 2 × 10⁶ seeds.
    assert!(
        error < 0.01 && (mean - 0.5).abs() < 5.0 * error,
        "{mean} ± {error}"
    );
}
