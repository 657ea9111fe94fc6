//! `etalon-method finders` from outside: what it writes, what it answers, what it refuses.

#![allow(
    clippy::unwrap_used,
    reason = "a test that cannot go on has failed, and the panic says where"
)]

use std::process::{Command, Output};

use tempfile::TempDir;

/// A ball of radius 1 and three rays: through it, past it, and from inside.
const SHAPES: &str = "name;half_width;degree;expression\nball;2;2;x^2+y^2+z^2-R, R=1\n";
const RAYS: &str = "shape,class,ox,oy,oz,dx,dy,dz,tmin,hit,t,gap\n\
                    ball,ordinary,-3,0,0,1,0,0,0,1,2,2\n\
                    ball,ordinary,-3,0,1.5,1,0,0,0,0,,\n\
                    ball,axis,0,0,0,0,1,0,0,1,1,\n";

struct Folder(TempDir);

impl Folder {
    /// A folder with rays and shapes.
    fn new(rays: &str, shapes: &str) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        std::fs::write(folder.0.path().join("rays.csv"), rays).unwrap();
        std::fs::write(folder.0.path().join("shapes.csv"), shapes).unwrap();
        folder
    }

    fn finders(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_etalon-method"))
            .current_dir(self.0.path())
            .args(["finders", "--quiet", "-o", "out"])
            .args(arguments)
            .output()
            .unwrap()
    }

    /// Over the folder's own rays.
    fn own(&self) -> Output {
        self.finders(&["--rays", "rays.csv", "--shapes", "shapes.csv"])
    }

    fn text(&self, file: &str) -> String {
        std::fs::read_to_string(self.0.path().join("out").join(file)).unwrap()
    }
}

fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr.clone()).unwrap();
    assert!(message.starts_with("error: "), "{message}");
    message
}

/// Columns of the table's lines of a finder and class.
fn line(table: &str, finder: &str, class: &str) -> Vec<String> {
    let fields = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let mut lines = table.lines().map(fields);
    lines.find(|f| f[0] == finder && f[3] == class).unwrap()
}

#[test]
fn rays_are_scored_by_finder_and_class() {
    let folder = Folder::new(RAYS, SHAPES);
    assert_eq!(folder.own().status.code(), Some(0));
    let table = folder.text("finders.csv");
    // Twelve contestants, seven classes and all together.
    assert_eq!(table.lines().count(), 1 + 12 * 8);
    for (class, rays) in [("ordinary", "2"), ("axis", "1"), ("far", "0"), ("all", "3")] {
        assert_eq!(line(&table, "auto", class)[4..7], [rays, "0", "0"]);
    }
    assert!(folder.text("finders.svg").starts_with("<svg"));
}

#[test]
fn a_proof_that_is_wrong_is_answered_by_no() {
    let folder = Folder::new(&RAYS.replace("0,1,2,2\n", "0,1,2.5,2\n"), SHAPES);
    assert_eq!(folder.own().status.code(), Some(1));
    let table = folder.text("finders.csv");
    assert_eq!(line(&table, "interval", "ordinary")[5], "1");
}

#[test]
fn a_map_counts_the_pixels_of_each_finder() {
    let folder = Folder::new("", "");
    let output = folder.finders(&["--map", "torus", "--size", "16"]);
    assert_eq!(output.status.code(), Some(0));
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(said.lines().count(), 1 + 12, "{said}");
    assert!(said.contains("\nauto,f64,,0,0\n"), "{said}");
    let picture = std::fs::read(folder.0.path().join("out/finders-torus.png")).unwrap();
    assert_eq!(&picture[1..4], b"PNG");
}

#[test]
fn what_cannot_be_done_is_said() {
    let folder = Folder::new(RAYS, SHAPES);
    let message = refused(&folder.finders(&["--map", "nowhere"]));
    assert!(
        message.contains("\"nowhere\"") && message.contains("heart"),
        "{message}"
    );
    assert!(refused(&folder.finders(&["--rays", "none.csv"])).contains("none.csv"));
    refused(&folder.finders(&["--failures", "--map", "heart"]));
    let rays = |rays: &str| refused(&Folder::new(rays, SHAPES).own());
    assert!(rays(&RAYS.replace("gap", "distance")).contains("no column \"gap\""));
    assert!(rays(&RAYS.replace("ball,axis", "cube,axis")).contains("line 4: no shape"));
    assert!(rays(RAYS.lines().next().unwrap()).contains("no rays"));
    let shapes = |shapes: &str| refused(&Folder::new(RAYS, shapes).own());
    assert!(shapes(&SHAPES.replace(";2;2;", ";2;")).contains("line 2"));
    assert!(shapes(&SHAPES.replace(";2;2;", ";-2;2;")).contains("not positive"));
}
