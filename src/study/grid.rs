//! The points of a study: every combination of the values of its axes.

use super::axis::Axis;
use crate::chart::Key;

/// One axis as abscissa, the others as curves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grid {
    /// The axis that a curve runs along.
    pub abscissa: Axis,
    /// The axes whose combinations are the curves.
    pub others: Vec<Axis>,
}

/// A point of the grid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Point {
    pub curve: usize,
    /// What is chosen there.
    pub choices: Vec<(Key, String)>,
}

/// What is wrong with a grid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GridError {
    /// One axis given twice.
    #[error("the axis {0} is given twice")]
    Twice(&'static str),
}

/// Keys that can be the abscissa, the most wanted first.
const ABSCISSAE: [Key; 4] = [Key::Spp, Key::MaxDepth, Key::Scrambles, Key::Wavelengths];

impl Grid {
    /// The grid over these axes; `None` where none of them can be the abscissa.
    ///
    /// # Errors
    /// [`GridError::Twice`].
    pub fn new(axes: &[Axis]) -> Result<Option<Self>, GridError> {
        let mut axes = axes.to_vec();
        let twice = |(i, axis): (usize, &Axis)| axes[..i].iter().any(|a| a.key == axis.key);
        if let Some(at) = axes.iter().enumerate().position(twice) {
            return Err(GridError::Twice(axes[at].key.column()));
        }
        let abscissa = ABSCISSAE
            .into_iter()
            .find_map(|key| axes.iter().position(|a| a.key == key && a.values.len() > 1))
            .or_else(|| axes.iter().position(|axis| axis.key == Key::Spp));
        Ok(abscissa.map(|at| Self {
            abscissa: axes.remove(at),
            others: axes,
        }))
    }

    /// The combinations of the values of the other axes.
    pub fn curves(&self) -> Vec<Vec<(Key, String)>> {
        self.others.iter().fold(vec![Vec::new()], |curves, axis| {
            let with = |curve: &Vec<(Key, String)>, value: &String| {
                let mut curve = curve.clone();
                curve.push((axis.key, value.clone()));
                curve
            };
            let each = |curve| axis.values.iter().map(move |value| with(curve, value));
            curves.iter().flat_map(each).collect()
        })
    }

    /// All points, curve by curve, each in the order of its abscissa.
    pub fn points(&self) -> Vec<Point> {
        let mut points = Vec::new();
        for (curve, choices) in self.curves().into_iter().enumerate() {
            for value in &self.abscissa.values {
                let mut choices = choices.clone();
                choices.push((self.abscissa.key, value.clone()));
                points.push(Point { curve, choices });
            }
        }
        points
    }
}

impl Point {
    /// What is chosen for this key, if it is an axis.
    pub fn choice(&self, key: Key) -> Option<&str> {
        let found = self.choices.iter().find(|(other, _)| *other == key);
        found.map(|(_, value)| value.as_str())
    }
}
