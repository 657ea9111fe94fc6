//! The points of a study: every combination of the values of its axes.

use super::StudyError;
use super::axis::Axis;
use crate::chart::Key;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Grid {
    /// The axis that a curve runs along.
    pub abscissa: Axis,
    /// The axes whose combinations are the curves.
    pub others: Vec<Axis>,
}

/// The values of the axes at a point.
pub type Choices = Vec<(Key, String)>;

/// Keys that can be the abscissa, the first of them preferred.
const ABSCISSAE: [Key; 4] = [Key::Spp, Key::MaxDepth, Key::Scrambles, Key::Wavelengths];

impl Grid {
    /// The grid over these axes; `None` where none of them can be the abscissa.
    ///
    /// # Errors
    /// [`StudyError::Twice`].
    pub fn new(axes: &[Axis]) -> Result<Option<Self>, StudyError> {
        let mut axes = axes.to_vec();
        let twice = |(i, axis): (usize, &Axis)| axes[..i].iter().any(|a| a.key == axis.key);
        if let Some(at) = axes.iter().enumerate().position(twice) {
            return Err(StudyError::Twice(axes[at].key.column()));
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

    /// All points, curve by curve, each in the order of its abscissa.
    pub fn points(&self) -> Vec<Choices> {
        let axes = self.others.iter().chain([&self.abscissa]);
        axes.fold(vec![Vec::new()], |points, axis| {
            let with = |point: Choices| {
                let values = axis.values.iter();
                values.map(move |value| [&point[..], &[(axis.key, value.clone())]].concat())
            };
            points.into_iter().flat_map(with).collect()
        })
    }
}
