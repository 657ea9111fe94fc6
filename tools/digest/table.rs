//! Tables whose first columns name what the others say.

use std::collections::BTreeMap;
use std::path::Path;

/// What tables of a kind are made of.
pub struct Kind {
    pub file: &'static str,
    pub columns: &'static [&'static str],
    /// How many columns name a row.
    pub keys: usize,
}

/// Rows in the order of their keys.
pub struct Table {
    kind: &'static Kind,
    rows: BTreeMap<Vec<String>, Vec<String>>,
}

impl Table {
    pub fn new(kind: &'static Kind, rows: Vec<Vec<String>>) -> Self {
        let split = |mut row: Vec<String>| {
            let values = row.split_off(kind.keys);
            (row, values)
        };
        let rows = rows.into_iter().map(split).collect();
        Self { kind, rows }
    }

    /// The table at `path`: the rows that are wanted by their scene and panel.
    pub fn read(
        kind: &'static Kind,
        path: &Path,
        wanted: impl Fn(&[String]) -> bool,
    ) -> Result<Self, String> {
        let failed = |reason: csv::Error| format!("{}: {reason}", path.display());
        let mut file = csv::Reader::from_path(path).map_err(failed)?;
        if file.headers().map_err(failed)? != kind.columns {
            return Err(format!("{}: its columns are others", path.display()));
        }
        let rows = file.deserialize::<Vec<String>>();
        let mut rows: Vec<_> = rows.collect::<Result<_, _>>().map_err(failed)?;
        rows.retain(|row| wanted(&row[..2]));
        Ok(Self::new(kind, rows))
    }

    /// Writes the table to `path`.
    pub fn write(&self, path: &Path) -> Result<(), String> {
        let write = || {
            let mut file = csv::Writer::from_path(path)?;
            file.write_record(self.kind.columns)?;
            for (key, values) in &self.rows {
                file.write_record(key.iter().chain(values))?;
            }
            Ok(file.flush()?)
        };
        write().map_err(|reason: csv::Error| format!("{}: {reason}", path.display()))
    }

    /// In which values this differs from `kept`, a line each.
    pub fn differences(&self, kept: &Self) -> Vec<String> {
        let names = &self.kind.columns;
        let mut lines = Vec::new();
        for (key, values) in &self.rows {
            let keys = key.join(" ");
            let Some(before) = kept.rows.get(key) else {
                lines.push(format!("{keys}: new"));
                continue;
            };
            let columns = names[key.len()..].iter().zip(before.iter().zip(values));
            let changed = columns.filter(|(_, (before, now))| before != now);
            let words =
                |(name, (before, now))| format!("{keys}: {name} was {before:?}, is {now:?}");
            lines.extend(changed.map(words));
        }
        let gone = kept.rows.keys().filter(|key| !self.rows.contains_key(*key));
        lines.extend(gone.map(|key| format!("{}: gone", key.join(" "))));
        lines
    }
}
