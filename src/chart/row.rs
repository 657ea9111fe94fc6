//! One finished render of a study as a row of a table.
//!
//! A table is CSV with the heading [`COLUMNS`]; every row is one whole render, nothing is averaged
//! away. Other programs may write the same columns (in any order, further ones are ignored), and
//! `etalon chart` lays them beside etalon's own; scenes/README.md says what each column means.

use std::fmt;

use super::Key;

/// The columns in the order in which they are written.
pub const COLUMNS: [&str; 24] = [
    "renderer",
    "scene",
    "panel",
    "settings",
    "sampler",
    "precision",
    "wavelengths",
    "max_depth",
    "finder",
    "scrambles",
    "spp",
    "replicate",
    "seed",
    "threads",
    "seconds",
    "samples",
    "rmse",
    "relmse",
    "bias",
    "bias_standard_error",
    "estimated_rmse",
    "reference",
    "reference_rmse",
    "reference_relmse",
];

/// Columns that a table must have: the others may be missing or empty.
const REQUIRED: [&str; 5] = ["renderer", "scene", "spp", "seconds", "relmse"];

/// One render of a study.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// The program, with its variant.
    pub renderer: String,
    /// Name of the scene: its file's without directory and extension.
    pub scene: String,
    /// Panel of the scene.
    pub panel: String,
    /// Whatever else was laid over the scene, `key=value` separated by spaces.
    pub settings: String,
    /// Values of the study's axes, by [`Key`]; empty where there is nothing to say.
    pub values: [String; Key::ALL.len()],
    /// Which of the independent renders of a point.
    pub replicate: u32,
    /// Seed of the render.
    pub seed: u64,
    /// Threads that worked.
    pub threads: u32,
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
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// It has no rows.
    #[error("it has no rows")]
    Empty,
    /// A column is missing.
    #[error("it has no column \"{0}\": it is no table of `etalon study` (see scenes/README.md)")]
    Column(&'static str),
    /// A cell is no number.
    #[error("line {line}: \"{text}\" in the column {column} is no number")]
    Number {
        /// Its line, counted from 1.
        line: u64,
        column: &'static str,
        /// What stands there.
        text: String,
    },
    /// It is not CSV.
    #[error("it is no CSV: {0}")]
    Csv(String),
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

    /// The row as a line of CSV, its end included.
    pub fn line(&self) -> String {
        line(&self.cells())
    }

    /// One cell for each of [`COLUMNS`].
    fn cells(&self) -> Vec<String> {
        let value = |key| self.value(key).to_owned();
        let number = |x: f64| {
            if x.is_nan() {
                String::new()
            } else {
                format!("{x:e}")
            }
        };
        vec![
            self.renderer.clone(),
            self.scene.clone(),
            self.panel.clone(),
            self.settings.clone(),
            value(Key::Sampler),
            value(Key::Precision),
            value(Key::Wavelengths),
            value(Key::MaxDepth),
            value(Key::Finder),
            value(Key::Scrambles),
            value(Key::Spp),
            self.replicate.to_string(),
            self.seed.to_string(),
            self.threads.to_string(),
            number(self.seconds),
            self.samples.to_string(),
            number(self.rmse),
            number(self.relmse),
            number(self.bias),
            number(self.bias_standard_error),
            number(self.estimated_rmse),
            self.reference.clone(),
            number(self.reference_rmse),
            number(self.reference_relmse),
        ]
    }
}

/// The heading as a line of CSV.
pub fn heading() -> String {
    line(&COLUMNS)
}

fn line<T: AsRef<[u8]>>(cells: &[T]) -> String {
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
    let broken = |error: csv::Error| TableError::Csv(error.to_string());
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let heading = reader.headers().map_err(broken)?.clone();
    if let Some(missing) = REQUIRED.iter().find(|c| heading.iter().all(|h| h != **c)) {
        return Err(TableError::Column(missing));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(broken)?;
        let line = record.position().map_or(0, csv::Position::line);
        let cells = Cells {
            heading: &heading,
            record: &record,
            line,
        };
        rows.push(cells.row()?);
    }
    Ok(rows)
}

/// A row as it stands in the file.
struct Cells<'a> {
    heading: &'a csv::StringRecord,
    record: &'a csv::StringRecord,
    line: u64,
}

impl Cells<'_> {
    fn text(&self, column: &str) -> String {
        let index = self.heading.iter().position(|name| name == column);
        let cell = index.and_then(|index| self.record.get(index));
        cell.unwrap_or_default().to_owned()
    }

    /// The number in a column; `missing` where the cell is empty and may be.
    fn number<T: std::str::FromStr>(
        &self,
        column: &'static str,
        missing: T,
    ) -> Result<T, TableError> {
        let text = self.text(column);
        if text.is_empty() && !REQUIRED.contains(&column) {
            return Ok(missing);
        }
        text.parse().map_err(|_| TableError::Number {
            line: self.line,
            column,
            text,
        })
    }

    fn row(&self) -> Result<Row, TableError> {
        let nan = f64::NAN;
        let _whole: f64 = self.number("spp", nan)?;
        Ok(Row {
            renderer: self.text("renderer"),
            scene: self.text("scene"),
            panel: self.text("panel"),
            settings: self.text("settings"),
            values: Key::ALL.map(|key| self.text(key.column())),
            replicate: self.number("replicate", 0)?,
            seed: self.number("seed", 0)?,
            threads: self.number("threads", 0)?,
            seconds: self.number("seconds", nan)?,
            samples: self.number("samples", 0)?,
            rmse: self.number("rmse", nan)?,
            relmse: self.number("relmse", nan)?,
            bias: self.number("bias", nan)?,
            bias_standard_error: self.number("bias_standard_error", nan)?,
            estimated_rmse: self.number("estimated_rmse", nan)?,
            reference: self.text("reference"),
            reference_rmse: self.number("reference_rmse", 0.0)?,
            reference_relmse: self.number("reference_relmse", 0.0)?,
        })
    }
}

/// What is being measured, for people.
impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let said = Key::ALL.iter().filter(|key| !self.value(**key).is_empty());
        let said: Vec<_> = said
            .map(|key| format!("{} {}", key.column(), self.value(*key)))
            .collect();
        write!(f, "{}, replicate {}", said.join(", "), self.replicate)
    }
}
