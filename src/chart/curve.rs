//! Rows of tables gathered into curves: what a chart shows.

use super::{Key, Row};
use crate::stats::Estimate;
use crate::stats::slope::{Replicates, Slope};

/// Renders with the same settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
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

impl Point {
    /// The mean of a column over the renders that have it.
    pub fn mean(&self, column: impl Fn(&Row) -> f64) -> Estimate {
        let values = self.rows.iter().map(column).filter(|v| !v.is_nan());
        Estimate::mean(&values.collect::<Vec<_>>())
    }

    /// Root mean squared error, of the mean over replicates; its standard error to first order.
    pub fn rmse(&self) -> Estimate {
        let square = self.mean(Row::mse);
        let value = square.value.max(0.0).sqrt();
        Estimate {
            value,
            standard_error: square.standard_error / (2.0 * value),
            ..square
        }
    }

    /// Whether the reference's own error is the larger part of what was measured: below this
    /// floor a curve is not drawn through, as most of it has been subtracted.
    pub fn at_floor(&self) -> bool {
        let floor = self.mean(|row| row.reference_rmse.powi(2)).value;
        let relative = self.mean(|row| row.reference_relmse).value;
        self.mean(Row::mse).value <= floor || self.mean(|row| row.relmse).value <= relative
    }

    /// Mean estimated over mean actual squared error, its root.
    pub fn estimated_over_actual(&self) -> f64 {
        let estimated = self.mean(|row| row.estimated_rmse.powi(2)).value;
        (estimated / self.mean(Row::mse).value).sqrt()
    }
}

impl Curve {
    /// Points above the reference's floor.
    fn above_floor(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(|point| !point.at_floor())
    }

    /// How the root mean squared error falls, over the points above the floor.
    pub fn slope(&self) -> Option<Slope> {
        let replicates = |point: &Point| Replicates {
            x: point.x,
            values: point.rows.iter().map(Row::mse).collect(),
        };
        let points: Vec<Replicates> = self.above_floor().map(replicates).collect();
        Some(Slope::fit(&points)?.of_root(2.0))
    }
}

/// Groups items that have the same key; groups come in the order of their first items.
pub fn grouped<T, K: PartialEq>(
    items: impl IntoIterator<Item = T>,
    key: impl Fn(&T) -> K,
) -> Vec<(K, Vec<T>)> {
    let mut groups: Vec<(K, Vec<T>)> = Vec::new();
    for item in items {
        let key = key(&item);
        match groups.iter_mut().find(|(other, _)| *other == key) {
            Some((_, group)) => group.push(item),
            None => groups.push((key, vec![item])),
        }
    }
    groups
}

/// Gathers rows; curves come in the order of their first rows.
pub fn curves(rows: &[Row], abscissa: Key) -> Vec<Curve> {
    let groups = grouped(rows, |row| identity(row, abscissa));
    let identities: Vec<Identity> = groups.iter().map(|(i, _)| i.clone()).collect();
    let curve = |(identity, rows): (Identity, Vec<&Row>)| {
        // No limit of the path length lies beyond all limits.
        let x = |row: &Row| row.value(abscissa).parse().unwrap_or(f64::INFINITY);
        let points = grouped(rows.into_iter().cloned(), x).into_iter();
        let mut points: Vec<Point> = points.map(|(x, rows)| Point { x, rows }).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        Curve {
            label: label(&identity, &identities),
            renderer: identity[0].clone(),
            points,
        }
    };
    groups.into_iter().map(curve).collect()
}

/// Texts that name a curve beside the values of axes.
const TEXTS: usize = 4;

/// What names a curve: program, scene, panel and settings, and the values of all axes but the
/// abscissa.
type Identity = [String; TEXTS + Key::ALL.len()];

fn identity(row: &Row, abscissa: Key) -> Identity {
    let mut identity = Identity::default();
    let texts = [&row.renderer, &row.scene, &row.panel, &row.settings];
    for (own, text) in identity
        .iter_mut()
        .zip(texts.into_iter().chain(&row.values))
    {
        text.clone_into(own);
    }
    identity[TEXTS + abscissa as usize].clear();
    identity
}

/// What distinguishes a curve among all.
fn label(own: &Identity, all: &[Identity]) -> String {
    let varies = |i: usize| move |other: &&Identity| other[i] != own[i];
    let texts = (0..TEXTS)
        .filter(|i| all.iter().any(|other| varies(*i)(&other)))
        .map(|i| own[i].clone());
    let values = Key::ALL.into_iter().filter_map(|key| {
        let i = TEXTS + key as usize;
        // What programs call by other names says nothing across them.
        let mut siblings = all.iter().filter(|other| other[0] == own[0]);
        let shown = key == Key::Sampler || siblings.any(|other| varies(i)(&other));
        (shown && !own[i].is_empty()).then(|| match key {
            Key::Sampler | Key::Precision => own[i].clone(),
            Key::Wavelengths | Key::Scrambles | Key::Spp => format!("{} {}", own[i], key.column()),
            Key::MaxDepth | Key::Finder => format!("{} {}", key.column(), own[i]),
        })
    });
    let words = texts.filter(|text| !text.is_empty()).chain(values);
    words.collect::<Vec<_>>().join(", ")
}

/// The least root mean squared error of all points that have one.
pub fn best(curves: &[Curve]) -> f64 {
    let points = curves.iter().flat_map(|curve| &curve.points);
    points
        .map(|point| point.rmse().value)
        .filter(|error| *error > 0.0)
        .fold(f64::INFINITY, f64::min)
}

/// Seconds and relative mean squared errors of the points that no other beats in both, by rising
/// seconds.
pub fn front<'a>(curves: impl IntoIterator<Item = &'a Curve>) -> Vec<(f64, f64)> {
    let points = curves.into_iter().flat_map(Curve::above_floor);
    let mean = |point: &Point| {
        let seconds = point.mean(|row| row.seconds).value;
        (seconds, point.mean(|row| row.relmse).value)
    };
    let above_zero = |(seconds, error): &(f64, f64)| *seconds > 0.0 && *error > 0.0;
    let mut front: Vec<_> = points.map(mean).filter(above_zero).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut least = f64::INFINITY;
    front.retain(|(_, error)| {
        let better = *error < least;
        least = least.min(*error);
        better
    });
    front
}
