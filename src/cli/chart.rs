//! `etalon chart`: several studies in one picture of speed and accuracy.

use etalon::inside::chart::{Key, curves, figures, row};

use super::args;
use super::error::CommandError;
use super::render::say;
use super::study::write_chart;
use super::{Answer, tell};

/// Draws the chart.
pub fn run(arguments: &args::Chart) -> Result<Answer, CommandError> {
    let mut rows = Vec::new();
    for path in &arguments.tables {
        let unreadable = |reason: String| CommandError::Table {
            path: path.clone(),
            reason,
        };
        let text = std::fs::read_to_string(path).map_err(|e| unreadable(e.to_string()))?;
        let own = row::read(&text).map_err(|e| unreadable(e.to_string()))?;
        if own.is_empty() {
            return Err(unreadable(row::TableError::Empty.to_string()));
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
    let svg = figure
        .svg()
        .map_err(|e| CommandError::Study(e.to_string()))?;
    let path = write_chart(&arguments.output, &svg)?;
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
