//! The plan: what this scene needs, decided once, built once, and explained in words.
//!
//! [`choose`] decides by what [`contents`] and [`bounds`] find in the scene and by what the user asks
//! for; [`build`] makes the flat tables of the loop, and with them the list of what can happen there;
//! [`explain`] says why.

pub mod bounds;
pub mod build;
pub mod choose;
pub mod contents;
pub mod explain;
pub mod occluders;

use crate::integrate::develop::Spectrometer;
use crate::integrate::model::Model;
use crate::integrate::needs::Needs;
use crate::scene::Scene;
use crate::spectrum::grid::WavelengthGrid;
use choose::Choices;

/// A scene ready to render.
#[derive(Debug)]
pub struct Plan {
    /// The decisions.
    pub choices: Choices,
    /// The tables, in the chosen precision.
    pub tables: Tables,
    /// The cells of wavelength that all spectra are averaged over.
    pub grid: WavelengthGrid,
    /// Names of lights that unidirectional paths cannot carry everywhere, with the reason.
    pub left_out: Vec<String>,
}

/// Evaluates an expression about the model, in whichever precision it is.
macro_rules! of_model {
    ($tables:expr, $model:ident => $do:expr) => {
        match $tables {
            $crate::plan::Tables::Single(tables) => {
                let $model = &tables.0;
                $do
            }
            $crate::plan::Tables::Double(tables) => {
                let $model = &tables.0;
                $do
            }
        }
    };
}
use of_model;

/// Tables of the loop in one precision.
#[derive(Debug)]
pub enum Tables {
    /// Single precision.
    Single(Box<(Model<f32>, Spectrometer<f32>)>),
    /// Double precision.
    Double(Box<(Model<f64>, Spectrometer<f64>)>),
}

/// Why a valid scene cannot be planned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A transform that is invertible on paper but not in the range of f64.
    #[error(
        "object \"{name}\": its transform cannot be inverted in double precision about the camera"
    )]
    NotInvertible {
        /// The object's name.
        name: String,
    },
    /// More wavelengths than the loop is compiled for.
    #[error("{count} wavelengths per path: the loop is built for 4 and 8")]
    Wavelengths {
        /// What was asked for.
        count: u32,
    },
}

impl Plan {
    /// Plans a scene; `full` switches on everything that could be left out.
    ///
    /// # Errors
    /// [`PlanError`] where the scene cannot be carried out.
    pub fn new(scene: &Scene, full: bool) -> Result<Self, PlanError> {
        let choices = choose::choose(scene, full)?;
        let grid = WavelengthGrid::new(contents::spectra(scene));
        let tables = match choices.precision {
            choose::Precision::Single => {
                Tables::Single(Box::new(build::build(scene, &choices, &grid)?))
            }
            choose::Precision::Double => {
                Tables::Double(Box::new(build::build(scene, &choices, &grid)?))
            }
        };
        Ok(Self {
            choices,
            tables,
            grid,
            left_out: contents::left_out(scene),
        })
    }

    /// What can happen in the loop.
    pub fn needs(&self) -> Needs {
        of_model!(&self.tables, model => model.needs)
    }

    /// Takes other random numbers: the plan is then that of the scene with this seed.
    pub fn reseed(&mut self, seed: u64) {
        match &mut self.tables {
            Tables::Single(scene) => scene.0.sequence = scene.0.sequence.reseeded(seed),
            Tables::Double(scene) => scene.0.sequence = scene.0.sequence.reseeded(seed),
        }
    }
}
