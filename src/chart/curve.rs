//! Rows of tables gathered into curves: what a chart shows.

use super::{Key, Row};
use crate::stats::metrics::mean;
use crate::stats::slope::{Replicates, Slope};
use crate::stats::student;

/// Renders with the same settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The abscissa of the study.
    pub x: f64,
    /// Its independent renders.
    pub rows: Vec<Row>,
}

/// Points that differ in the abscissa only.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What distinguishes it from the others.
    pub label: String,
    /// The program.
    pub renderer: String,
    /// Its points by rising abscissa.
    pub points: Vec<Point>,
}

/// A mean over replicates and the half-width of its 95 % interval (NaN with one).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    pub value: f64,
    /// Half the width.
    pub half: f64,
}

impl Point {
    /// The mean of a column.
    pub fn mean(&self, column: impl Fn(&Row) -> f64) -> Mean {
        let values: Vec<f64> = self
            .rows
            .iter()
            .map(column)
            .filter(|v| !v.is_nan())
            .collect();
        let count = values.len() as f64;
        let value = mean(&values);
        let squares: f64 = values.iter().map(|v| (v - value) * (v - value)).sum();
        let error = (squares / (count - 1.0) / count).sqrt();
        Mean {
            value,
            half: student::critical(0.05, count - 1.0) * error,
        }
    }

    /// Root mean squared error, of the mean over replicates, and the half-width of its interval.
    pub fn rmse(&self) -> Mean {
        let square = self.mean(Row::mse);
        let value = square.value.max(0.0).sqrt();
        Mean {
            value,
            half: square.half / (2.0 * value),
        }
    }

    /// Whether the reference's own error is the larger part of what was measured: below this
    /// floor a curve is not drawn through, as most of it has been subtracted.
    pub fn at_floor(&self) -> bool {
        let square = |row: &Row| row.reference_rmse * row.reference_rmse;
        let floor = self.mean(square).value;
        let relative = self.mean(|row| row.reference_relmse).value;
        self.mean(Row::mse).value <= floor || self.mean(|row| row.relmse).value <= relative
    }

    /// Mean estimated over mean actual squared error, its root.
    pub fn estimated_over_actual(&self) -> f64 {
        let estimated = self
            .mean(|row| row.estimated_rmse * row.estimated_rmse)
            .value;
        (estimated / self.mean(Row::mse).value).sqrt()
    }
}

impl Curve {
    /// Points above the reference's floor.
    pub fn above_floor(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(|point| !point.at_floor())
    }

    /// How the root mean squared error falls, over the points above the floor.
    pub fn slope(&self) -> Option<Slope> {
        let points: Vec<Replicates> = self
            .above_floor()
            .map(|point| Replicates {
                x: point.x,
                values: point.rows.iter().map(Row::mse).collect(),
            })
            .collect();
        Some(Slope::fit(&points)?.of_root(2.0))
    }
}

/// Gathers rows; curves come in the order of their first rows.
pub fn curves(rows: &[Row], abscissa: Key) -> Vec<Curve> {
    let mut groups: Vec<(Identity, Vec<Row>)> = Vec::new();
    for row in rows {
        let identity = Identity::of(row, abscissa);
        match groups.iter_mut().find(|(other, _)| *other == identity) {
            Some((_, rows)) => rows.push(row.clone()),
            None => groups.push((identity, vec![row.clone()])),
        }
    }
    let identities: Vec<Identity> = groups.iter().map(|(i, _)| i.clone()).collect();
    groups
        .into_iter()
        .map(|(identity, rows)| Curve {
            label: identity.label(&identities),
            renderer: identity.renderer.clone(),
            points: points(rows, abscissa),
        })
        .collect()
}

fn points(rows: Vec<Row>, abscissa: Key) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    for row in rows {
        // No limit of the path length lies beyond all limits.
        let x = row.value(abscissa).parse().unwrap_or(f64::INFINITY);
        match points.iter_mut().find(|point| point.x == x) {
            Some(point) => point.rows.push(row),
            None => points.push(Point { x, rows: vec![row] }),
        }
    }
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    points
}

/// What names a curve.
#[derive(Debug, Clone, PartialEq)]
struct Identity {
    renderer: String,
    scene: String,
    panel: String,
    settings: String,
    values: [String; Key::ALL.len()],
}

impl Identity {
    fn of(row: &Row, abscissa: Key) -> Self {
        let mut values = row.values.clone();
        values[abscissa as usize].clear();
        Self {
            renderer: row.renderer.clone(),
            scene: row.scene.clone(),
            panel: row.panel.clone(),
            settings: row.settings.clone(),
            values,
        }
    }

    /// What distinguishes this curve among all.
    fn label(&self, all: &[Self]) -> String {
        let mut words: Vec<String> = Vec::new();
        let texts: [fn(&Self) -> &String; 4] =
            [|i| &i.renderer, |i| &i.scene, |i| &i.panel, |i| &i.settings];
        for text in texts {
            if all.iter().any(|other| text(other) != text(self)) && !text(self).is_empty() {
                words.push(text(self).clone());
            }
        }
        for key in Key::ALL {
            let own = &self.values[key as usize];
            // What programs call by other names says nothing across them.
            let mut siblings = all.iter().filter(|other| other.renderer == self.renderer);
            let varies = siblings.any(|other| other.values[key as usize] != *own);
            if (varies || key == Key::Sampler) && !own.is_empty() {
                words.push(said(key, own));
            }
        }
        words.join(", ")
    }
}

/// A value in words.
fn said(key: Key, value: &str) -> String {
    match key {
        Key::Sampler | Key::Precision => value.to_owned(),
        Key::Wavelengths => format!("{value} wavelengths"),
        Key::Scrambles => format!("{value} scrambles"),
        Key::Spp => format!("{value} spp"),
        Key::MaxDepth | Key::Finder => format!("{} {value}", key.column()),
    }
}

/// The least root mean squared error of all points that have one.
pub fn best(curves: &[Curve]) -> f64 {
    let points = curves.iter().flat_map(|curve| &curve.points);
    points
        .map(|point| point.rmse().value)
        .filter(|error| *error > 0.0)
        .fold(f64::INFINITY, f64::min)
}

/// The points that no other beats in both time and error: (curve, point), by rising seconds.
pub fn front(curves: &[Curve]) -> Vec<(usize, usize)> {
    let mut all: Vec<(f64, f64, usize, usize)> = Vec::new();
    for (c, curve) in curves.iter().enumerate() {
        for (p, point) in curve.points.iter().enumerate() {
            let error = point.mean(|row| row.relmse).value;
            let seconds = point.mean(|row| row.seconds).value;
            if !point.at_floor() && error > 0.0 && seconds > 0.0 {
                all.push((seconds, error, c, p));
            }
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut least = f64::INFINITY;
    let mut front = Vec::new();
    for (_, error, c, p) in all {
        if error < least {
            least = error;
            front.push((c, p));
        }
    }
    front
}
