//! Rays as CSV: the heading says which column is what.

use std::io::{self, BufRead, Read};
use std::path::Path;

use etalon::inside::shape::{Query, Ray};
use glam::DVec3;

use super::Failure;

/// The columns that have a meaning; the first six are required.
const COLUMNS: [&str; 9] = ["ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax", "id"];
const REQUIRED: usize = 6;
const HEADING: &str = "a heading that names ox,oy,oz,dx,dy,dz and at will id,tmin,tmax";
const T_MIN: usize = 6;
const T_MAX: usize = 7;
const ID: usize = 8;

/// Longest line accepted, bytes, so that a file without line ends cannot fill the memory.
const LONGEST_LINE: u64 = 1 << 20;

/// One line of text, not yet split into fields.
pub struct Line {
    text: String,
    /// Counted from 1, heading included.
    number: u64,
    /// Counted from 0, rays only.
    row: u64,
}

/// The meaning of each column, from the heading.
pub struct Table {
    file: String,
    width: usize,
    /// Field of each of [`COLUMNS`].
    fields: [Option<usize>; COLUMNS.len()],
    /// Columns without a meaning.
    pub ignored: Vec<String>,
}

/// Lines of a file or of stdin.
pub struct Lines {
    source: Box<dyn BufRead>,
    file: String,
    number: u64,
    row: u64,
}

fn unreadable(file: &str, reason: &io::Error) -> String {
    format!("cannot read {file}: {reason}")
}

/// Names the place of a mistake, and what would have been right there.
fn malformed(
    (file, line): (&str, u64),
    column: Option<usize>,
    message: &str,
    expected: &str,
) -> Failure {
    let column = column.map_or_else(String::new, |column| {
        format!(", column {}", COLUMNS[column])
    });
    format!("{message}\n --> {file}:{line}{column}\n  = expected: {expected}").into()
}

impl Lines {
    /// Opens the file, or stdin for `-`.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let (source, file): (Box<dyn BufRead>, _) = if path == Path::new("-") {
            (Box::new(io::stdin().lock()), "<stdin>".to_owned())
        } else {
            let name = path.display().to_string();
            let opened = std::fs::File::open(path).and_then(|file| {
                if file.metadata()?.is_dir() {
                    return Err(io::ErrorKind::IsADirectory.into());
                }
                Ok(io::BufReader::with_capacity(1 << 16, file))
            });
            let reader = opened.map_err(|reason| unreadable(&name, &reason))?;
            (Box::new(reader), name)
        };
        Ok(Self {
            source,
            file,
            number: 0,
            row: 0,
        })
    }

    /// Reads the heading.
    pub fn heading(&mut self) -> Result<Table, Failure> {
        let line = self.next_line()?;
        self.row = 0;
        let (text, number) = line.map_or((String::new(), 1), |line| (line.text, line.number));
        Table::read(self.file.clone(), &text, number)
    }

    /// The next line that is not blank.
    pub fn next_line(&mut self) -> Result<Option<Line>, Failure> {
        loop {
            let mut bytes = Vec::new();
            let mut limited = (&mut self.source).take(LONGEST_LINE);
            let read = limited.read_until(b'\n', &mut bytes);
            let length = read.map_err(|reason| unreadable(&self.file, &reason))?;
            if length == 0 {
                return Ok(None);
            }
            self.number += 1;
            let place = (self.file.as_str(), self.number);
            if length as u64 == LONGEST_LINE && !bytes.ends_with(b"\n") {
                let expected = "at most 2^20 bytes a line";
                return Err(malformed(place, None, "the line is too long", expected));
            }
            let Ok(mut text) = String::from_utf8(bytes) else {
                return Err(malformed(place, None, "the line is not UTF-8", "CSV"));
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
}

impl Table {
    fn read(file: String, heading: &str, line: u64) -> Result<Self, Failure> {
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
                let place = (table.file.as_str(), line);
                return Err(malformed(place, Some(column), &message, HEADING));
            }
        }
        match table.fields[..REQUIRED].iter().position(Option::is_none) {
            Some(column) => {
                let message = format!("the column {} is missing", COLUMNS[column]);
                Err(malformed((&table.file, line), None, &message, HEADING))
            }
            None => Ok(table),
        }
    }

    /// Reads the id of a ray, or the number of its row where there is none, and where hits count on it.
    pub fn ray(&self, line: &Line) -> Result<(String, Query), Failure> {
        let fields = split(&line.text);
        let place = (self.file.as_str(), line.number);
        if fields.len() != self.width {
            let (found, width) = (fields.len(), self.width);
            let message = format!("the line has {found} fields, the heading has {width}");
            let expected = "as many fields as the heading";
            return Err(malformed(place, None, &message, expected));
        }
        let field = |column: usize| self.fields[column].map(|field| fields[field].as_str());
        let number = |column: usize, default: f64| {
            let Some(text) = field(column) else {
                return Ok(default);
            };
            let expected = match column {
                T_MAX => "a decimal number, or inf",
                _ => "a decimal number in the range of f64",
            };
            match text.parse::<f64>() {
                Ok(x) if x.is_finite() || (column == T_MAX && x == f64::INFINITY) => Ok(x),
                _ => {
                    let message = format!("{text:?} is not a number that can stand here");
                    Err(malformed(place, Some(column), &message, expected))
                }
            }
        };
        let vector = |first: usize| -> Result<DVec3, Failure> {
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
            let expected = "dx,dy,dz that are not all 0";
            return Err(malformed(place, Some(3), "the direction is zero", expected));
        }
        let query = Query {
            ray,
            t_min: number(T_MIN, 0.0)?,
            t_max: number(T_MAX, f64::INFINITY)?,
        };
        let id = field(ID).map_or_else(|| line.row.to_string(), str::to_owned);
        Ok((id, query))
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
