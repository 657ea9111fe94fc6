//! The scene of a study at each of its points: loaded, planned, ready to be rendered again and
//! again.

use std::path::PathBuf;
use std::time::Duration;

use super::grid::Point;
use super::seeds::seed;
use crate::chart::Key;
use crate::plan::choose::Precision;
use crate::plan::{Plan, PlanError};
use crate::render::{Instructions, Progress, Rendered, Request, render};
use crate::scene::{self, Overrides, Scene, SceneError};

/// What is studied and on what.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The scene file.
    pub path: PathBuf,
    /// What is laid over it at every point.
    pub overrides: Overrides,
    /// Instruction set.
    pub instructions: Instructions,
}

/// Why a point cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum SubjectError {
    /// The scene is not valid there.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// It cannot be planned.
    #[error("at {at}: {reason}")]
    Plan {
        /// What is chosen there.
        at: String,
        /// What the plan says.
        reason: PlanError,
    },
}

/// A scene ready to be rendered with any seed.
#[derive(Debug)]
pub struct Ready {
    pub scene: Scene,
    pub plan: Plan,
    /// What names it among the renders of the study.
    pub name: String,
    instructions: Instructions,
    base_seed: u64,
}

impl Subject {
    /// The scene at a point.
    ///
    /// # Errors
    /// [`SubjectError`] where it is not valid or cannot be planned.
    pub fn at(&self, point: &Point) -> Result<Ready, SubjectError> {
        let mut overrides = self.overrides.clone();
        for (key, value) in &point.choices {
            if *key == Key::Finder {
                overrides.finder = Some(value.clone());
            } else {
                let key = format!("image.{}", key.image_key());
                overrides.set.push((key, value.clone()));
            }
        }
        self.ready(&overrides, named(&point.choices))
    }

    /// The scene with these overrides instead.
    ///
    /// # Errors
    /// [`SubjectError`] where it is not valid or cannot be planned.
    pub fn ready(&self, overrides: &Overrides, name: String) -> Result<Ready, SubjectError> {
        let scene = scene::load(&self.path, overrides)?;
        let plan = Plan::new(&scene, false).map_err(|reason| SubjectError::Plan {
            at: name.clone(),
            reason,
        })?;
        Ok(Ready {
            base_seed: scene.image.seed,
            scene,
            plan,
            name,
            instructions: self.instructions,
        })
    }
}

/// Choices in words.
pub fn named(choices: &[(Key, String)]) -> String {
    let said: Vec<_> = choices
        .iter()
        .map(|(key, value)| format!("{}={value}", key.column()))
        .collect();
    said.join(" ")
}

impl Ready {
    /// The seed of one of its renders.
    pub fn seed(&self, replicate: u32) -> u64 {
        seed(self.base_seed, &self.name, replicate)
    }

    /// Renders with the seed of this replicate, the scene's number of samples.
    pub fn render(&mut self, replicate: u32, progress: &mut dyn Progress) -> Rendered {
        self.render_for(self.seed(replicate), self.scene.image.spp, None, progress)
    }

    /// Renders at most so many samples a pixel for at most so long.
    pub fn render_for(
        &mut self,
        seed: u64,
        samples: u32,
        time: Option<Duration>,
        progress: &mut dyn Progress,
    ) -> Rendered {
        self.plan.reseed(seed);
        let request = Request {
            time,
            instructions: self.instructions,
            ..Request::whole(self.scene.image.size, samples)
        };
        render(&self.plan, &request, progress)
    }

    /// What a table says about each choice; empty is the renderer's own choice, or no limit.
    pub fn values(&self, point: &Point) -> [String; Key::ALL.len()] {
        let image = &self.scene.image;
        let number = |n: Option<u32>| n.map(|n| n.to_string()).unwrap_or_default();
        Key::ALL.map(|key| {
            if let Some(value) = point.choice(key) {
                return value.to_owned();
            }
            match key {
                Key::Spp => image.spp.to_string(),
                Key::Sampler => image.sampler.name().to_owned(),
                Key::Precision => match self.plan.choices.precision {
                    Precision::Single => "f32".to_owned(),
                    Precision::Double => "f64".to_owned(),
                },
                Key::Wavelengths => self.plan.choices.wavelengths.to_string(),
                Key::MaxDepth => number(image.max_depth),
                Key::Finder => String::new(),
                Key::Scrambles => number(image.replicates),
            }
        })
    }
}
