//! The scene of a study at each of its points: loaded, planned, ready to be rendered again and
//! again.

use std::path::PathBuf;
use std::time::Duration;

use super::StudyError;
use super::grid::Choices;
use crate::chart::Key;
use crate::plan::Plan;
use crate::render::seeds::seed;
use crate::render::{Instructions, Progress, Rendered, Request, render};
use crate::scene::{self, Overrides, Scene};

/// The scene that is studied, and the instruction set that renders it.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The scene file.
    pub path: PathBuf,
    /// Settings that replace the file's at every point.
    pub overrides: Overrides,
    pub instructions: Instructions,
}

/// A scene ready to be rendered with any seed.
#[derive(Debug)]
pub struct Ready {
    pub scene: Scene,
    pub plan: Plan,
    /// Its settings in words, unique in the study: the seeds of its renders are made from them.
    pub name: String,
    instructions: Instructions,
}

impl Subject {
    /// The settings in [`Self::overrides`], `key=value` separated by spaces.
    pub fn settings(&self) -> String {
        let set = self.overrides.set.iter();
        let set = set.map(|(key, value)| format!("{key}={value}"));
        set.collect::<Vec<_>>().join(" ")
    }

    /// The scene at a point.
    ///
    /// # Errors
    /// [`StudyError`] where it is not valid or cannot be planned.
    pub fn at(&self, choices: &Choices) -> Result<Ready, StudyError> {
        let mut overrides = self.overrides.clone();
        for (key, value) in choices {
            let key = match key {
                Key::Finder => {
                    overrides.finder = Some(value.clone());
                    continue;
                }
                Key::Scrambles => "replicates",
                other => other.column(),
            };
            let setting = (format!("image.{key}"), value.clone());
            overrides.set.push(setting);
        }
        let name = choices
            .iter()
            .map(|(key, value)| format!("{}={value}", key.column()))
            .collect::<Vec<_>>();
        self.ready(&overrides, name.join(" "))
    }

    /// The scene with these overrides instead.
    ///
    /// # Errors
    /// [`StudyError`] where it is not valid or cannot be planned.
    pub fn ready(&self, overrides: &Overrides, name: String) -> Result<Ready, StudyError> {
        let scene = scene::load(&self.path, overrides)?;
        let plan = Plan::new(&scene, false).map_err(|reason| StudyError::Plan {
            at: name.clone(),
            reason,
        })?;
        Ok(Ready {
            scene,
            plan,
            name,
            instructions: self.instructions,
        })
    }
}

impl Ready {
    /// The seed of one of its renders.
    pub fn seed(&self, replicate: u32) -> u64 {
        seed(self.scene.image.seed, &self.name, replicate)
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.scene.image.size.map(|n| n as usize)
    }

    /// Renders with the seed of this replicate, the scene's number of samples.
    pub fn render(&mut self, replicate: u32, progress: &mut dyn Progress) -> Rendered {
        self.render_for(self.seed(replicate), self.scene.image.spp, None, progress)
    }

    /// Renders at most `samples` samples a pixel, for at most `time`.
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

    /// Each setting as it stands in a table; empty is the renderer's own choice, or no limit.
    pub fn values(&self, choices: &Choices) -> [String; Key::ALL.len()] {
        let image = &self.scene.image;
        let number = |n: Option<u32>| n.map(|n| n.to_string()).unwrap_or_default();
        Key::ALL.map(|key| {
            if let Some((_, value)) = choices.iter().find(|(other, _)| *other == key) {
                return value.clone();
            }
            match key {
                Key::Spp => image.spp.to_string(),
                Key::Sampler => image.sampler.name().to_owned(),
                Key::Precision => self.plan.choices.precision.name().to_owned(),
                Key::Wavelengths => self.plan.choices.wavelengths.to_string(),
                Key::MaxDepth => number(image.max_depth),
                Key::Finder => String::new(),
                Key::Scrambles => number(image.replicates),
            }
        })
    }
}
