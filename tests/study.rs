//! `etalon study` and `etalon chart` from outside: what they write, how they go on, what they refuse.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed, and the panic says where"
)]

use std::path::Path;
use std::process::{Command, Output, Stdio};

use etalon::inside::chart::row::{self, Row};
use etalon::inside::chart::{Key, curves};
use etalon::inside::film::{self, exr};
use etalon::inside::study::axis::Axis;
use etalon::{Attribute, Picture};
use tempfile::TempDir;

/// A closed ball that glows and reflects half of what falls on it, seen from inside: 0.5/(1 − 0.5).
const SCENE: &str = r#"
truth = 1
[camera]
from = [0, 0, 0]
to = [0, 0, -1]
fov = 40
[image]
size = [16, 8]
spp = 8
[materials]
wall = { diffuse = 0.5, emit = 0.5, sides = "back" }
[[object]]
shape = "sphere"
material = "wall"
[[panel]]
name = "bright"
truth = 2
materials = { wall = { emit = 1 } }
"#;

/// A directory with that scene.
struct Studio(TempDir);

impl Studio {
    fn new(scene: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("ball.toml"), scene).unwrap();
        Self(directory)
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_etalon"))
            .current_dir(self.path())
            .args(arguments)
            .stdin(Stdio::null())
            .output()
            .unwrap()
    }

    /// What a study says that is carried out.
    fn study(&self, arguments: &[&str]) -> String {
        let output = self.run(&[&["study", "ball.toml", "--quiet"], arguments].concat());
        let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {complaint}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// What is said when a command is refused.
    fn refused(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.starts_with("error: "), "{message}");
        message
    }

    fn rows(&self, table: &str) -> Vec<Row> {
        row::read(&self.text(table)).unwrap()
    }

    fn text(&self, file: &str) -> String {
        std::fs::read_to_string(self.path().join(file)).unwrap()
    }
}

/// Everything in a row but the time it took.
fn timeless(row: &Row) -> Row {
    Row {
        seconds: 0.0,
        ..row.clone()
    }
}

const GRID: [&str; 6] = [
    "--over",
    "spp=1..16x4",
    "--over",
    "sampler=independent,sobol",
    "--replicates",
    "4",
];

#[test]
fn a_study_writes_rows_charts_and_a_report() {
    let studio = Studio::new(SCENE);
    let said = studio.study(&[&GRID[..], &["-o", "out"]].concat());
    assert!(
        said.contains("the truth that the scene file names"),
        "{said}"
    );
    let rows = studio.rows("out/study.csv");
    assert_eq!(rows.len(), 3 * 2 * 4);
    let mut seeds: Vec<u64> = rows.iter().map(|row| row.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    assert_eq!(seeds.len(), rows.len(), "seeds are shared");
    for row in &rows {
        assert_eq!(row.samples, 16 * 8 * row.spp() as u64);
        assert_eq!((row.reference.as_str(), row.reference_rmse), ("truth", 0.0));
        assert!(row.rmse > 0.0 && row.relmse > 0.0 && row.seconds > 0.0);
        // One sample has one scramble, and no error bar.
        assert_eq!(row.estimated_rmse.is_nan(), row.spp() == 1.0, "{row}");
    }
    for name in ["error", "speed", "honesty"] {
        assert!(studio.text(&format!("out/{name}.svg")).starts_with("<svg"));
    }
    let page = studio.text("out/report.html");
    for part in [
        "<svg",
        "data-picture=\"curve-1\"",
        "independent",
        "--over spp=1..16x4",
        "relmse",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("{{"), "a place of the page is left empty");
}

#[test]
fn errors_of_the_panel_are_against_the_panels_truth() {
    let studio = Studio::new(SCENE);
    let grid = [
        "--over",
        "spp=64",
        "--replicates",
        "8",
        "-o",
        "out",
        "--panel",
        "bright",
    ];
    studio.study(&grid);
    let rows = studio.rows("out/study.csv");
    assert!(rows.iter().all(|row| row.panel == "bright"));
    // The wrong truth, 1 instead of 2, would show as a bias of 1.
    for row in &rows {
        assert!(
            row.bias.abs() < 6.0 * row.bias_standard_error,
            "{row}: {}",
            row.bias
        );
        assert!(row.bias_standard_error < 0.05);
    }
    let wrong = [
        &grid[..4],
        &["-o", "wrong", "--panel", "bright", "--reference", "1"],
    ]
    .concat();
    studio.study(&wrong);
    for row in studio.rows("wrong/study.csv") {
        assert!(row.bias > 0.9, "{row}: {}", row.bias);
    }
}

#[test]
fn an_interrupted_study_goes_on_where_it_stopped() {
    let studio = Studio::new(SCENE);
    let arguments = [&GRID[..], &["-o", "out"]].concat();
    studio.study(&arguments);
    let whole = studio.text("out/study.csv");
    let rows = studio.rows("out/study.csv");
    // A line that was cut off, and all after it gone.
    let lines: Vec<&str> = whole.lines().collect();
    let kept = format!("{}\n{}", lines[..11].join("\n"), &lines[11][..20]);
    std::fs::write(studio.path().join("out/study.csv"), kept).unwrap();
    studio.study(&arguments);
    let again = studio.text("out/study.csv");
    assert_eq!(again.lines().take(11).collect::<Vec<_>>(), lines[..11]);
    let all: Vec<Row> = studio.rows("out/study.csv");
    let same = |(a, b): (&Row, &Row)| format!("{:?}", timeless(a)) == format!("{:?}", timeless(b));
    assert!(all.iter().zip(&rows).all(same));
    assert_eq!(all.len(), rows.len());
    // Nothing is left to do: nothing is done.
    studio.study(&arguments);
    assert_eq!(studio.text("out/study.csv"), again);
    let other = [
        &["study", "ball.toml", "-o", "out"],
        &GRID[..4],
        &["--replicates", "5"],
    ]
    .concat();
    let message = studio.refused(&other);
    assert!(
        message.contains("another study") && message.contains("replicates"),
        "{message}"
    );
}

#[test]
fn without_truth_a_study_renders_its_own_reference() {
    let scene = SCENE.replace("truth = 1\n", "").replace("truth = 2\n", "");
    let studio = Studio::new(&scene);
    let said = studio.study(&[&GRID[..], &["-o", "out"]].concat());
    assert!(said.contains("rendered by the study itself"), "{said}");
    let rows = studio.rows("out/study.csv");
    let best = curves(&rows, Key::Spp)
        .iter()
        .flat_map(|curve| curve.points.clone())
        .map(|point| point.rmse().value)
        .fold(f64::INFINITY, f64::min);
    let own = rows[0].reference_rmse;
    // Three times below is what it aims at, from one render of the best point: give or take what
    // 128 pixels and 4 renders leave uncertain of either, less than a quarter.
    assert!(own > 0.0 && best / own > 0.75 * 3.0, "{best} {own}");
    assert!(rows.iter().all(|row| row.reference == "own"));
    // A second study with this one's reference as a file: its variance is known, its hash agrees.
    let again = [
        &GRID[..],
        &["-o", "again", "--reference", "out/reference.exr"],
    ]
    .concat();
    studio.study(&again);
    let message = studio.refused(&[
        "study",
        "ball.toml",
        "--panel",
        "bright",
        "--reference",
        "out/reference.exr",
    ]);
    assert!(message.contains("the panel \"bright\""), "{message}");
}

#[test]
fn references_that_are_none_are_refused_with_a_reason() {
    let studio = Studio::new(SCENE);
    let pixels = 16 * 8;
    let reference = |size: [usize; 2], value: f32, variance: Option<f32>, hash: &str| {
        let mut picture = Picture::new(size[0], size[1]);
        let all = vec![[value; 3]; size[0] * size[1]];
        picture.push_triple("", ["R", "G", "B"], &all);
        if let Some(variance) = variance {
            let all = vec![[variance; 3]; size[0] * size[1]];
            picture.push_triple("variance", ["R", "G", "B"], &all);
        }
        let attribute = Attribute::Text(hash.to_owned());
        picture.attributes.push(("sceneHash".to_owned(), attribute));
        exr::write(&studio.path().join("reference.exr"), &picture).unwrap();
    };
    let study = || studio.refused(&["study", "ball.toml", "--reference", "reference.exr"]);
    let hash = film::hash(SCENE);
    reference([8, 8], 1.0, Some(0.0), &hash);
    assert!(study().contains("8x8 pixels, the scene 16x8"));
    reference([16, 8], f32::NAN, Some(0.0), &hash);
    assert!(study().contains(&format!(
        "the channel R has {pixels} pixels that are no numbers"
    )));
    reference([16, 8], 1.0, Some(-1.0), &hash);
    assert!(study().contains("variance.R"));
    reference([16, 8], 1.0, None, &hash);
    assert!(study().contains("no channels variance.R"));
    reference([16, 8], 1.0, Some(0.0), &film::hash("another"));
    let message = study();
    assert!(
        message.contains("shows another scene") && message.contains(&hash),
        "{message}"
    );
    assert!(
        !studio.path().join("ball-study").exists(),
        "refused, and yet begun"
    );
    let missing = studio.refused(&["study", "ball.toml", "--reference", "nowhere.exr"]);
    assert!(missing.contains("nowhere.exr"));
}

#[test]
fn grids_that_cannot_be_are_refused_with_what_would_fit() {
    let studio = Studio::new(SCENE);
    let refused =
        |arguments: &[&str]| studio.refused(&[&["study", "ball.toml"], arguments].concat());
    assert!(refused(&["--replicates", "1"]).contains("at least 2"));
    assert!(refused(&["--over", "spp="]).contains("no values"));
    assert!(refused(&["--over", "spp=4..1x2"]).contains("is no range"));
    assert!(refused(&["--over", "spp=1..4x1"]).contains("is no range"));
    assert!(refused(&["--over", "fov=1"]).contains("cannot go over"));
    assert!(refused(&["--over", "sampler"]).contains("is no axis"));
    assert!(refused(&["--over", "spp=1,2", "--over", "spp=4"]).contains("given twice"));
    assert!(refused(&["--over", "wavelengths=1,8"]).contains("image.wavelengths is 1"));
    let mixed = refused(&["--over", "sampler=center,sobol"]);
    assert!(mixed.contains("another picture"), "{mixed}");
    let long = refused(&["--over", "spp=1..16777216x4", "--budget", "2"]);
    assert!(
        long.contains("an axis that ends at spp=") && long.contains("--budget is 2 s"),
        "{long}"
    );
    let one = refused(&[
        "--over",
        "max_depth=1..4x2",
        "--set",
        "image.spp=1000000",
        "--budget",
        "2",
    ]);
    assert!(one.contains("--set image.spp="), "{one}");
    let large = refused(&["--over", "spp=1", "--set", "image.size=[16384, 16384]"]);
    assert!(large.contains("image.size=["), "{large}");
    assert!(!studio.path().join("ball-study").exists());
}

#[test]
fn several_tables_go_into_one_chart() {
    let studio = Studio::new(SCENE);
    let own = [&GRID[..], &["-o", "out"]].concat();
    studio.study(&own);
    // Another program, ten times as slow and as accurate, with the required columns only.
    let mut other = String::from("renderer,scene,spp,seconds,relmse,sampler\n");
    for row in studio.rows("out/study.csv") {
        if row.value(Key::Sampler) == "sobol" {
            let (spp, seconds) = (row.spp(), 10.0 * row.seconds);
            other += &format!("slow,ball,{spp},{seconds},{},multijitter\n", row.relmse);
        }
    }
    std::fs::write(studio.path().join("slow.csv"), other).unwrap();
    let output = studio.run(&[
        "chart",
        "out/study.csv",
        "slow.csv",
        "-o",
        "both",
        "--at",
        "1e-2",
    ]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(said.contains("3 curves of 36 renders"), "{said}");
    assert!(
        said.contains("etalon takes") && said.contains("slow"),
        "{said}"
    );
    let svg = studio.text("both.svg");
    assert!(
        svg.contains("slow, multijitter") && svg.contains("etalon, sobol"),
        "{svg}"
    );
    std::fs::write(studio.path().join("bad.csv"), "renderer,scene,spp\n").unwrap();
    assert!(
        studio
            .refused(&["chart", "bad.csv"])
            .contains("no column \"seconds\"")
    );
    let text = "renderer,scene,spp,seconds,relmse\na,b,1,fast,1\n";
    std::fs::write(studio.path().join("bad.csv"), text).unwrap();
    let message = studio.refused(&["chart", "bad.csv"]);
    assert!(
        message.contains("line 2") && message.contains("\"fast\""),
        "{message}"
    );
    std::fs::write(studio.path().join("bad.csv"), row::heading()).unwrap();
    assert!(studio.refused(&["chart", "bad.csv"]).contains("no rows"));
}

#[test]
fn axes_are_read_as_they_are_written() {
    let axis = |text: &str| text.parse::<Axis>().unwrap().to_string();
    assert_eq!(axis("spp=1..64x4"), "spp=1,4,16,64");
    assert_eq!(axis("spp=1..10x2,7,2"), "spp=1,2,4,7,8");
    assert_eq!(axis("max_depth=2..20x1.5"), "max_depth=2,3,5,7,10,15");
    assert_eq!(
        axis("sampler=sobol, independent"),
        "sampler=sobol,independent"
    );
    assert!("spp=1..4096".parse::<Axis>().is_err());
    assert!("spp=many".parse::<Axis>().is_err());
    assert!("spp=0..4x2".parse::<Axis>().is_err());
}
