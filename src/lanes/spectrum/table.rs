//! Tabulated spectra and the reading of their CSV files.

use thiserror::Error;

/// Samples of a spectrum at increasing wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Wavelengths in nm, strictly increasing.
    pub nm: Vec<f64>,
    /// Values at those wavelengths.
    pub values: Vec<f64>,
}

/// Why samples are not a table; samples and lines are numbered from 1.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TableError {
    #[error("a spectrum's table needs at least one sample")]
    Empty,
    #[error("{nm} wavelengths, but {values} values")]
    Length { nm: usize, values: usize },
    /// A wavelength, nm, does not exceed the one before it.
    #[error(
        "wavelengths must increase strictly, but sample {number} has {nm} nm after {before} nm"
    )]
    NotIncreasing { number: usize, nm: f64, before: f64 },
    /// A wavelength, nm, or its value is infinite or no number.
    #[error("sample {number} is not finite: {value} at {nm} nm")]
    NotFinite { number: usize, nm: f64, value: f64 },
    /// A line of a CSV file is wrong.
    #[error("line {line}: {message}")]
    Line { line: usize, message: String },
}

impl Table {
    /// A table from wavelengths in nm and as many values.
    ///
    /// # Errors
    /// If there are no samples, the lengths differ, a number is not finite, or the wavelengths
    /// do not increase strictly.
    pub fn new(nm: Vec<f64>, values: Vec<f64>) -> Result<Self, TableError> {
        if nm.len() != values.len() {
            return Err(TableError::Length {
                nm: nm.len(),
                values: values.len(),
            });
        }
        if nm.is_empty() {
            return Err(TableError::Empty);
        }
        for (i, (&nm_i, &value)) in nm.iter().zip(&values).enumerate() {
            let number = i + 1;
            if !nm_i.is_finite() || !value.is_finite() {
                return Err(TableError::NotFinite {
                    number,
                    nm: nm_i,
                    value,
                });
            }
            if i > 0 && nm_i <= nm[i - 1] {
                return Err(TableError::NotIncreasing {
                    number,
                    nm: nm_i,
                    before: nm[i - 1],
                });
            }
        }
        Ok(Self { nm, values })
    }

    /// A table from CSV text: two columns, wavelength in nm and value. Empty lines and lines
    /// that begin with `#` are skipped; the first other line may be a header of two words.
    ///
    /// # Errors
    /// [`TableError::Line`] with the line's number, or [`TableError::Empty`].
    pub fn from_csv(text: &str) -> Result<Self, TableError> {
        let ([nm, values], lines) = columns::<2>(text)?;
        Self::new(nm, values).map_err(|error| match error {
            TableError::NotIncreasing { number, .. } | TableError::NotFinite { number, .. } => {
                TableError::Line {
                    line: lines[number - 1],
                    message: error.to_string(),
                }
            }
            other => other,
        })
    }

    /// The value at wavelength `nm`: linear between samples, zero outside.
    pub fn value(&self, nm: f64) -> f64 {
        let above = self.nm.partition_point(|&node| node <= nm);
        if above == 0 {
            return 0.0;
        }
        let low = above - 1;
        if self.nm[low] == nm {
            return self.values[low];
        }
        if above == self.nm.len() {
            return 0.0;
        }
        let t = (nm - self.nm[low]) / (self.nm[above] - self.nm[low]);
        let (a, b) = (self.values[low], self.values[above]);
        // Clamped, so that rounding never lifts a value above its neighbouring samples.
        (a * (1.0 - t) + b * t).clamp(a.min(b), a.max(b))
    }

    /// Smallest and largest value over `low..=high`, zero included where samples are missing.
    pub fn range(&self, low: f64, high: f64) -> [f64; 2] {
        let inside = self
            .nm
            .iter()
            .zip(&self.values)
            .filter(|&(&nm, _)| nm >= low && nm <= high)
            .map(|(_, &value)| value);
        let covered = self.nm.first().is_some_and(|&first| first <= low)
            && self.nm.last().is_some_and(|&last| last >= high);
        let outside = (!covered).then_some(0.0);
        let ends = covered.then(|| [self.value(low), self.value(high)]);
        inside
            .chain(outside)
            .chain(ends.into_iter().flatten())
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[min, max], value| {
                [min.min(value), max.max(value)]
            })
    }

    /// Neighbouring samples with different values, and the ends where the value drops to zero.
    pub fn rises(&self) -> Vec<[f64; 2]> {
        let ends = [0, self.nm.len() - 1].into_iter();
        let ends = ends.filter(|&i| self.values[i] != 0.0);
        let inner = (1..self.nm.len()).filter(|&i| self.values[i] != self.values[i - 1]);
        ends.map(|i| [self.nm[i]; 2])
            .chain(inner.map(|i| [self.nm[i - 1], self.nm[i]]))
            .collect()
    }

    /// The wavelengths of the samples strictly between `low` and `high`.
    pub fn nodes_between(&self, low: f64, high: f64) -> &[f64] {
        let begin = self.nm.partition_point(|&nm| nm <= low);
        let end = self.nm.partition_point(|&nm| nm < high);
        &self.nm[begin..end.max(begin)]
    }
}

/// The columns of numbers in CSV text, and the line each row stands in.
pub fn columns<const N: usize>(text: &str) -> Result<([Vec<f64>; N], Vec<usize>), TableError> {
    let mut columns = [const { Vec::new() }; N];
    let mut lines = Vec::new();
    let mut header_allowed = true;
    for (index, text_line) in text.lines().enumerate() {
        let line = index + 1;
        let content = text_line.trim().trim_start_matches('\u{feff}');
        if content.is_empty() || content.starts_with('#') {
            continue;
        }
        let fields: Vec<&str> = content.split(',').map(str::trim).collect();
        if fields.len() != N {
            let message = format!("{} columns where {N} are expected", fields.len());
            return Err(TableError::Line { line, message });
        }
        let is_header = header_allowed && fields.iter().all(|field| field.parse::<f64>().is_err());
        header_allowed = false;
        if is_header {
            continue;
        }
        for (column, field) in columns.iter_mut().zip(&fields) {
            let number = field.parse::<f64>().map_err(|_| TableError::Line {
                line,
                message: format!("'{field}' is not a number"),
            })?;
            column.push(number);
        }
        lines.push(line);
    }
    Ok((columns, lines))
}
