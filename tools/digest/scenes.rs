//! Which scenes there are, with their panels.

use std::path::Path;

use etalon::{Overrides, Scene, SceneError};

/// Folders of scene files, from the root of the project.
const FOLDERS: [&str; 3] = ["scenes", "scenes/validation", "tools/digest/scenes"];

/// A scene file with one of its panels, or without.
#[derive(Debug)]
pub struct Variant {
    /// Path of the file from the root of the project, with slashes.
    pub scene: String,
    /// The panel; `None` is the file's own scene.
    pub panel: Option<String>,
    /// Width and height of its picture, pixels.
    pub size: [u32; 2],
}

impl Variant {
    /// What asks for it on the command line.
    pub fn arguments(&self) -> Vec<String> {
        let panel = self.panel.iter().cloned();
        let panel = panel.flat_map(|name| ["--panel".to_owned(), name]);
        [self.scene.clone()].into_iter().chain(panel).collect()
    }

    /// What a table calls it: scene and panel.
    pub fn key(&self) -> [String; 2] {
        [self.scene.clone(), self.panel.clone().unwrap_or_default()]
    }
}

/// The variants of all scenes that are wanted by their keys; a file's own scene is one of them.
pub fn variants(root: &Path, wanted: impl Fn(&[String]) -> bool) -> Result<Vec<Variant>, String> {
    let mut all = Vec::new();
    for folder in FOLDERS {
        let path = root.join(folder);
        let failed = |reason| format!("{}: {reason}", path.display());
        for entry in std::fs::read_dir(&path).map_err(failed)? {
            let file = entry.map_err(failed)?.file_name();
            let scene = format!("{folder}/{}", file.display());
            if scene.ends_with(".toml") {
                all.extend(panels(root, &scene).map_err(|reason| reason.to_string())?);
            }
        }
    }
    all.retain(|variant| wanted(&variant.key()));
    if all.is_empty() {
        return Err("there is no such scene".to_owned());
    }
    Ok(all)
}

fn panels(root: &Path, scene: &str) -> Result<Vec<Variant>, SceneError> {
    let path = root.join(scene);
    let names = Scene::panels(&path)?;
    let names = [None].into_iter().chain(names.into_iter().map(Some));
    let variant = |panel: Option<String>| {
        let options = Overrides {
            panel: panel.clone(),
            ..Overrides::default()
        };
        let size = Scene::load_with(&path, &options)?.image.size;
        Ok(Variant {
            scene: scene.to_owned(),
            panel,
            size,
        })
    };
    names.map(variant).collect()
}
