//! The binary from outside: exit codes, messages, and rays with known answers.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;

use rayon::prelude::*;

use crate::oracle_support::{Row, number, primitive_fault, rows, table, vector};
use crate::support::{Finished, Folder, cells, words};

const HEAD: &str = "\
camera = { from = [0, 0, 5], to = [0, 0, 0], fov = 40 }
image = { size = [4, 4], spp = 1 }
materials.opaque = { diffuse = 0.5 }
materials.glass = { glass = \"N-BK7\" }
";

fn object(shape: &str, material: &str, rest: &str) -> String {
    format!("[[object]]\nshape = {shape}\nmaterial = \"{material}\"\n{rest}\n")
}

/// A plane across the z axis.
fn plane(z: i32) -> String {
    let transform = format!("transform = [{{ translate = [0, 0, {z}] }}]");
    object("{ plane = {} }", "opaque", &transform)
}

fn scene(objects: &[String]) -> Folder {
    Folder::new(&format!("{HEAD}{}", objects.concat()))
}

fn sphere() -> Folder {
    scene(&[object("\"sphere\"", "opaque", "")])
}

const TRACE: [&str; 4] = ["trace", "scene.toml", "--rays", "-"];

/// The rows that `trace` prints for these rays.
fn trace(folder: &Folder, rays: &str) -> Vec<Row> {
    let said = folder.run_with(&TRACE, rays);
    assert_eq!(said.code, Some(0), "{}", said.err);
    table(&said.out)
}

/// A scene of one canonical shape under one matrix, kept bit for bit.
fn placed(shape: &str, transform: &Row) -> Folder {
    let entry = |i: usize, j: usize| number(transform, &format!("m{i}{j}"));
    let matrix = [0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| entry(i, j)));
    let shape = if shape == "rect" { "rectangle" } else { shape };
    let transform = format!("transform = [{{ matrix = {matrix:?} }}]");
    scene(&[object(&format!("{shape:?}"), "opaque", &transform)])
}

/// What is wrong with the answer to a ray of the oracle.
fn disagreement(want: &Row, found: &Row) -> Option<String> {
    let id = &want["id"];
    if found["id"] != *id {
        return Some(format!("{id}: answered as {}", found["id"]));
    }
    if found["hit"] == "1" {
        let hit = (number(found, "t"), vector(found, ["nx", "ny", "nz"]));
        return primitive_fault(want, Some(hit));
    }
    let values = ["t", "x", "y", "z", "nx", "ny", "nz", "object"];
    if !values.iter().all(|name| found[*name].is_empty()) {
        return Some(format!("{id}: a miss with values"));
    }
    primitive_fault(want, None)
}

#[test]
fn trace_agrees_with_the_oracle_on_every_primitive() {
    let named = |row: Row| (row["transform"].clone(), row);
    let transforms: HashMap<String, Row> = rows("transforms.csv").into_iter().map(named).collect();
    let mut groups: BTreeMap<(String, String), Vec<Row>> = BTreeMap::new();
    for row in rows("primitives.csv") {
        let key = (row["shape"].clone(), row["transform"].clone());
        groups.entry(key).or_default().push(row);
    }
    let columns = ["tmin", "dz", "dy", "dx", "class", "ox", "oy", "oz", "id"];
    let results = groups.par_iter().map(|((shape, transform), wanted)| {
        let mut rays = columns.join(",");
        for row in wanted {
            let fields: Vec<&str> = columns.iter().map(|name| row[*name].as_str()).collect();
            write!(rays, "\n{}", fields.join(",")).unwrap();
        }
        let found = trace(&placed(shape, &transforms[transform]), &rays);
        assert_eq!(found.len(), wanted.len(), "{shape} {transform}");
        let pairs = wanted.iter().zip(&found);
        let wrong = pairs.filter_map(|(want, found)| disagreement(want, found));
        (found.len(), wrong.collect::<Vec<_>>())
    });
    let (counts, wrong): (Vec<usize>, Vec<Vec<String>>) = results.unzip();
    assert_eq!(wrong.concat(), Vec::<String>::new());
    assert_eq!(counts.iter().sum::<usize>(), 3000);
}

#[test]
fn numbers_and_names_go_through_unchanged() {
    let sphere = object("\"sphere\"", "opaque", "name = 'a \"b\", c'");
    let scene = scene(&[sphere, plane(-4)]);
    let found = trace(
        &scene,
        "tmax,dx,dy,dz,ox,oy,oz,id\n\
         inf,-0.0,5e-324,2,-0.0,0,-3,\"x, y\"\r\n\
         \n\
         1e400,0,0,-5e-324,0,0,1e-300, z \n\
         inf,0,1e300,0,0,-3e300,0,far",
    );
    let fields = |row: &Row| ["id", "hit", "t", "z", "object"].map(|name| row[name].clone());
    let name = "a \"b\", c";
    assert_eq!(fields(&found[0]), ["x, y", "1", "1.0", "-1.0", name]);
    // −5e-324 takes t = 1/5e-324 to the sphere's far side: beyond f64, so no hit is told.
    assert_eq!(fields(&found[1]), ["z", "0", "", "", ""]);
    assert_eq!(fields(&found[2]), ["far", "1", "3.0", "0.0", name]);
}

#[test]
fn limits_are_open_but_for_zero() {
    // The sphere is met at t = 2 and 4 from outside, at 0 and 2 from its surface.
    let found = trace(
        &sphere(),
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
    let wanted = ["4.0", "2.0", "", "2.0", "0.0", "2.0", "0.0", "", "-2.0"];
    assert_eq!(t, wanted);
    let id: Vec<&str> = found.iter().map(|row| row["id"].as_str()).collect();
    assert_eq!(id, ["0", "1", "2", "3", "4", "5", "6", "7", "8"]);
}

#[test]
fn opaque_comes_before_glass_and_then_the_lower_index() {
    let sphere = |material, name| object("\"sphere\"", material, &format!("name = {name:?}"));
    let ray = "ox,oy,oz,dx,dy,dz\n1e-3,2e-3,3,0,1e-3,-1";
    let first = |objects: &[String]| trace(&scene(objects), ray)[0]["object"].clone();
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
    let found = trace(&sphere(), &rays);
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
    let mitchell = trace(&scene(&[surface("mitchell")]), rays);
    // On the x axis 4x⁴ − 20x² + 17 = 0, at x² = (5 ± √8)/2; the field is positive between ±inner.
    // On the y axis 4y⁴ − 20y² + 17 is the same.
    let [outer, inner] = [1.0, -1.0].map(|sign: f64| ((5.0 + sign * 8.0_f64.sqrt()) / 2.0).sqrt());
    let wanted = [3.0 - outer, (1.4 - inner) / 2.0, (4.0 - outer) / 2.0];
    for (row, wanted) in mitchell.iter().zip(wanted) {
        // The field near the root is known to some 8 rounding errors of its largest term, 80, and has
        // a slope of 45 or more; the closed form is known to as much.
        assert!((number(row, "t") - wanted).abs() < 1e-13, "{row:?}");
    }
    // The outward normal points out of the solid, which lies between the two.
    assert_eq!([0, 1].map(|i| &mitchell[i]["nx"]), ["-1.0", "1.0"]);

    let heart = trace(&scene(&[surface("heart")]), rays);
    // (x² − 1)³ on the x axis: a triple root where the gradient vanishes. The surface is smooth
    // there: x² + 9/4 y² + z² − 1 = (x² + 9/80 y²)^⅓ z, of gradient (−2, 0, −1). The rule looks
    // beside the point at distances from 2⁻²⁶ of the box's size 3, so 2e-7 covers the curvature.
    assert_eq!(heart[0]["t"], "2.0");
    for (key, component) in [("nx", -2.0), ("ny", 0.0), ("nz", -1.0)] {
        let off = number(&heart[0], key) - component / 5.0_f64.sqrt();
        assert!(off.abs() < 2e-7, "{:?}", heart[0]);
    }
    // (9/4 y² − 1)³ on the y axis: the cube of a rounded difference keeps its sign, and the
    // difference has the wrong sign for y within a few units of rounding only.
    assert!((number(&heart[2], "t") - 5.0 / 3.0).abs() < 1e-15);
}

#[test]
fn implicit_surfaces_move_with_their_matrix() {
    // Entries are powers of two and rays short in binary: both scenes see the same local ray.
    let implicit = "{ implicit = \"heart\" }";
    let plain = scene(&[object(implicit, "opaque", "")]);
    let matrix = "transform = [{ matrix = [[0, 4, 0, 8], [0.5, 0, 0, -2], [0, 0, -2, 1]] }]";
    let moved = scene(&[object(implicit, "opaque", matrix), plane(64)]);
    let asked = |scene, rays: &str| trace(scene, &format!("ox,oy,oz,dx,dy,dz\n{rays}"));
    let here = asked(&plain, "0.25,0.125,3,0.0625,0,-1\n3,3,3,0,1,-1");
    let there = asked(&moved, "8.5,-1.875,-5,0,0.03125,2\n20,-0.5,-5,4,0,2");
    assert_eq!(here[0]["hit"], "1");
    assert_eq!(here[0]["t"], there[0]["t"]);
    assert_eq!(here[1]["hit"], "0");
    assert_eq!(there[1]["object"], "plane #1");
    // Normals go by the inverse transpose: (n_y/4, 2 n_x, −n_z/2).
    let [here, there] = [&here, &there].map(|rows| vector(&rows[0], ["nx", "ny", "nz"]));
    let image = glam::DVec3::new(here.y / 4.0, 2.0 * here.x, -here.z / 2.0).normalize();
    // Two normalisations, a few units of rounding each.
    assert!((there - image).abs().max_element() < 1e-15);
}

#[test]
fn the_summary_goes_to_stderr_unless_quiet() {
    let scene = sphere();
    let rays = "ox,oy,oz,dx,dy,dz,foo\n0,0,3,0,0,-1,1\n0,5,3,0,0,-1,1\n";
    assert_eq!(
        scene.run_with(&TRACE, rays).err,
        "note: ignored columns: foo\n\
         2 rays, 1 hits; questions decided in f64: 2, in double-double: 0, exactly: 0\n"
    );
    let said = scene.run_with(&words("trace scene.toml --rays - --quiet"), rays);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
}

#[test]
fn bad_rays_are_refused_with_their_place() {
    let heading = "ox,oy,oz,dx,dy,dz,tmin,tmax\n";
    // A heading or a row, the message, and the place.
    let cases = r#"
        | the column ox is missing | :1
        ox,oy,oz,dx,dy | the column dz is missing | :1
        ox,ox,oz,dx,dy,dz | the column ox occurs twice | :1, column ox
        0,0,0,1,0,0,0 | the line has 7 fields, the heading has 8 | :3
        0,0,1.5.2,1,0,0,0,1 | "1.5.2" is not a number that can stand here | :3, column oz
        0,,0,1,0,0,0,1 | "" is not a number that can stand here | :3, column oy
        0,0,0,1,nan,0,0,1 | "nan" is not a number that can stand here | :3, column dy
        0,0,0,1,1e309,0,0,1 | "1e309" is not a number that can stand here | :3, column dy
        0,0,0,-0.0,0,0,0,1 | the direction is zero | :3, column dx
        0,0,0,1,0,0,inf,1 | "inf" is not a number that can stand here | :3, column tmin
        0,0,0,1,0,0,0,-inf | "-inf" is not a number that can stand here | :3, column tmax"#;
    let scene = sphere();
    for [row, message, place] in cells(cases) {
        let is_heading = row.is_empty() || row.starts_with("ox");
        let rays = match is_heading {
            true => row.to_owned(),
            false => format!("{heading}0,0,3,0,0,-1,0,inf\r\n{row}\n0,0,3,0,0,-1,0,inf\n"),
        };
        let said = scene.run_with(&TRACE, &rays);
        assert_eq!(said.code, Some(2), "{row}");
        let beginning = format!("error: {message}\n --> <stdin>{place}\n");
        assert!(said.err.starts_with(&beginning), "{row}: {}", said.err);
        assert!(said.err.contains("\n  = expected: "), "{row}: {}", said.err);
        // The good rows before it are there, and none after it.
        let printed = said.out.lines().count();
        assert_eq!(printed, if is_heading { 0 } else { 2 }, "{row}");
    }
}

#[test]
fn what_cannot_be_done_ends_with_2() {
    let scene = sphere();
    let cases = "
        trace none.toml --rays - | cannot read none.toml
        trace . --rays - | . is a directory
        trace scene.toml --rays none.csv | cannot read none.csv
        trace scene.toml --rays . | cannot read .
        trace scene.toml | the following required arguments
        trace scene.toml --rays - --panel a | there is no panel \"a\"
        trace scene.toml --rays - --set x | invalid value 'x'
        trace scene.toml --rays - --set image.spp=0 | image.spp is 0
        render scene.toml --nonsense | unexpected argument '--nonsense'
        render scene.toml --crop 3,0,3,4 | invalid value '3,0,3,4'
        render scene.toml --layers depth,deep | invalid value 'deep'
        paint scene.toml | unrecognized subcommand 'paint'";
    for [arguments, message] in cells(cases) {
        let message = format!("error: {message}");
        let said = scene.refused(&words(arguments));
        assert!(said.starts_with(&message), "{arguments}: {said}");
    }
}

#[test]
fn options_of_the_image_are_checked_by_the_scene() {
    let scene = sphere();
    for (option, value, message, setting) in [
        ("spp", "0", "spp is 0", "spp=0"),
        ("size", "0x4", "size[0] is 0", "size=[0, 4]"),
        ("max-depth", "0", "max_depth is 0", "max_depth=0"),
        ("sampler", "sobl", "sampler is \"sobl\"", "sampler=sobl"),
        ("replicates", "65", "replicates is 65", "replicates=65"),
        ("precision", "f16", "precision is \"f16\"", "precision=f16"),
        ("wavelengths", "5", "wavelengths is 5", "wavelengths=5"),
        ("seed", "-1", "seed is -1", "seed=-1"),
    ] {
        let said = scene.refused(&["render", "scene.toml", &format!("--{option}"), value]);
        let message = format!("error: image.{message}\n");
        assert!(said.starts_with(&message), "{option}: {said}");
        let setting = format!("| image.{setting}\n");
        assert!(said.contains(&setting), "{option}: {said}");
    }
}

#[test]
fn help_is_good_and_shows_an_example() {
    for command in ["render", "info", "trace", "replay"] {
        let help = Folder::empty().done(&[command, "--help"]);
        let example = format!("etalon {command} scenes/");
        assert!(help.contains(&example), "{help}");
    }
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let scene = sphere();
    // More output than any pipe holds.
    let rays = format!("ox,oy,oz,dx,dy,dz\n{}", "0,0,3,0,0,-1\n".repeat(100_000));
    scene.write("rays.csv", rays);
    let arguments = ["trace", "scene.toml", "--rays", "rays.csv"];
    let mut child = scene.command(&arguments).spawn().unwrap();
    drop(child.stdout.take());
    let said = Finished::from(child.wait_with_output().unwrap());
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
}
