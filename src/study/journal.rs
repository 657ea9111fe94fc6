//! Files from which a study is continued: `study.toml`, the request, so that no other study is mixed
//! in, and `study.csv`, one line a render, each whole or not there.

use std::fs::{File, OpenOptions};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use toml_edit::{Array, DocumentMut, Item, Table, value};

use super::StudyError;
use super::axis::Axis;
use super::grid::Grid;
use crate::chart::row::{self, Row};

/// The request of a study, the grid it led to and the command that asked for it, as TOML.
pub fn record(request: &[(&str, String)], grid: &Grid, command: &str) -> String {
    let mut document = DocumentMut::new();
    document["command"] = value(command);
    let table = |(key, text): &(&str, String)| ((*key).to_owned(), value(text.as_str()));
    document["request"] = Item::Table(request.iter().map(table).collect());
    let mut table = Table::new();
    table["abscissa"] = value(grid.abscissa.to_string());
    let others: Array = grid.others.iter().map(Axis::to_string).collect();
    table["curves"] = value(others);
    document["grid"] = Item::Table(table);
    document.to_string()
}

/// The grid of the study that a file records, if it is the one requested; `None` where there is no
/// file.
///
/// # Errors
/// [`StudyError::Other`] where it is of another study.
pub fn resume(path: &Path, request: &[(&str, String)]) -> Result<Option<Grid>, StudyError> {
    let broken = |reason: &dyn ToString| StudyError::file("use", path, reason);
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(broken(&error)),
    };
    let document: DocumentMut = text.parse().map_err(|error| broken(&error))?;
    for (key, wanted) in request {
        let found = document["request"].get(key).and_then(Item::as_str);
        let found = found.unwrap_or_default();
        if found != wanted {
            return Err(StudyError::Other {
                path: path.to_owned(),
                key: (*key).to_owned(),
                found: quoted(found),
                wanted: quoted(wanted),
            });
        }
    }
    let axis = |text: &str| text.parse::<Axis>().map_err(|error| broken(&error));
    let grid = &document["grid"];
    let abscissa = grid["abscissa"].as_str().unwrap_or_default();
    let others = grid["curves"].as_array();
    let others = others.into_iter().flatten().filter_map(|v| v.as_str());
    Ok(Some(Grid {
        abscissa: axis(abscissa)?,
        others: others.map(axis).collect::<Result<_, _>>()?,
    }))
}

fn quoted(text: &str) -> String {
    match text {
        "" => "not given".to_owned(),
        text => format!("\"{text}\""),
    }
}

/// The table, open for the next row.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    pub rows: Vec<Row>,
}

impl Journal {
    /// Opens the table, or begins it; a line that was cut off at the end of the file is
    /// removed.
    ///
    /// # Errors
    /// [`StudyError`] where the file cannot be written or is no table.
    pub fn open(path: PathBuf) -> Result<Self, StudyError> {
        let failed = |error: std::io::Error| StudyError::file("write", &path, &error);
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(failed)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let whole = bytes.iter().rposition(|b| *b == b'\n');
        bytes.truncate(whole.map_or(0, |at| at + 1));
        file.set_len(bytes.len() as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        let mut rows = Vec::new();
        if bytes.is_empty() {
            file.write_all(row::heading().as_bytes()).map_err(failed)?;
        } else {
            rows = row::read(&String::from_utf8_lossy(&bytes)).map_err(|reason| {
                let path = path.clone();
                StudyError::Table { path, reason }
            })?;
        }
        Ok(Self { path, file, rows })
    }

    /// Whether the table has this render of the point with these values.
    pub fn has(&self, values: &[String], replicate: u32) -> bool {
        let is_it = |row: &Row| row.values == values && row.replicate == u64::from(replicate);
        self.rows.iter().any(is_it)
    }

    /// Appends a row to the file.
    ///
    /// # Errors
    /// [`StudyError`] where the file cannot be written.
    pub fn add(&mut self, row: Row) -> Result<(), StudyError> {
        let written = self.file.write_all(row.line().as_bytes());
        written
            .and_then(|()| self.file.flush())
            .map_err(|error| StudyError::file("write", &self.path, &error))?;
        self.rows.push(row);
        Ok(())
    }
}
