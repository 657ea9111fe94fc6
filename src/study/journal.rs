//! The table of a study on the disk: one line a render, each whole or not there.

use std::collections::HashSet;
use std::fs::{File, OpenOptions};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use crate::chart::Key;
use crate::chart::row::{self, Row, TableError};

/// What names a render within its study.
pub type Name = ([String; Key::ALL.len()], u32);

/// The table, open for the next row.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// The rows so far.
    pub rows: Vec<Row>,
    done: HashSet<Name>,
}

/// Why the table cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The operating system refuses.
    #[error("cannot write {}: {source}", path.display())]
    File {
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// What is there is no table of a study.
    #[error("{}: {reason}", path.display())]
    Content {
        path: PathBuf,
        /// What is wrong with it.
        reason: TableError,
    },
}

impl Journal {
    /// Opens the table, or begins it; a line that was cut off at the end of the file is taken
    /// away.
    ///
    /// # Errors
    /// [`JournalError`].
    pub fn open(path: &Path) -> Result<Self, JournalError> {
        let failed = |source| JournalError::File {
            path: path.to_owned(),
            source,
        };
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(failed)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let whole = bytes
            .iter()
            .rposition(|b| *b == b'\n')
            .map_or(0, |at| at + 1);
        file.set_len(whole as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        let text = String::from_utf8_lossy(&bytes[..whole]).into_owned();
        if text.is_empty() {
            file.write_all(row::heading().as_bytes()).map_err(failed)?;
        }
        let rows = if text.is_empty() {
            Vec::new()
        } else {
            row::read(&text).map_err(|reason| JournalError::Content {
                path: path.to_owned(),
                reason,
            })?
        };
        let done = rows.iter().map(name).collect();
        Ok(Self {
            path: path.to_owned(),
            file,
            rows,
            done,
        })
    }

    /// Whether this render is in the table.
    pub fn has(&self, name: &Name) -> bool {
        self.done.contains(name)
    }

    /// Adds a row, and brings it to the disk.
    ///
    /// # Errors
    /// [`JournalError::File`].
    pub fn add(&mut self, row: Row) -> Result<(), JournalError> {
        let written = self.file.write_all(row.line().as_bytes());
        written
            .and_then(|()| self.file.flush())
            .map_err(|source| JournalError::File {
                path: self.path.clone(),
                source,
            })?;
        self.done.insert(name(&row));
        self.rows.push(row);
        Ok(())
    }
}

fn name(row: &Row) -> Name {
    (row.values.clone(), row.replicate)
}
