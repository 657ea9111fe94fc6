//! One finished render of a study as a row of a table.
//!
//! A table is CSV; every row is one whole render, nothing is averaged away. Other programs may write
//! the same columns (in any order, further ones are ignored), and `etalon chart` lays them beside
//! etalon's own; scenes/README.md says what each column means.

use std::fmt;

/// A setting of the renderer that a study can vary and a chart tells apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Key {
    Spp,
    Sampler,
    Precision,
    Wavelengths,
    MaxDepth,
    Finder,
    Scrambles,
}

impl Key {
    pub const ALL: [Self; 7] = [
        Self::Spp,
        Self::Sampler,
        Self::Precision,
        Self::Wavelengths,
        Self::MaxDepth,
        Self::Finder,
        Self::Scrambles,
    ];

    /// Its name on the command line and its column in a table.
    pub fn column(self) -> &'static str {
        match self {
            Self::Spp => "spp",
            Self::Sampler => "sampler",
            Self::Precision => "precision",
            Self::Wavelengths => "wavelengths",
            Self::MaxDepth => "max_depth",
            Self::Finder => "finder",
            Self::Scrambles => "scrambles",
        }
    }

    /// Whether its values are whole numbers.
    pub fn is_number(self) -> bool {
        !matches!(self, Self::Sampler | Self::Precision | Self::Finder)
    }
}

/// Columns that a table must have: the others may be missing or empty.
const REQUIRED: [&str; 5] = ["renderer", "scene", "spp", "seconds", "relmse"];

/// One render of a study.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// The program, with its variant.
    pub renderer: String,
    /// Name of the scene: its file's without directory and extension.
    pub scene: String,
    pub panel: String,
    /// All other settings that differ from the scene's, `key=value` separated by spaces.
    pub settings: String,
    /// Values of the study's axes, by [`Key`]; empty where there is nothing to say.
    pub values: [String; Key::ALL.len()],
    /// Which of the independent renders of a point.
    pub replicate: u64,
    pub seed: u64,
    /// Threads that worked.
    pub threads: u64,
    /// Wall-clock seconds of the render.
    pub seconds: f64,
    /// Camera paths in the whole picture.
    pub samples: u64,
    /// Root mean squared error, the reference's variance taken off under the root; with a minus
    /// sign where more had to be taken off than there was.
    pub rmse: f64,
    /// Relative mean squared error, the reference's variance taken off.
    pub relmse: f64,
    /// Signed mean error over the mean of the reference.
    pub bias: f64,
    pub bias_standard_error: f64,
    /// The render's own estimate of `rmse`; NaN where it has none.
    pub estimated_rmse: f64,
    /// What was compared with.
    pub reference: String,
    /// Root mean squared standard error of the reference.
    pub reference_rmse: f64,
    /// Mean of its relative variance, in the sense of `relmse`.
    pub reference_relmse: f64,
}

/// What is wrong with a table.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    #[error("it has no rows")]
    Empty,
    #[error("it has no column \"{0}\": it is no table of `etalon study` (see scenes/README.md)")]
    Column(&'static str),
    #[error("line {line}: \"{text}\" in the column {column} is no number")]
    Number {
        /// Counted from 1.
        line: u64,
        column: &'static str,
        text: String,
    },
    #[error("it is no CSV: {0}")]
    Csv(#[from] csv::Error),
}

/// A cell of a row.
enum Cell<'a> {
    Text(&'a mut String),
    Count(&'a mut u64),
    Real(&'a mut f64),
}

impl Cell<'_> {
    /// Takes its value from a table; `None` where that is no number.
    fn read(self, text: &str) -> Option<()> {
        match self {
            Self::Text(value) => text.clone_into(value),
            Self::Count(value) => *value = text.parse().ok()?,
            Self::Real(value) => *value = text.parse().ok()?,
        }
        Some(())
    }

    fn text(self) -> String {
        match self {
            Self::Text(value) => value.clone(),
            Self::Count(value) => value.to_string(),
            Self::Real(value) if value.is_nan() => String::new(),
            Self::Real(value) => format!("{value:e}"),
        }
    }
}

impl Row {
    /// The value of an axis.
    pub fn value(&self, key: Key) -> &str {
        &self.values[key as usize]
    }

    /// Camera paths a pixel; 0 where the table does not say.
    pub fn spp(&self) -> f64 {
        self.value(Key::Spp).parse().unwrap_or(0.0)
    }

    /// Mean squared error, the reference's variance taken off.
    pub fn mse(&self) -> f64 {
        self.rmse * self.rmse.abs()
    }

    /// The columns in the order in which they are written.
    fn columns(&mut self) -> Vec<(&'static str, Cell<'_>)> {
        use Cell::{Count, Real, Text};
        let mut columns = vec![
            ("renderer", Text(&mut self.renderer)),
            ("scene", Text(&mut self.scene)),
            ("panel", Text(&mut self.panel)),
            ("settings", Text(&mut self.settings)),
        ];
        let axes = Key::ALL.map(Key::column).into_iter();
        columns.extend(axes.zip(self.values.iter_mut().map(Text)));
        // The number of samples, the first of the axes, comes after the others.
        columns[4..].rotate_left(1);
        columns.extend([
            ("replicate", Count(&mut self.replicate)),
            ("seed", Count(&mut self.seed)),
            ("threads", Count(&mut self.threads)),
            ("seconds", Real(&mut self.seconds)),
            ("samples", Count(&mut self.samples)),
            ("rmse", Real(&mut self.rmse)),
            ("relmse", Real(&mut self.relmse)),
            ("bias", Real(&mut self.bias)),
            ("bias_standard_error", Real(&mut self.bias_standard_error)),
            ("estimated_rmse", Real(&mut self.estimated_rmse)),
            ("reference", Text(&mut self.reference)),
            ("reference_rmse", Real(&mut self.reference_rmse)),
            ("reference_relmse", Real(&mut self.reference_relmse)),
        ]);
        columns
    }

    /// The row as a line of CSV, its end included.
    pub fn line(&self) -> String {
        let mut row = self.clone();
        line(row.columns().into_iter().map(|(_, cell)| cell.text()))
    }
}

/// The heading as a line of CSV.
pub fn heading() -> String {
    let mut row = Row::default();
    line(row.columns().into_iter().map(|(name, _)| name.to_owned()))
}

fn line(cells: impl Iterator<Item = String>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // A vector takes everything.
    let _ = writer.write_record(cells);
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Reads a table.
///
/// # Errors
/// [`TableError`] with the line where a number was expected, and for tables without the columns
/// that a chart needs.
pub fn read(text: &str) -> Result<Vec<Row>, TableError> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let heading = reader.headers()?.clone();
    if let Some(missing) = REQUIRED.iter().find(|c| heading.iter().all(|h| h != **c)) {
        return Err(TableError::Column(missing));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        let mut row = Row {
            rmse: f64::NAN,
            bias: f64::NAN,
            bias_standard_error: f64::NAN,
            estimated_rmse: f64::NAN,
            ..Row::default()
        };
        for (column, cell) in row.columns() {
            let index = heading.iter().position(|name| name == column);
            let text = index.and_then(|index| record.get(index));
            let text = text.unwrap_or_default();
            if text.is_empty() && !REQUIRED.contains(&column) {
                continue;
            }
            let is_number = column != "spp" || text.parse::<f64>().is_ok();
            if !is_number || cell.read(text).is_none() {
                return Err(TableError::Number {
                    line: record.position().map_or(0, csv::Position::line),
                    column,
                    text: text.to_owned(),
                });
            }
        }
        rows.push(row);
    }
    Ok(rows)
}

/// The values of the axes and the number of the render.
impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for key in Key::ALL {
            if !self.value(key).is_empty() {
                write!(f, "{} {}, ", key.column(), self.value(key))?;
            }
        }
        write!(f, "replicate {}", self.replicate)
    }
}
