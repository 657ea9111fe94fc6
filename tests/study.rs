//! `etalon study` and `etalon chart` from outside: what they write, how they go on, what they refuse.

use std::collections::BTreeSet;

use etalon::inside::chart::row::{self, Row};
use etalon::inside::chart::{Key, curves};
use etalon::inside::film::{exr, hash, names};
use etalon::inside::study::axis::Axis;
use etalon::{Attribute, Picture};

use crate::support::{Folder, assert_says, cells, words};

/// A closed ball that glows and reflects half of what falls on it, seen from inside: 0.5/(1 − 0.5).
const SCENE: &str = r#"
truth = 1
camera = { from = [0, 0, 0], to = [0, 0, -1], fov = 40 }
image = { size = [16, 8], spp = 8 }
materials.wall = { diffuse = 0.5, emit = 0.5, sides = "back" }
[[object]]
shape = "sphere"
material = "wall"
[[panel]]
name = "bright"
truth = 2
materials = { wall = { emit = 1 } }
"#;

/// What a study says that is carried out.
#[track_caller]
fn study(folder: &Folder, arguments: &str) -> String {
    folder.done(&words(&format!("study scene.toml --quiet {arguments}")))
}

#[track_caller]
fn refused(folder: &Folder, arguments: &str) -> String {
    folder.refused(&words(&format!("study scene.toml {arguments}")))
}

fn rows(folder: &Folder, table: &str) -> Vec<Row> {
    row::read(&folder.text(table)).unwrap()
}

const GRID: &str = "--over spp=1..16x4 --over sampler=independent,sobol --replicates 4";

#[test]
fn a_study_writes_rows_charts_and_a_report() {
    let folder = Folder::new(SCENE);
    let said = study(&folder, &format!("{GRID} -o out"));
    assert_says(&said, &["the truth that the scene file names"]);
    let rows = rows(&folder, "out/study.csv");
    assert_eq!(rows.len(), 3 * 2 * 4);
    let seeds: BTreeSet<u64> = rows.iter().map(|row| row.seed).collect();
    assert_eq!(seeds.len(), rows.len(), "seeds are shared");
    for row in &rows {
        assert_eq!(row.samples, 16 * 8 * row.spp() as u64);
        assert_eq!((row.reference.as_str(), row.reference_rmse), ("truth", 0.0));
        assert!(row.rmse > 0.0 && row.relmse > 0.0 && row.seconds > 0.0);
        // One sample has one scramble, and no error bar.
        assert_eq!(row.estimated_rmse.is_nan(), row.spp() == 1.0, "{row}");
    }
    for name in ["error", "speed", "honesty"] {
        assert!(folder.text(&format!("out/{name}.svg")).starts_with("<svg"));
    }
    let page = folder.text("out/report.html");
    let picture = "data-picture=\"curve-1\"";
    let columns = ["independent", "relmse"];
    assert_says(&page, &["<svg", picture, "--over spp=1..16x4"]);
    assert_says(&page, &columns);
    assert!(!page.contains("{{"), "a place of the page is left empty");
}

#[test]
fn errors_of_the_panel_are_against_the_panels_truth() {
    let folder = Folder::new(SCENE);
    let study = |more: &str| {
        let grid = "--over spp=64 --replicates 8 --panel bright";
        study(&folder, &format!("{grid} {more}"))
    };
    study("-o out");
    // The wrong truth, 1 instead of 2, would show as a bias of 1.
    for row in rows(&folder, "out/study.csv") {
        assert_eq!(row.panel, "bright");
        let scores = row.bias.abs() / row.bias_standard_error;
        assert!(scores < 6.0, "{row}: {}", row.bias);
        assert!(row.bias_standard_error < 0.05);
    }
    study("-o wrong --reference 1");
    for row in rows(&folder, "wrong/study.csv") {
        assert!(row.bias > 0.9, "{row}: {}", row.bias);
    }
}

#[test]
fn an_interrupted_study_goes_on_where_it_stopped() {
    let folder = Folder::new(SCENE);
    let (arguments, table) = (format!("{GRID} -o out"), "out/study.csv");
    study(&folder, &arguments);
    let whole = folder.text(table);
    let before = rows(&folder, table);
    // A line that was cut off, and all after it gone.
    let lines: Vec<&str> = whole.lines().collect();
    let kept = format!("{}\n{}", lines[..11].join("\n"), &lines[11][..20]);
    folder.write(table, kept);
    study(&folder, &arguments);
    let again = folder.text(table);
    assert_eq!(again.lines().take(11).collect::<Vec<_>>(), lines[..11]);
    let all = rows(&folder, table);
    let timeless = |rows: Vec<Row>| {
        let rows = rows.into_iter();
        let rows = rows.map(|row| Row {
            seconds: 0.0,
            ..row
        });
        rows.map(|row| format!("{row:?}")).collect::<Vec<_>>()
    };
    assert_eq!(timeless(all), timeless(before));
    // Nothing is left to do: nothing is done.
    study(&folder, &arguments);
    assert_eq!(folder.text(table), again);
    let other = arguments.replace("--replicates 4", "--replicates 5");
    assert_says(&refused(&folder, &other), &["another study", "replicates"]);
}

#[test]
fn without_truth_a_study_renders_its_own_reference() {
    let scene = SCENE.replace("truth = 1\n", "").replace("truth = 2\n", "");
    let folder = Folder::new(&scene);
    let said = study(&folder, &format!("{GRID} -o out"));
    assert_says(&said, &["rendered by the study itself"]);
    let rows = rows(&folder, "out/study.csv");
    let curves = curves(&rows, Key::Spp);
    let points = curves.iter().flat_map(|curve| &curve.points);
    let best = points.fold(f64::INFINITY, |best, point| best.min(point.rmse().value));
    let own = rows[0].reference_rmse;
    // Three times below is what it aims at, from one render of the best point: give or take what
    // 128 pixels and 4 renders leave uncertain of either, less than a quarter.
    assert!(own > 0.0 && best / own > 0.75 * 3.0, "{best} {own}");
    assert!(rows.iter().all(|row| row.reference == "own"));
    // A second study with this one's reference as a file: its variance is known, its hash agrees.
    let reference = "--reference out/reference.exr";
    study(&folder, &format!("{GRID} -o again {reference}"));
    let message = refused(&folder, &format!("{reference} --panel bright"));
    assert_says(&message, &["the panel \"bright\""]);
}

#[test]
fn references_that_are_none_are_refused_with_a_reason() {
    let folder = Folder::new(SCENE);
    let own = hash(SCENE);
    let (size, zero) = ([16, 8], Some(0.0));
    let pixels = format!("the channel R has {} pixels that are no numbers", 16 * 8);
    let (wrong, another) = ("8x8 pixels, the scene 16x8", hash("another"));
    for (size, value, variance, hash, words) in [
        ([8, 8], 1.0, zero, &own, [wrong; 2]),
        (size, f32::NAN, zero, &own, [pixels.as_str(); 2]),
        (size, 1.0, Some(-1.0), &own, ["variance.R"; 2]),
        (size, 1.0, None, &own, ["no channels variance.R"; 2]),
        (
            size,
            1.0,
            zero,
            &another,
            ["shows another scene", own.as_str()],
        ),
    ] {
        let mut picture = Picture::new(size[0], size[1]);
        let all = |value: f32| vec![[value; 3]; size[0] * size[1]];
        picture.push_triple("", names::RGB, &all(value));
        if let Some(variance) = variance {
            picture.push_triple("variance", names::RGB, &all(variance));
        }
        let attribute = Attribute::Text(hash.to_owned());
        picture.attributes.push(("sceneHash".to_owned(), attribute));
        exr::write(&folder.path("reference.exr"), &picture).unwrap();
        let message = refused(&folder, "--reference reference.exr");
        assert_says(&message, &words);
    }
    let missing = refused(&folder, "--reference nowhere.exr");
    assert_says(&missing, &["nowhere.exr"]);
}

#[test]
fn grids_that_cannot_be_are_refused_with_what_would_fit() {
    let folder = Folder::new(SCENE);
    let cases = "
        --replicates 1 | at least 2
        --over spp= | no values
        --over spp=4..1x2 | is no range
        --over spp=1..4x1 | is no range
        --over fov=1 | cannot go over
        --over sampler | is no axis
        --over spp=1,2 --over spp=4 | given twice
        --over wavelengths=1,8 | image.wavelengths is 1
        --over sampler=center,sobol | another picture
        --over spp=1..16777216x4 --budget 2 | an axis that ends at spp=
        --over spp=1..16777216x4 --budget 2 | --budget is 2 s
        --over max_depth=1..4x2 --set image.spp=1000000 --budget 2 | --set image.spp=
        --over spp=1 --set image.size=[16384,16384] | image.size=[";
    for [arguments, words] in cells(cases) {
        assert_says(&refused(&folder, arguments), &[words]);
    }
}

#[test]
fn several_tables_go_into_one_chart() {
    let folder = Folder::new(SCENE);
    study(&folder, &format!("{GRID} -o out"));
    // Another program, ten times as slow and as accurate, with the required columns only.
    let mut other = String::from("renderer,scene,spp,seconds,relmse,sampler\n");
    for row in rows(&folder, "out/study.csv") {
        if row.value(Key::Sampler) == "sobol" {
            let (spp, seconds) = (row.spp(), 10.0 * row.seconds);
            other += &format!("slow,scene,{spp},{seconds},{},multijitter\n", row.relmse);
        }
    }
    folder.write("slow.csv", other);
    let chart = "chart out/study.csv slow.csv -o both --at 1e-2";
    let said = folder.done(&words(chart));
    assert_says(&said, &["3 curves of 36 renders", "etalon takes", "slow"]);
    let svg = folder.text("both.svg");
    assert_says(&svg, &["slow, multijitter", "etalon, sobol"]);
    let fast = "renderer,scene,spp,seconds,relmse\na,b,1,fast,1\n";
    for (table, words) in [
        ("renderer,scene,spp\n", &["no column \"seconds\""][..]),
        (fast, &["line 2", "\"fast\""]),
        (&row::heading(), &["no rows"]),
    ] {
        folder.write("bad.csv", table);
        assert_says(&folder.refused(&["chart", "bad.csv"]), words);
    }
}

#[test]
fn axes_are_read_as_they_are_written() {
    for (text, wanted) in [
        ("spp=1..64x4", "spp=1,4,16,64"),
        ("spp=1..10x2,7,2", "spp=1,2,4,7,8"),
        ("max_depth=2..20x1.5", "max_depth=2,3,5,7,10,15"),
        ("sampler=sobol, independent", "sampler=sobol,independent"),
    ] {
        assert_eq!(text.parse::<Axis>().unwrap().to_string(), wanted);
    }
    for text in ["spp=1..4096", "spp=many", "spp=0..4x2"] {
        assert!(text.parse::<Axis>().is_err(), "{text}");
    }
}
