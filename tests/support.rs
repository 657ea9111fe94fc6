//! What many tests need: the program in a folder of its own, pictures as bits, small scenes, rays.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Arc;

use etalon::inside::field::expression::Expression;
use etalon::inside::film::exr;
use etalon::inside::render::session::{Request, Unwatched, render};
use etalon::inside::scene::{FinderChoice, Implicit};
use etalon::inside::shape::{Query, Ray};
use etalon::{Attribute, Picture, Plan, Rendered, Scene, Values};
use glam::DVec3;
use tempfile::TempDir;

/// A folder of its own, in which the program runs.
pub struct Folder(TempDir);

/// The exit code of a run that is over, and what it wrote to stdout and stderr.
#[derive(Debug)]
pub struct Finished {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl From<Output> for Finished {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Folder {
    pub fn empty() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// With a scene file, `scene.toml`.
    pub fn new(scene: &str) -> Self {
        let folder = Self::empty();
        folder.write("scene.toml", scene);
        folder
    }

    pub fn path(&self, file: &str) -> PathBuf {
        self.0.path().join(file)
    }

    pub fn write(&self, file: &str, contents: impl AsRef<[u8]>) {
        std::fs::write(self.path(file), contents).unwrap();
    }

    pub fn text(&self, file: &str) -> String {
        std::fs::read_to_string(self.path(file)).unwrap()
    }

    pub fn picture(&self, file: &str) -> Picture {
        exr::read(&self.path(file)).unwrap()
    }

    pub fn files(&self) -> BTreeSet<String> {
        files(self.0.path())
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut process = Command::new(env!("CARGO_BIN_EXE_etalon"));
        process.current_dir(self.0.path()).args(arguments);
        process
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        process
    }

    pub fn run(&self, arguments: &[&str]) -> Finished {
        self.command(arguments).output().unwrap().into()
    }

    /// With something on its standard input.
    pub fn run_with(&self, arguments: &[&str], input: &str) -> Finished {
        let mut command = self.command(arguments);
        let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        std::thread::scope(|scope| {
            // A command that needs no input may be gone before it is written.
            scope.spawn(move || stdin.write_all(input.as_bytes()).ok());
            child.wait_with_output().unwrap().into()
        })
    }

    /// What a command says that is carried out.
    #[track_caller]
    pub fn done(&self, arguments: &[&str]) -> String {
        let said = self.run(arguments);
        assert_eq!(said.code, Some(0), "{arguments:?}: {}", said.err);
        said.out
    }

    /// The message of a command that is refused, which prints nothing else and touches no file.
    #[track_caller]
    pub fn refused(&self, arguments: &[&str]) -> String {
        let before = self.files();
        let said = self.run(arguments);
        assert_eq!(said.code, Some(2), "{arguments:?}: {said:?}");
        assert_eq!(said.out, "", "{arguments:?}");
        assert_eq!(self.files(), before, "{arguments:?}");
        assert!(said.err.starts_with("error: "), "{}", said.err);
        said.err
    }
}

/// The words of a command, none of which has a space.
pub fn words(command: &str) -> Vec<&str> {
    command.split(' ').collect()
}

/// The lines of a table, each of N cells with bars between them.
pub fn cells<const N: usize>(table: &str) -> impl Iterator<Item = [&str; N]> {
    table.trim().lines().map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        cells.try_into().unwrap()
    })
}

/// The names of the files in a folder.
pub fn files(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect()
}

/// Whether all of these words are in a text.
#[track_caller]
pub fn assert_says(text: &str, words: &[&str]) {
    for part in words {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

/// The values of a channel as bits, since NaN does not equal itself.
pub fn value_bits(values: &Values) -> Vec<u32> {
    match values {
        Values::F32(values) => values.iter().map(|value| value.to_bits()).collect(),
        Values::U32(values) => values.clone(),
    }
}

/// A channel's values.
pub fn wide(picture: &Picture, channel: &str) -> Vec<f64> {
    let values = picture.floats(channel).unwrap();
    values.iter().map(|&value| f64::from(value)).collect()
}

/// An attribute that is a text.
#[track_caller]
pub fn attribute<'a>(picture: &'a Picture, name: &str) -> &'a str {
    match picture.attribute(name) {
        Some(Attribute::Text(text)) => text,
        other => panic!("{name} is {other:?}"),
    }
}

/// A scene's picture by a plan, without a number that is none.
pub fn rendered(scene: &Scene, plan: &Plan) -> Rendered {
    let request = Request::whole(scene.image.size, scene.image.spp);
    let rendered = render(plan, &request, &mut Unwatched);
    assert_eq!(rendered.not_a_number, 0);
    rendered
}

/// The bits of every pixel's X, Y, Z and of their standard errors.
pub fn pixel_bits(rendered: &Rendered) -> Vec<[[u64; 3]; 2]> {
    let bits = |xyz: [f64; 3]| xyz.map(f64::to_bits);
    let pixels = rendered.xyz().into_iter();
    pixels
        .map(|e| [e.mean, e.standard_error].map(bits))
        .collect()
}

/// A question about the first hit with t ≥ 0.
pub fn from_zero(origin: DVec3, direction: DVec3) -> Query {
    Query {
        ray: ray(origin, direction),
        t_min: 0.0,
        t_max: f64::INFINITY,
    }
}

/// An object of a scene file; shape and transforms as they are written.
pub fn object(shape: &str, material: &str, transform: &str) -> String {
    format!("[[object]]\nshape = {shape}\nmaterial = \"{material}\"\ntransform = [{transform}]\n")
}

pub fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction }
}

/// The cube [−half, half]³ by its corners.
pub fn cube(half: f64) -> [DVec3; 2] {
    [DVec3::splat(-half), DVec3::splat(half)]
}

/// A surface within the cube [−half, half]³.
pub fn implicit(field: impl Into<Arc<Expression>>, half: f64, finder: FinderChoice) -> Implicit {
    Implicit {
        name: None,
        field: field.into(),
        inside: cube(half),
        closed: false,
        finder,
        steps: 256,
    }
}
