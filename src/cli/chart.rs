//! `etalon chart`: several studies in one picture of speed and accuracy.

use std::fmt::Display;

use etalon::inside::chart::{Key, curves, figures, row};

use super::args;
use super::study::write_chart;
use super::{Answer, Failure, say, tell};

pub fn run(arguments: &args::Chart) -> Result<Answer, Failure> {
    let mut rows = Vec::new();
    for path in &arguments.tables {
        let unreadable = |reason: &dyn Display| format!("cannot read {}: {reason}", path.display());
        let text = std::fs::read_to_string(path).map_err(|reason| unreadable(&reason))?;
        let own = row::read(&text).map_err(|reason| unreadable(&reason))?;
        if own.is_empty() {
            return Err(unreadable(&row::TableError::Empty).into());
        }
        rows.extend(own);
    }
    let scenes: Vec<(&str, &str)> = rows
        .iter()
        .map(|r| (r.scene.as_str(), r.panel.as_str()))
        .collect();
    if scenes.iter().any(|scene| *scene != scenes[0]) {
        tell("note: the tables are of different scenes or panels");
    }
    let curves = curves(&rows, Key::Spp);
    let figure = figures::error_over_seconds(&curves, arguments.at);
    let path = write_chart(&arguments.output, &figure.svg()?)?;
    let mut lines = vec![format!(
        "{}: {} curves of {} renders",
        path.display(),
        curves.len(),
        rows.len()
    )];
    lines.extend(figure.notes);
    say(&lines.join("\n"))?;
    Ok(Answer::Good)
}
