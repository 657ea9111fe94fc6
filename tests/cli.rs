//! The binary from outside: exit codes, messages, and rays with known answers.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed, and the panic says where"
)]

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use rayon::prelude::*;
use tempfile::TempDir;

const HEAD: &str = "\
[camera]
from = [0, 0, 5]
to = [0, 0, 0]
fov = 40

[image]
size = [4, 4]
spp = 1

[materials]
opaque = { diffuse = 0.5 }
glass = { glass = \"N-BK7\" }
";

fn object(shape: &str, material: &str, rest: &str) -> String {
    format!("\n[[object]]\nshape = {shape}\nmaterial = \"{material}\"\n{rest}\n")
}

/// A directory with one scene file.
struct Scene {
    directory: TempDir,
}

impl Scene {
    fn new(objects: &[String]) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let text = format!("{HEAD}{}", objects.concat());
        std::fs::write(directory.path().join("scene.toml"), text).unwrap();
        Self { directory }
    }

    fn sphere() -> Self {
        Self::new(&[object("\"sphere\"", "opaque", "")])
    }

    /// Runs a command on the scene.
    fn run(&self, command: &str, arguments: &[&str], input: &str) -> Output {
        let mut all = vec![command, "scene.toml"];
        all.extend(arguments);
        etalon(self.directory.path(), &all, input)
    }

    /// The rows that `trace` prints for these rays.
    fn trace(&self, rays: &str) -> Vec<Row> {
        let output = self.run("trace", &["--rays", "-"], rays);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        rows(&text(&output.stdout))
    }
}

fn etalon(directory: &Path, arguments: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_etalon"))
        .args(arguments)
        .current_dir(directory)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    std::thread::scope(|scope| {
        // A command that needs no input may be gone before it is written.
        scope.spawn(move || {
            let _ = stdin.write_all(input.as_bytes());
        });
        child.wait_with_output().unwrap()
    })
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

type Row = HashMap<String, String>;

fn rows(table: &str) -> Vec<Row> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

fn number(row: &Row, name: &str) -> f64 {
    row[name].parse().unwrap()
}

/// Exit code and stderr.
fn failure(output: &Output) -> (Option<i32>, String) {
    (output.status.code(), text(&output.stderr))
}

/// A scene of one canonical shape under one matrix, kept bit for bit.
fn placed(shape: &str, transform: &Row) -> Scene {
    let row = |i: usize| {
        let entries = [0, 1, 2, 3].map(|j| format!("{:?}", number(transform, &format!("m{i}{j}"))));
        format!("[{}]", entries.join(", "))
    };
    let matrix = [row(0), row(1), row(2)].join(", ");
    let shape = match shape {
        "rect" => "\"rectangle\"".to_owned(),
        other => format!("\"{other}\""),
    };
    let transform = format!("transform = [{{ matrix = [{matrix}] }}]");
    Scene::new(&[object(&shape, "opaque", &transform)])
}

/// What is wrong with the answer to a ray of the oracle.
fn disagreement(want: &Row, found: &Row) -> Option<String> {
    let id = &want["id"];
    if found["id"] != *id {
        return Some(format!("{id}: answered as {}", found["id"]));
    }
    if want["touch"] == "1" {
        if found["hit"] == "0" || want["t0"].is_empty() {
            return None;
        }
        let (t0, t1, t) = (number(want, "t0"), number(want, "t1"), number(found, "t"));
        // The printed bounds are read to within one unit in the last place.
        let slack = 2.0 * f64::EPSILON * t0.abs().max(t1.abs());
        return (!(t >= t0 - slack && t <= t1 + slack))
            .then(|| format!("{id}: touch at {t}, not in [{t0}, {t1}]"));
    }
    if found["hit"] != want["hit"] {
        return Some(format!("{id}: hit {}, want {}", found["hit"], want["hit"]));
    }
    if want["hit"] == "0" {
        return ["t", "x", "y", "z", "nx", "ny", "nz", "object"]
            .iter()
            .any(|name| !found[*name].is_empty())
            .then(|| format!("{id}: a miss with values"));
    }
    if !want["t"].is_empty() {
        let (t, wanted) = (number(found, "t"), number(want, "t"));
        // t is the nearest f64 or its neighbour; the oracle's 22 digits are rounded when read.
        if (t - wanted).abs() > 2.0 * f64::EPSILON * wanted.abs() {
            return Some(format!("{id}: t {t:?}, want {wanted:?}"));
        }
    }
    if !want["nx"].is_empty() {
        for name in ["nx", "ny", "nz"] {
            // Two units of rounding, and the oracle's 15 printed digits.
            if (number(found, name) - number(want, name)).abs() > 2e-15 {
                return Some(format!("{id}: {name} {}, want {}", found[name], want[name]));
            }
        }
    }
    None
}

#[test]
fn trace_agrees_with_the_oracle_on_every_primitive() {
    let transforms: HashMap<String, Row> = rows(include_str!("data/transforms.csv"))
        .into_iter()
        .map(|row| (row["transform"].clone(), row))
        .collect();
    let mut groups: BTreeMap<(String, String), Vec<Row>> = BTreeMap::new();
    for row in rows(include_str!("data/primitives.csv")) {
        let key = (row["shape"].clone(), row["transform"].clone());
        groups.entry(key).or_default().push(row);
    }
    let columns = ["tmin", "dz", "dy", "dx", "class", "ox", "oy", "oz", "id"];
    let groups: Vec<_> = groups.into_iter().collect();
    let results: Vec<(usize, Vec<String>)> = groups
        .par_iter()
        .map(|((shape, transform), wanted)| {
            let mut rays = columns.join(",");
            for row in wanted {
                let fields: Vec<&str> = columns.iter().map(|name| row[*name].as_str()).collect();
                write!(rays, "\n{}", fields.join(",")).unwrap();
            }
            let found = placed(shape, &transforms[transform]).trace(&rays);
            assert_eq!(found.len(), wanted.len(), "{shape} {transform}");
            let pairs = wanted.iter().zip(&found);
            let wrong = pairs.filter_map(|(want, found)| disagreement(want, found));
            (found.len(), wrong.collect())
        })
        .collect();
    let wrong: Vec<&str> = results
        .iter()
        .flat_map(|r| &r.1)
        .map(String::as_str)
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(results.iter().map(|r| r.0).sum::<usize>(), 3000);
}

#[test]
fn numbers_and_names_go_through_unchanged() {
    let scene = Scene::new(&[
        object("\"sphere\"", "opaque", "name = 'a \"b\", c'"),
        object(
            "{ plane = {} }",
            "opaque",
            "transform = [{ translate = [0, 0, -4] }]",
        ),
    ]);
    let found = scene.trace(
        "tmax,dx,dy,dz,ox,oy,oz,id\n\
         inf,-0.0,5e-324,2,-0.0,0,-3,\"x, y\"\r\n\
         \n\
         1e400,0,0,-5e-324,0,0,1e-300, z \n\
         inf,0,1e300,0,0,-3e300,0,far",
    );
    let fields = |row: &Row| ["id", "hit", "t", "z", "object"].map(|name| row[name].clone());
    assert_eq!(
        fields(&found[0]),
        ["x, y", "1", "1.0", "-1.0", "a \"b\", c"]
    );
    // −5e-324 takes t = 1/5e-324 to the sphere's far side: beyond f64, so no hit is told.
    assert_eq!(fields(&found[1]), ["z", "0", "", "", ""]);
    assert_eq!(fields(&found[2]), ["far", "1", "3.0", "0.0", "a \"b\", c"]);
}

#[test]
fn limits_are_open_but_for_zero() {
    // The sphere is met at t = 2 and 4 from outside, at 0 and 2 from its surface.
    let found = Scene::sphere().trace(
        "ox,oy,oz,dx,dy,dz,tmin,tmax\n\
         0,0,3,0,0,-1,2,inf\n\
         0,0,3,0,0,-1,1.9999999999999998,inf\n\
         0,0,3,0,0,-1,0,2\n\
         0,0,3,0,0,-1,0,2.0000000000000004\n\
         0,0,1,0,0,-1,0,inf\n\
         0,0,1,0,0,-1,5e-324,inf\n\
         0,0,1,0,0,1,0,inf\n\
         0,0,1,0,0,1,5e-324,inf\n\
         0,0,-3,0,0,-1,-3,0",
    );
    let t: Vec<&str> = found.iter().map(|row| row["t"].as_str()).collect();
    assert_eq!(
        t,
        ["4.0", "2.0", "", "2.0", "0.0", "2.0", "0.0", "", "-2.0"]
    );
    let id: Vec<&str> = found.iter().map(|row| row["id"].as_str()).collect();
    assert_eq!(id, ["0", "1", "2", "3", "4", "5", "6", "7", "8"]);
}

#[test]
fn opaque_comes_before_glass_and_then_the_lower_index() {
    let sphere =
        |material: &str, name: &str| object("\"sphere\"", material, &format!("name = \"{name}\""));
    let ray = "ox,oy,oz,dx,dy,dz\n1e-3,2e-3,3,0,1e-3,-1";
    let first = |objects: &[String]| Scene::new(objects).trace(ray)[0]["object"].clone();
    let (glass, wall) = (sphere("glass", "glass"), sphere("opaque", "wall"));
    assert_eq!(first(&[glass.clone(), wall.clone()]), "wall");
    assert_eq!(first(&[glass, sphere("glass", "second")]), "glass");
    assert_eq!(first(&[wall, sphere("opaque", "second")]), "wall");
}

#[test]
fn rows_keep_their_order_over_many_batches() {
    // t = 1 + i/1024 without rounding.
    let count = 5000;
    let mut rays = "ox,oy,oz,dx,dy,dz".to_owned();
    for i in 0..count {
        write!(rays, "\n0,0,{:?},0,0,-1", 2.0 + f64::from(i) / 1024.0).unwrap();
    }
    let found = Scene::sphere().trace(&rays);
    assert_eq!(found.len(), count as usize);
    for (i, row) in (0..count).zip(&found) {
        assert_eq!(row["id"], i.to_string());
        assert_eq!(number(row, "t"), 1.0 + f64::from(i) / 1024.0);
    }
}

#[test]
fn implicit_surfaces_have_their_known_roots() {
    let surface = |name: &str| object(&format!("{{ implicit = \"{name}\" }}"), "opaque", "");
    let rays = "ox,oy,oz,dx,dy,dz\n-3,0,0,1,0,0\n-1.4,0,0,2,0,0\n0,-4,0,0,2,0";
    let mitchell = Scene::new(&[surface("mitchell")]).trace(rays);
    // On the x axis 4x⁴ − 20x² + 17 = 0, at x² = (5 ± √8)/2; the field is positive between ±inner.
    // On the y axis 4y⁴ − 20y² + 17 is the same.
    let [outer, inner] = [1.0, -1.0].map(|sign: f64| ((5.0 + sign * 8.0_f64.sqrt()) / 2.0).sqrt());
    // The field near the root is known to some 8 rounding errors of its largest term, 80, and has
    // a slope of 45 or more; the closed form is known to as much.
    let tolerance = 1e-13;
    let wanted = [3.0 - outer, (1.4 - inner) / 2.0, (4.0 - outer) / 2.0];
    for (row, wanted) in mitchell.iter().zip(wanted) {
        assert!((number(row, "t") - wanted).abs() < tolerance, "{row:?}");
    }
    // The outward normal points out of the solid, which lies between the two.
    let normals: Vec<&str> = mitchell.iter().map(|row| row["nx"].as_str()).collect();
    assert_eq!(normals[..2], ["-1.0", "1.0"]);

    let heart = Scene::new(&[surface("heart")]).trace(rays);
    // (x² − 1)³ on the x axis: a triple root where the gradient vanishes. The surface is smooth
    // there: x² + 9/4 y² + z² − 1 = (x² + 9/80 y²)^⅓ z, of gradient (−2, 0, −1). The rule looks
    // beside the point at distances from 2⁻²⁶ of the box's size 3, so 2e-7 covers the curvature.
    assert_eq!(heart[0]["t"], "2.0");
    for (key, component) in [("nx", -2.0), ("ny", 0.0), ("nz", -1.0)] {
        let wanted = component / 5.0_f64.sqrt();
        assert!(
            (number(&heart[0], key) - wanted).abs() < 2e-7,
            "{:?}",
            heart[0]
        );
    }
    // (9/4 y² − 1)³ on the y axis: the cube of a rounded difference keeps its sign, and the
    // difference has the wrong sign for y within a few units of rounding only.
    assert!((number(&heart[2], "t") - 5.0 / 3.0).abs() < 1e-15);
}

#[test]
fn implicit_surfaces_move_with_their_matrix() {
    // Entries are powers of two and rays short in binary: both scenes see the same local ray.
    let implicit = "{ implicit = \"heart\" }";
    let plain = Scene::new(&[object(implicit, "opaque", "")]);
    let matrix = "transform = [{ matrix = [[0, 4, 0, 8], [0.5, 0, 0, -2], [0, 0, -2, 1]] }]";
    let moved = Scene::new(&[
        object(implicit, "opaque", matrix),
        object(
            "{ plane = {} }",
            "opaque",
            "transform = [{ translate = [0, 0, 64] }]",
        ),
    ]);
    let heading = "ox,oy,oz,dx,dy,dz\n";
    let here = plain.trace(&format!("{heading}0.25,0.125,3,0.0625,0,-1\n3,3,3,0,1,-1"));
    let there = moved.trace(&format!(
        "{heading}8.5,-1.875,-5,0,0.03125,2\n20,-0.5,-5,4,0,2"
    ));
    assert_eq!(here[0]["hit"], "1");
    assert_eq!(here[0]["t"], there[0]["t"]);
    assert_eq!(
        (here[1]["hit"].as_str(), there[1]["object"].as_str()),
        ("0", "plane #1")
    );
    // Normals go by the inverse transpose: (n_y/4, 2 n_x, −n_z/2).
    let [x, y, z] = ["nx", "ny", "nz"].map(|name| number(&here[0], name));
    let image = glam::DVec3::new(y / 4.0, 2.0 * x, -z / 2.0).normalize();
    let found = ["nx", "ny", "nz"].map(|name| number(&there[0], name));
    // Two normalisations, a few units of rounding each.
    assert!((glam::DVec3::from_array(found) - image).abs().max_element() < 1e-15);
}

#[test]
fn the_summary_goes_to_stderr_unless_quiet() {
    let scene = Scene::sphere();
    let rays = "ox,oy,oz,dx,dy,dz,foo\n0,0,3,0,0,-1,1\n0,5,3,0,0,-1,1\n";
    let output = scene.run("trace", &["--rays", "-"], rays);
    assert_eq!(
        text(&output.stderr),
        "note: ignored columns: foo\n\
         2 rays, 1 hits; questions decided in f64: 2, in double-double: 0, exactly: 0\n"
    );
    let output = scene.run("trace", &["--rays", "-", "--quiet"], rays);
    assert_eq!(failure(&output), (Some(0), String::new()));
}

#[test]
fn bad_rays_are_refused_with_their_place() {
    let heading = "ox,oy,oz,dx,dy,dz,tmin,tmax\n";
    let cases = [
        ("", "the column ox is missing\n --> <stdin>:1\n"),
        (
            "ox,oy,oz,dx,dy\n",
            "the column dz is missing\n --> <stdin>:1\n",
        ),
        (
            "ox,ox,oz,dx,dy,dz\n",
            "the column ox occurs twice\n --> <stdin>:1, column ox\n",
        ),
        (
            "0,0,0,1,0,0,0",
            "the line has 7 fields, the heading has 8\n --> <stdin>:3\n",
        ),
        (
            "0,0,1.5.2,1,0,0,0,1",
            "\"1.5.2\" is not a number that can stand here\n --> <stdin>:3, column oz\n",
        ),
        (
            "0,,0,1,0,0,0,1",
            "\"\" is not a number that can stand here\n --> <stdin>:3, column oy\n",
        ),
        (
            "0,0,0,1,nan,0,0,1",
            "\"nan\" is not a number that can stand here\n --> <stdin>:3, column dy\n",
        ),
        (
            "0,0,0,1,1e309,0,0,1",
            "\"1e309\" is not a number that can stand here\n --> <stdin>:3, column dy\n",
        ),
        (
            "0,0,0,-0.0,0,0,0,1",
            "the direction is zero\n --> <stdin>:3, column dx\n",
        ),
        (
            "0,0,0,1,0,0,inf,1",
            "\"inf\" is not a number that can stand here\n --> <stdin>:3, column tmin\n",
        ),
        (
            "0,0,0,1,0,0,0,-inf",
            "\"-inf\" is not a number that can stand here\n --> <stdin>:3, column tmax\n",
        ),
    ];
    let scene = Scene::sphere();
    for (row, message) in cases {
        let is_heading = row.is_empty() || row.starts_with("ox");
        let rays = if is_heading {
            row.to_owned()
        } else {
            format!("{heading}0,0,3,0,0,-1,0,inf\r\n{row}\n0,0,3,0,0,-1,0,inf\n")
        };
        let output = scene.run("trace", &["--rays", "-"], &rays);
        let (code, words) = failure(&output);
        assert_eq!(code, Some(2), "{row}");
        assert!(
            words.starts_with(&format!("error: {message}")),
            "{row}: {words}"
        );
        assert!(words.contains("\n  = expected: "), "{row}: {words}");
        // The good rows before it are there, and none after it.
        let printed = text(&output.stdout).lines().count();
        assert_eq!(printed, if is_heading { 0 } else { 2 }, "{row}");
    }
}

#[test]
fn what_cannot_be_done_ends_with_2() {
    let scene = Scene::sphere();
    let directory = scene.directory.path();
    let cases: [(&[&str], &str); 12] = [
        (
            &["trace", "none.toml", "--rays", "-"],
            "error: cannot read none.toml",
        ),
        (&["trace", ".", "--rays", "-"], "error: . is a directory"),
        (
            &["trace", "scene.toml", "--rays", "none.csv"],
            "error: cannot read none.csv",
        ),
        (
            &["trace", "scene.toml", "--rays", "."],
            "error: cannot read .",
        ),
        (
            &["trace", "scene.toml"],
            "error: the following required arguments",
        ),
        (
            &["trace", "scene.toml", "--rays", "-", "--panel", "a"],
            "error: there is no panel \"a\"",
        ),
        (
            &["trace", "scene.toml", "--rays", "-", "--set", "x"],
            "error: invalid value 'x'",
        ),
        (
            &["trace", "scene.toml", "--rays", "-", "--set", "image.spp=0"],
            "error: image.spp is 0",
        ),
        (
            &["render", "scene.toml", "--nonsense"],
            "error: unexpected argument '--nonsense'",
        ),
        (
            &["render", "scene.toml", "--crop", "3,0,3,4"],
            "error: invalid value '3,0,3,4'",
        ),
        (
            &["render", "scene.toml", "--layers", "depth,deep"],
            "error: invalid value 'deep'",
        ),
        (
            &["paint", "scene.toml"],
            "error: unrecognized subcommand 'paint'",
        ),
    ];
    for (arguments, message) in cases {
        let output = etalon(directory, arguments, "");
        let (code, words) = failure(&output);
        assert_eq!(code, Some(2), "{arguments:?}: {words}");
        assert!(words.starts_with(message), "{arguments:?}: {words}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
}

#[test]
fn options_of_the_image_are_checked_by_the_scene() {
    let scene = Scene::sphere();
    let cases = [
        ("--spp", "0", "image.spp is 0", "image.spp=0"),
        ("--size", "0x4", "image.size[0] is 0", "image.size=[0, 4]"),
        (
            "--max-depth",
            "0",
            "image.max_depth is 0",
            "image.max_depth=0",
        ),
        (
            "--sampler",
            "sobl",
            "image.sampler is \"sobl\"",
            "image.sampler=sobl",
        ),
        (
            "--replicates",
            "65",
            "image.replicates is 65",
            "image.replicates=65",
        ),
        (
            "--precision",
            "f16",
            "image.precision is \"f16\"",
            "image.precision=f16",
        ),
        (
            "--wavelengths",
            "5",
            "image.wavelengths is 5",
            "image.wavelengths=5",
        ),
        ("--seed", "-1", "image.seed is -1", "image.seed=-1"),
    ];
    for (option, value, message, setting) in cases {
        let (code, words) = failure(&scene.run("render", &[option, value], ""));
        assert_eq!(code, Some(2), "{option}");
        assert!(
            words.starts_with(&format!("error: {message}\n")),
            "{option}: {words}"
        );
        assert!(
            words.contains(&format!("| {setting}\n")),
            "{option}: {words}"
        );
    }
}

#[test]
fn help_is_good_and_shows_an_example() {
    for command in ["render", "info", "trace", "replay"] {
        let output = etalon(Path::new("."), &[command, "--help"], "");
        assert_eq!(output.status.code(), Some(0));
        let help = text(&output.stdout);
        assert!(
            help.contains(&format!("etalon {command} scenes/")),
            "{help}"
        );
    }
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let scene = Scene::sphere();
    // More output than any pipe holds.
    let rays = format!("ox,oy,oz,dx,dy,dz\n{}", "0,0,3,0,0,-1\n".repeat(100_000));
    std::fs::write(scene.directory.path().join("rays.csv"), rays).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_etalon"))
        .args(["trace", "scene.toml", "--rays", "rays.csv"])
        .current_dir(scene.directory.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(
        failure(&child.wait_with_output().unwrap()),
        (Some(0), String::new())
    );
}
