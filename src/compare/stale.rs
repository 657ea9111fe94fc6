//! Whether the scene that a picture was made from is still the same.

use std::path::{Path, PathBuf};

use super::Side;
use crate::film::hash;
use crate::scene;

/// The state of the scene file that a picture names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Freshness {
    /// The picture does not name its scene.
    Unknown,
    /// The scene file is not there, or cannot be read.
    Missing(PathBuf),
    /// The scene file is the one that the picture was made from.
    Fresh,
    /// The scene file has changed since the picture was rendered.
    Stale(PathBuf),
}

/// Looks for the scene file of a picture, relative to `root`.
pub fn freshness(side: &Side, root: &Path) -> Freshness {
    let (Some(file), Some(recorded)) = (side.text("sceneFile"), side.text("sceneHash")) else {
        return Freshness::Unknown;
    };
    let path = root.join(file);
    match scene::read(&path) {
        Ok(text) if hash(&text) == recorded => Freshness::Fresh,
        Ok(_) => Freshness::Stale(path),
        Err(_) => Freshness::Missing(path),
    }
}

/// How the scenes or panels of two pictures differ; `None` where nothing that both record does.
pub fn different_scenes(a: &Side, b: &Side) -> Option<String> {
    let differs = |name: &str| match (a.text(name), b.text(name)) {
        (Some(own), Some(others)) => own != others,
        _ => false,
    };
    if differs("sceneHash") {
        return Some(format!(
            "{} and {} are not of the same scene file: the texts they were made from differ",
            a.path.display(),
            b.path.display()
        ));
    }
    let panel = |side: &Side| side.text("panel").unwrap_or("none").to_owned();
    let both = [a, b].iter().all(|side| side.text("sceneHash").is_some());
    (both && panel(a) != panel(b)).then(|| {
        format!(
            "{} is of panel {} and {} of panel {}",
            a.path.display(),
            panel(a),
            b.path.display(),
            panel(b)
        )
    })
}
