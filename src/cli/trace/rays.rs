//! Rays as CSV: the heading says which column is what.

use std::fmt;
use std::io::{self, BufRead, Read};
use std::path::{Path, PathBuf};

use etalon::inside::shape::{Query, Ray};
use glam::DVec3;

/// Rays that cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum RayError {
    /// The operating system would not hand over the file.
    #[error("error: cannot read {}: {reason}", path.display())]
    Unreadable {
        /// The file asked for.
        path: PathBuf,
        /// What the operating system said.
        reason: io::Error,
    },
    /// Something in the text is wrong.
    #[error("error: {message}\n --> {place}\n  = expected: {expected}")]
    Malformed {
        /// What is wrong.
        message: String,
        /// Where.
        place: Place,
        /// What would have been right.
        expected: &'static str,
    },
}

/// A place in the table.
#[derive(Debug)]
pub struct Place {
    file: String,
    line: u64,
    column: Option<&'static str>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.line)?;
        match self.column {
            Some(column) => write!(f, ", column {column}"),
            None => Ok(()),
        }
    }
}

/// The columns that mean something; the first six must be there.
const COLUMNS: [&str; 9] = ["ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax", "id"];
const REQUIRED: usize = 6;
const HEADING: &str = "a heading that names ox,oy,oz,dx,dy,dz and at will id,tmin,tmax";
const T_MIN: usize = 6;
const T_MAX: usize = 7;
const ID: usize = 8;

/// Nothing sensible is longer, and no file without line ends fills the memory.
const LONGEST_LINE: u64 = 1 << 20;

/// One line of text, not yet taken apart.
pub struct Line {
    text: String,
    /// Counted from 1, heading included.
    number: u64,
    /// Counted from 0, rays only.
    row: u64,
}

/// A ray and what it is called.
pub struct RayRow {
    /// As written, or the number of the row, counted from 0.
    pub id: String,
    /// The ray and where hits count on it.
    pub query: Query,
}

/// What the heading says.
pub struct Table {
    file: String,
    width: usize,
    /// Field of each of [`COLUMNS`].
    fields: [Option<usize>; COLUMNS.len()],
    /// Columns that mean nothing here.
    pub ignored: Vec<String>,
}

/// Lines of a file or of stdin.
pub struct Lines {
    source: Box<dyn BufRead>,
    path: PathBuf,
    number: u64,
    row: u64,
}

impl Lines {
    /// Opens the file, or stdin for `-`.
    pub fn open(path: &Path) -> Result<Self, RayError> {
        let unreadable = |reason| RayError::Unreadable {
            path: path.to_owned(),
            reason,
        };
        let is_stdin = path == Path::new("-");
        let source: Box<dyn BufRead> = if is_stdin {
            Box::new(io::stdin().lock())
        } else {
            let file = std::fs::File::open(path).map_err(unreadable)?;
            if file.metadata().map_err(unreadable)?.is_dir() {
                return Err(unreadable(io::ErrorKind::IsADirectory.into()));
            }
            Box::new(io::BufReader::with_capacity(1 << 16, file))
        };
        let name = if is_stdin { Path::new("<stdin>") } else { path };
        Ok(Self {
            source,
            path: name.to_owned(),
            number: 0,
            row: 0,
        })
    }

    /// Reads the heading.
    pub fn heading(&mut self) -> Result<Table, RayError> {
        let line = self.next_line()?;
        self.row = 0;
        let (text, number) = line.map_or((String::new(), 1), |line| (line.text, line.number));
        Table::read(self.path.display().to_string(), &text, number)
    }

    /// The next line that is not blank.
    pub fn next_line(&mut self) -> Result<Option<Line>, RayError> {
        loop {
            let mut bytes = Vec::new();
            let mut limited = (&mut self.source).take(LONGEST_LINE);
            let read = limited.read_until(b'\n', &mut bytes);
            let length = read.map_err(|reason| RayError::Unreadable {
                path: self.path.clone(),
                reason,
            })?;
            if length == 0 {
                return Ok(None);
            }
            self.number += 1;
            if length as u64 == LONGEST_LINE && !bytes.ends_with(b"\n") {
                return Err(self.malformed("the line is too long", "at most 2^20 bytes a line"));
            }
            let Ok(mut text) = String::from_utf8(bytes) else {
                return Err(self.malformed("the line is not UTF-8", "CSV"));
            };
            if self.number == 1 && text.starts_with('\u{feff}') {
                text.remove(0);
            }
            text.truncate(text.trim_end_matches(['\n', '\r']).len());
            if text.trim().is_empty() {
                continue;
            }
            let line = Line {
                text,
                number: self.number,
                row: self.row,
            };
            self.row += 1;
            return Ok(Some(line));
        }
    }

    fn malformed(&self, message: &str, expected: &'static str) -> RayError {
        RayError::Malformed {
            message: message.to_owned(),
            place: Place {
                file: self.path.display().to_string(),
                line: self.number,
                column: None,
            },
            expected,
        }
    }
}

impl Table {
    fn read(file: String, heading: &str, line: u64) -> Result<Self, RayError> {
        let names = split(heading);
        let mut table = Self {
            file,
            width: names.len(),
            fields: [None; COLUMNS.len()],
            ignored: Vec::new(),
        };
        for (field, name) in names.into_iter().enumerate() {
            let Some(column) = COLUMNS.iter().position(|column| *column == name) else {
                table.ignored.push(name);
                continue;
            };
            if table.fields[column].replace(field).is_some() {
                let message = format!("the column {name} occurs twice");
                return Err(table.malformed(message, line, Some(column), HEADING));
            }
        }
        match table.fields[..REQUIRED].iter().position(Option::is_none) {
            Some(column) => {
                let message = format!("the column {} is missing", COLUMNS[column]);
                Err(table.malformed(message, line, None, HEADING))
            }
            None => Ok(table),
        }
    }

    /// Takes a line apart.
    pub fn ray(&self, line: &Line) -> Result<RayRow, RayError> {
        let fields = split(&line.text);
        if fields.len() != self.width {
            let (found, width) = (fields.len(), self.width);
            let message = format!("the line has {found} fields, the heading has {width}");
            let expected = "as many fields as the heading";
            return Err(self.malformed(message, line.number, None, expected));
        }
        let field = |column: usize| self.fields[column].map(|field| fields[field].as_str());
        let number = |column: usize, default: f64| match field(column) {
            Some(text) => self.number(text, line.number, column),
            None => Ok(default),
        };
        let vector = |first: usize| -> Result<DVec3, RayError> {
            Ok(DVec3::new(
                number(first, 0.0)?,
                number(first + 1, 0.0)?,
                number(first + 2, 0.0)?,
            ))
        };
        let ray = Ray {
            origin: vector(0)?,
            direction: vector(3)?,
        };
        if ray.direction == DVec3::ZERO {
            let message = "the direction is zero".to_owned();
            let expected = "dx,dy,dz that are not all 0";
            return Err(self.malformed(message, line.number, Some(3), expected));
        }
        Ok(RayRow {
            id: field(ID).map_or_else(|| line.row.to_string(), str::to_owned),
            query: Query {
                ray,
                t_min: number(T_MIN, 0.0)?,
                t_max: number(T_MAX, f64::INFINITY)?,
            },
        })
    }

    fn number(&self, text: &str, line: u64, column: usize) -> Result<f64, RayError> {
        let unlimited = column == T_MAX;
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() || (unlimited && x == f64::INFINITY) => Ok(x),
            _ => {
                let message = format!("{text:?} is not a number that can stand here");
                let expected = if unlimited {
                    "a decimal number, or inf"
                } else {
                    "a decimal number in the range of f64"
                };
                Err(self.malformed(message, line, Some(column), expected))
            }
        }
    }

    fn malformed(
        &self,
        message: String,
        line: u64,
        column: Option<usize>,
        expected: &'static str,
    ) -> RayError {
        RayError::Malformed {
            message,
            place: Place {
                file: self.file.clone(),
                line,
                column: column.map(|column| COLUMNS[column]),
            },
            expected,
        }
    }
}

/// The fields of a line, without the blanks around them.
fn split(text: &str) -> Vec<String> {
    let trimmed = |field: &str| field.trim().to_owned();
    if !text.contains('"') {
        return text.split(',').map(trimmed).collect();
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let record = reader.records().next().and_then(Result::ok);
    record.map_or_else(Vec::new, |record| record.iter().map(trimmed).collect())
}
