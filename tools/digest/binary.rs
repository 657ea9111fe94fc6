//! Asks an etalon for pictures.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use etalon::Picture;
use tempfile::TempDir;

/// Every instruction set that some etalon knows.
const SETS: [&str; 4] = ["avx512", "avx2", "sse2", "neon"];
/// The scene that each instruction set is tried with.
const SMALLEST: &str = "scenes/spheres.toml";
/// What etalon's exit code says where an instruction set is missing.
const COULD_NOT: i32 = 2;

/// An etalon, and a folder for its pictures.
pub struct Binary {
    path: PathBuf,
    root: PathBuf,
    folder: TempDir,
    /// The instruction sets that it has on this machine.
    pub sets: Vec<&'static str>,
}

impl Binary {
    /// The etalon at `path`, which reads scenes under `root`.
    pub fn new(path: &Path, root: &Path) -> Result<Self, String> {
        let path = std::path::absolute(path);
        let mut binary = Self {
            path: path.map_err(|reason| reason.to_string())?,
            root: root.to_owned(),
            folder: tempfile::tempdir().map_err(|reason| reason.to_string())?,
            sets: Vec::new(),
        };
        for set in SETS {
            let arguments = [SMALLEST, "--crop", "0,0,1,1", "--instructions", set];
            let arguments = arguments.map(str::to_owned);
            let output = binary.run(&arguments, &binary.folder.path().join("tried.exr"))?;
            if output.status.success() {
                binary.sets.push(set);
            } else if output.status.code() != Some(COULD_NOT) {
                return Err(failure(&arguments, &output));
            }
        }
        if binary.sets.is_empty() {
            return Err("no instruction set works".to_owned());
        }
        Ok(binary)
    }

    /// What `etalon render` makes of these arguments.
    pub fn render(&self, arguments: &[String]) -> Result<Picture, String> {
        let failed = |reason: std::io::Error| reason.to_string();
        let folder = tempfile::tempdir_in(self.folder.path()).map_err(failed)?;
        let file = folder.path().join("picture.exr");
        let output = self.run(arguments, &file)?;
        if !output.status.success() {
            return Err(failure(arguments, &output));
        }
        Picture::read(&file).map_err(|reason| reason.to_string())
    }

    fn run(&self, arguments: &[String], file: &Path) -> Result<Output, String> {
        // One thread each, as many run side by side; bits do not depend on it.
        Command::new(&self.path)
            .current_dir(&self.root)
            .args(["render", "--quiet", "--threads", "1", "--output"])
            .arg(file)
            .args(arguments)
            .output()
            .map_err(|reason| format!("{}: {reason}", self.path.display()))
    }
}

fn failure(arguments: &[String], output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr);
    let arguments = arguments.join(" ");
    format!("etalon render {arguments}: {}: {said}", output.status)
}
