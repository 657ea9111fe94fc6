//! What a study was asked to do, kept beside its table, so that it can be taken up again and
//! nothing else be mixed into it.

use std::path::{Path, PathBuf};

use toml_edit::{Array, DocumentMut, Item, Table, value};

use super::axis::Axis;
use super::grid::Grid;

/// A study's request and the grid it led to.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Names and values of what was asked for.
    pub request: Vec<(String, String)>,
    pub grid: Grid,
    /// The command that asked for it.
    pub command: String,
}

/// Why a study cannot be taken up.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The file cannot be read or written.
    #[error("cannot use {}: {reason}", path.display())]
    File { path: PathBuf, reason: String },
    /// It is of another study.
    #[error(
        "{} is of another study: {key} is {found} there and {wanted} here; choose another directory with -o, \
         or remove that one", path.display()
    )]
    Other {
        path: PathBuf,
        /// What differs.
        key: String,
        /// Its value in the file.
        found: String,
        /// The value now.
        wanted: String,
    },
}

impl Record {
    /// The record as TOML.
    pub fn text(&self) -> String {
        let mut document = DocumentMut::new();
        document["command"] = value(self.command.as_str());
        let mut request = Table::new();
        for (key, said) in &self.request {
            request[key.as_str()] = value(said.as_str());
        }
        document["request"] = Item::Table(request);
        let mut grid = Table::new();
        grid["abscissa"] = value(self.grid.abscissa.to_string());
        let others: Array = self.grid.others.iter().map(Axis::to_string).collect();
        grid["curves"] = value(others);
        document["grid"] = Item::Table(grid);
        document.to_string()
    }

    /// The grid of the study that a file records, if it is the one requested; `None` where there
    /// is no file.
    ///
    /// # Errors
    /// [`RecordError::Other`] where it is of another study.
    pub fn resume(path: &Path, request: &[(String, String)]) -> Result<Option<Grid>, RecordError> {
        let broken = |reason: String| RecordError::File {
            path: path.to_owned(),
            reason,
        };
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(broken(error.to_string())),
        };
        let document: DocumentMut = text.parse().map_err(|e| broken(format!("{e}")))?;
        for (key, wanted) in request {
            let found = document["request"].get(key).and_then(Item::as_str);
            let found = found.unwrap_or_default();
            if found != wanted {
                return Err(RecordError::Other {
                    path: path.to_owned(),
                    key: key.clone(),
                    found: quoted(found),
                    wanted: quoted(wanted),
                });
            }
        }
        let axis = |text: &str| text.parse::<Axis>().map_err(|e| broken(e.to_string()));
        let grid = &document["grid"];
        let abscissa = grid["abscissa"].as_str().unwrap_or_default();
        let others = grid["curves"].as_array();
        let others = others.into_iter().flatten().filter_map(|v| v.as_str());
        Ok(Some(Grid {
            abscissa: axis(abscissa)?,
            others: others.map(axis).collect::<Result<_, _>>()?,
        }))
    }
}

fn quoted(text: &str) -> String {
    if text.is_empty() {
        "not given".to_owned()
    } else {
        format!("\"{text}\"")
    }
}
