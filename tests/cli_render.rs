//! `etalon render` and `etalon info` from outside: pictures, their bits, and what is refused.

use std::collections::BTreeSet;

use etalon::inside::film::names;
use etalon::{Attribute, Channel, Estimate, Picture, Values};

use crate::statistics_support::moments;
use crate::support::{Folder, assert_says, attribute, value_bits, wide, words};

/// A checkered floor, a glass ball, a mirror, a lamp and a dim sky: every kind of path.
const SCENE: &str = r#"
environment = 0.05
camera = { from = [0, 1, 5], to = [0, 0.5, 0], fov = 40 }
image = { size = [21, 17], spp = 24, max_depth = 6 }
materials.floor = { checkerboard = [0.2, 0.7], cell = 1 }
materials.glass = { glass = "N-SF11" }
materials.silver = { mirror = "Ag" }
materials.lamp = { emit = 3 }
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

const LAYERS: [&str; 2] = [
    "--layers",
    "depth,normal,object,material,spectral:400-700:50",
];

/// The picture that these arguments give, and what was said about it.
#[track_caller]
fn render(folder: &Folder, arguments: &[&str]) -> (Picture, String) {
    let said = folder.done(&[&["render", "scene.toml", "-o", "out.exr"], arguments].concat());
    (folder.picture("out.exr"), said)
}

#[track_caller]
fn render_bits(folder: &Folder, arguments: &[&str]) -> Vec<(String, Vec<u32>)> {
    bits(&render(folder, arguments).0)
}

fn refused(folder: &Folder, arguments: &[&str]) -> String {
    folder.refused(&[&["render", "scene.toml"], arguments].concat())
}

/// Every channel's name and bits.
fn bits(picture: &Picture) -> Vec<(String, Vec<u32>)> {
    let bits = |c: &Channel| (c.name.clone(), value_bits(&c.values));
    picture.channels.iter().map(bits).collect()
}

/// The count that "… after 123 spp in …" names.
fn reached(said: &str) -> &str {
    let words: Vec<&str> = said.split_whitespace().collect();
    let at = words.iter().position(|word| *word == "spp").unwrap();
    words[at - 1]
}

#[test]
fn a_picture_says_where_it_comes_from() {
    let folder = Folder::new(SCENE);
    let (picture, said) = render(&folder, &["--set", "environment=0.1"]);
    assert_eq!((picture.width, picture.height), (21, 17));
    let channels: Vec<&str> = picture.channels.iter().map(|c| c.name.as_str()).collect();
    let errors = ["B", "G", "R"].map(|name| format!("standard_error.{name}"));
    let [b, g, r] = errors.each_ref().map(String::as_str);
    assert_eq!(channels, ["B", "G", "R", "samples", b, g, r]);
    for (name, number) in [("spp", 24), ("replicates", 2), ("maxDepth", 6)] {
        assert_eq!(picture.attribute(name), Some(&Attribute::Int(number)));
    }
    assert_eq!(attribute(&picture, "sceneText"), SCENE);
    assert_eq!(attribute(&picture, "settings"), "environment=0.1");
    assert_eq!(attribute(&picture, "sampler"), "sobol");
    let plan = attribute(&picture, "plan");
    assert!(plan.contains("all but one end where it is refracted by ball"));
    assert!(attribute(&picture, "tiers").contains("decided in lanes of"));
    let cut = "cut off by max_depth";
    assert_says(&said, &["24 spp in ", "samples/s", " ± ", cut, "0 NaN"]);
    assert!(folder.files().contains("out.png"));
}

#[test]
fn a_single_replicate_has_no_standard_error() {
    let (picture, said) = render(&Folder::new(SCENE), &["--spp", "1"]);
    assert!(picture.channel("standard_error.R").is_none());
    assert!(picture.attribute("standardError").is_none());
    assert!(said.contains("standard error unknown with 1 replicate"));
}

#[test]
fn bits_are_the_same_on_any_threads_and_instructions() {
    let folder = Folder::new(SCENE);
    let with = |arguments: &[&str]| render_bits(&folder, &[&LAYERS, arguments].concat());
    let reference = with(&[]);
    assert_eq!(with(&[]), reference, "run twice");
    for threads in ["1", "2", "3"] {
        assert_eq!(with(&["--threads", threads]), reference, "{threads}");
    }
    let mut others = 0;
    let layers = LAYERS.join(" ");
    for instructions in ["avx512", "avx2", "sse2"] {
        let with = format!("{layers} --instructions {instructions}");
        let said = folder.run(&words(&format!("render scene.toml -o other.exr {with}")));
        if said.code == Some(2) {
            assert!(said.err.contains("this machine has no"), "{}", said.err);
            continue;
        }
        others += 1;
        let picture = folder.picture("other.exr");
        assert_eq!(attribute(&picture, "instructions"), instructions);
        assert_eq!(bits(&picture), reference, "{instructions}");
    }
    assert!(others > 0 || !cfg!(target_arch = "x86_64"));
    assert_ne!(with(&["--seed", "1"]), reference, "another seed");
}

#[test]
fn a_time_limit_gives_the_bits_of_the_count_it_reached() {
    let folder = Folder::new(SCENE);
    for sampler in ["sobol", "independent", "center"] {
        // Long enough for several passes, and for replicates to grow.
        let limited = render(&folder, &["--sampler", sampler, "--time", "0.2"]);
        let count = reached(&limited.1);
        assert!(count.parse::<u32>().unwrap() > 24, "{}", limited.1);
        let counted = render_bits(&folder, &["--sampler", sampler, "--spp", count]);
        assert_eq!(bits(&limited.0), counted, "{sampler} {count}");
    }
    let (_, said) = render(&folder, &["--time", "100", "--spp", "5"]);
    // Where both are given, --spp is the most.
    assert_eq!(reached(&said), "5");
}

#[test]
fn strata_need_a_planned_count() {
    let folder = Folder::new(SCENE);
    let strata = ["--sampler", "stratified", "--time", "0.05"];
    assert_says(&refused(&folder, &strata), &["--time needs --spp"]);
    let planned = [&strata[..], &["--spp", "1000000"]].concat();
    let (picture, said) = render(&folder, &planned);
    assert!(said.contains(" spp (of strata for 1000000) in "), "{said}");
    assert_eq!(attribute(&picture, "sppPlanned"), "1000000");
}

#[test]
fn a_crop_is_a_part_of_the_picture() {
    let folder = Folder::new(SCENE);
    let whole = render_bits(&folder, &LAYERS);
    let (x0, y0, x1, y1) = (3, 2, 20, 17);
    let crop = render(&folder, &[&LAYERS[..], &["--crop", "3,2,20,17"]].concat()).0;
    assert_eq!((crop.width, crop.height), (x1 - x0, y1 - y0));
    assert_eq!(attribute(&crop, "crop"), "3,2,20,17 of 21x17");
    for ((name, part), (_, all)) in bits(&crop).iter().zip(whole) {
        let rows = (y0..y1).flat_map(|y| all[y * 21 + x0..y * 21 + x1].to_vec());
        assert_eq!(*part, rows.collect::<Vec<_>>(), "{name}");
    }
}

#[test]
fn layers_show_what_the_pixels_centre_sees() {
    let folder = Folder::new(
        "camera = { from = [1, 2, 8], to = [1, 2, 3], fov = 40 }\n\
         image = { size = [5, 5], spp = 1 }\n\
         materials = { unused = { diffuse = 0 }, white = { diffuse = 0.5 } }\n\
         [[object]]\nshape = { sphere = { radius = 0.25 } }\nmaterial = \"white\"\n\
         transform = [{ translate = [1, 2, 3] }]\n",
    );
    let (picture, _) = render(&folder, &["--layers", "depth,normal,object,material"]);
    let at = |channel: &str, pixel: usize| picture.floats(channel).unwrap()[pixel];
    let identity = |channel: &str, pixel: usize| match &picture.channel(channel).unwrap().values {
        Values::U32(values) => values[pixel],
        Values::F32(_) => panic!("{channel} is no identity"),
    };
    let (centre, corner) = (12, 0);
    assert_eq!(at(names::DEPTH, centre), 4.75);
    let normal = ["N.X", "N.Y", "N.Z"].map(|channel| at(channel, centre));
    assert_eq!(normal, [0.0, 0.0, 1.0]);
    assert_eq!(at(names::DEPTH, corner), f32::INFINITY);
    assert_eq!(at("N.Z", corner), 0.0);
    for (channel, number) in [(names::OBJECT_ID, 0), (names::MATERIAL_ID, 1)] {
        assert_eq!(identity(channel, centre), number);
        assert_eq!(identity(channel, corner), names::NOTHING);
    }
}

/// Nothing but a sky of radiance 1.
const SKY: &str = "environment = 1\n\
                   camera = { from = [0, 0, 1], to = [0, 0, 0], fov = 40 }\n\
                   image = { size = [16, 16], spp = 256 }\n";

#[test]
fn a_flat_environment_is_1_in_every_bin() {
    let folder = Folder::new(SKY);
    for wavelengths in ["4", "8"] {
        let arguments = format!("--layers spectral:365-825:10 --wavelengths {wavelengths}");
        let (picture, _) = render(&folder, &words(&arguments));
        let names = picture.channels.iter().map(|c| &c.name);
        let names = names.filter(|name| name.starts_with("S0."));
        assert_eq!(names.clone().count(), 47);
        for name in names {
            let mean = Estimate::mean(&wide(&picture, name));
            // 94 means at five standard errors: wrong once in 2 × 10⁴ seeds, and this is one.
            assert!(mean.score(1.0).abs() < 5.0, "{name} {mean}");
            // A bin is C intervals of the hero's variate, each with two edges in strata of K
            // replicates, and so at most 2 C K/4 variance of the count; at 825 nm 2.4e-4 nm⁻¹ of
            // the density makes 0.6 C counts of 256: 1.7/√C a pixel, and 256 pixels.
            assert!(mean.standard_error < 0.06, "{name} {mean}");
        }
    }
    let message = refused(&folder, &["--layers", "spectral:300-700:10"]);
    assert_says(&message, &["the bin at 300 nm"]);
}

#[test]
fn files_are_named_after_scene_and_panel() {
    let folder = Folder::new(SCENE);
    let run = |rest: &str| folder.done(&words(&format!("render scene.toml {rest}")));
    run("--spp 1");
    assert_eq!(run("--panel all").lines().count(), 2);
    run("--panel a -o x.y.exr --quiet");
    run("--panel all -o x.y.exr");
    let stems = ["scene", "scene-a", "scene-b_c", "x.y", "x.y-a", "x.y-b_c"];
    let mut expected: BTreeSet<String> = ["scene.toml".to_owned()].into();
    for stem in stems {
        expected.extend(["exr", "png"].map(|extension| format!("{stem}.{extension}")));
    }
    assert_eq!(folder.files(), expected);
    let small = folder.picture("scene-b_c.exr");
    assert_eq!((small.width, small.height), (5, 4));
    assert_eq!(attribute(&small, "panel"), "b/c");
}

#[test]
fn what_cannot_be_done_is_refused_before_it_is_begun() {
    let folder = Folder::new(SCENE);
    for name in ["here.exr", "seen.png"] {
        std::fs::create_dir(folder.path(name)).unwrap();
    }
    let memory = ["--size", "16384x16384", "--layers", "spectral:400-800:0.1"];
    for (arguments, words) in [
        (&["-o", "missing/out.exr"][..], "missing"),
        (&["-o", "here.exr"], "it is a directory"),
        (&["-o", "out.png"], "it is OpenEXR"),
        (&["-o", "./scene.toml"], "that is the scene file"),
        (&["--crop", "0,0,22,17"], "not inside the picture of 21x17"),
        (&["-o", "seen.exr"], "seen.png: it is a directory"),
        (&memory, "MiB of memory"),
    ] {
        let message = refused(&folder, &[arguments, &["--spp", "16777216"]].concat());
        assert!(message.contains(words), "{message}");
    }
    let plain = SCENE.split("[[panel]]").next().unwrap();
    let message = refused(&Folder::new(plain), &["--panel", "all"]);
    assert!(message.contains("has no panels"), "{message}");
}

#[test]
fn info_explains_the_plan() {
    let folder = Folder::new(SCENE);
    let info = ["info", "scene.toml", "--panel", "b/c"];
    let said = folder.done(&info);
    let words = [
        "panel b/c: 5 × 4 pixels, 1 camera paths each",
        "1 sphere (dispersive glass)",
        "camera: no lens",
        "sampled by area: lamp (100 %)",
        "only scattered rays find: the environment",
        "of a pixel's width there (allowed 0.01)",
        "a list of 4 objects",
        "at most 6 segments",
    ];
    assert_says(&said, &words);
    let branches = |said: &str, start: &str| {
        let line = said.lines().find(|line| line.starts_with(start)).unwrap();
        line.split_once(": ").unwrap().1.to_owned()
    };
    let [kept, left_out] =
        ["in the loop", "left out of the loop"].map(|start| branches(&said, start));
    assert_says(&kept, &["dispersion"]);
    assert_says(&left_out, &["lens"]);
    // Nothing is left out of the full plan.
    let full = folder.done(&[&info[..], &["--plan", "full"]].concat());
    let nothing = branches(&full, "left out of the loop");
    assert_eq!(nothing, "nothing, as asked for");
    let all = branches(&full, "in the loop");
    let branch = |name: &str| all.split(", ").any(|other| other == name);
    let mut names = kept.split(", ").chain(left_out.split(", "));
    assert!(names.all(branch), "{full}");
}

/// Ctrl-C, as a terminal sends it.
#[cfg(target_os = "linux")]
mod interrupts {
    use std::process::{Child, Command};
    use std::time::Duration;

    use crate::support::Finished;

    use super::*;

    /// Starts a render that would take hours, and waits until it listens to signals.
    fn started(folder: &Folder, arguments: &[&str]) -> Child {
        let all = [&["render", "scene.toml", "--spp", "16777216"], arguments].concat();
        let child = folder.command(&all).spawn().unwrap();
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
        let folder = Folder::new(SCENE);
        let child = started(&folder, &[]);
        interrupt(&child);
        let said = Finished::from(child.wait_with_output().unwrap());
        assert_eq!(said.code, Some(0));
        assert_says(&said.out, &["interrupted after "]);
        let kept = folder.picture("scene.exr");
        let counted = render_bits(&folder, &["--spp", reached(&said.out)]);
        assert_eq!(bits(&kept), counted);
    }

    #[test]
    fn the_second_ends_at_once_and_leaves_nothing() {
        let folder = Folder::new(SCENE);
        let before = folder.files();
        // The first pass alone is 4 samples of 16 million pixels.
        let mut child = started(&folder, &["--size", "4096x4096"]);
        interrupt(&child);
        // Two signals at the same time are one.
        std::thread::sleep(Duration::from_millis(50));
        interrupt(&child);
        assert_eq!(child.wait().unwrap().code(), Some(130));
        assert_eq!(folder.files(), before);
    }
}

/// Over independent pictures the variance of a bin is what the standard errors say it is.
#[test]
fn error_bars_of_bins_are_the_spread_over_seeds() {
    let folder = Folder::new(&SKY.replace("256 }", "32, sampler = \"independent\" }"));
    let (name, error) = ("S0.550,000000nm", "standard_error.S0.550,000000nm");
    let with = |replicates: u32, seed: u32| {
        let layers = "--layers spectral:550-550:20";
        let arguments = format!("{layers} --replicates {replicates} --seed {seed}");
        render(&folder, &words(&arguments)).0
    };
    let pictures: Vec<Picture> = (0..16).map(|seed| with(8, seed)).collect();
    let columns = |name| pictures.iter().map(|picture| wide(picture, name)).collect();
    let columns: [Vec<Vec<f64>>; 2] = [name, error].map(columns);
    let (mut reported, mut spread) = (0.0, 0.0);
    for pixel in 0..256 {
        let at = |pictures: &Vec<Vec<f64>>| pictures.iter().map(|values| values[pixel]).collect();
        let [values, errors]: [Vec<f64>; 2] = columns.each_ref().map(at);
        spread += moments(&values).1;
        reported += errors.iter().map(|error| error * error).sum::<f64>() / 16.0;
    }
    // Both are χ² sums: 256 × 15 degrees of freedom, and 256 × 16 × 7. The ratio's spread is
    // √(2/3840 + 2/28672) = 0.0243 for normal values; five of them are 1 in 1.7 × 10⁶ seeds.
    let ratio = reported / spread;
    assert!((ratio - 1.0).abs() < 5.0 * 0.0243, "{ratio}");
    let picture = with(1, 0);
    assert!(picture.channel(error).is_none() && picture.channel(name).is_some());
}

/// The sun over nothing but a plane, which has no size that a light's strength could be judged by.
#[test]
fn parallel_light_falls_on_a_plane_alone() {
    let folder = Folder::new(
        "camera = { from = [0, 1, 0], to = [0, 0, 0.1], fov = 40 }\n\
         image = { size = [16, 16], spp = 64 }\n\
         materials.white = { diffuse = 0.5 }\n\
         [[object]]\nshape = \"plane\"\nmaterial = \"white\"\ntransform = [{ rotate_x = -90 }]\n\
         [[light]]\ndirection = [0, -1, 0]\nirradiance = 3.141592653589793\n",
    );
    let (picture, _) = render(&folder, &["--layers", "spectral:550-550:100"]);
    let bin = wide(&picture, "S0.550,000000nm");
    let variances = wide(&picture, "standard_error.S0.550,000000nm");
    let variances: Vec<f64> = variances.iter().map(|error| error * error).collect();
    let mean = Estimate::mean_of(&bin, &variances, f64::INFINITY);
    // Lambert: 0.5 · π/π; wrong at five standard errors once in 2 × 10⁶ seeds.
    let near = mean.score(0.5).abs() < 5.0;
    assert!(mean.standard_error < 0.01 && near, "{mean}");
}
