//! A picture to be rendered: a scene, its plan, and what is wanted of it.

use std::time::Duration;

use super::bins::{BinGrid, Bins};
use super::goal::{Chosen, Goal, choose};
use super::layers::Layer;
use super::memory::{TooLarge, available};
use super::seeds::seed;
use super::session::{Progress, Rendered, Request, Unwatched, render};
use super::tile::{Outside, Window};
use crate::film::pixels::{Estimate, Pixels};
use crate::math::instructions::Instructions;
use crate::plan::explain::explain;
use crate::plan::{Plan, PlanError};
use crate::scene::Scene;

/// Most samples a pixel: as many as the samplers have points.
pub const MOST_SAMPLES: u32 = 1 << 24;

/// A picture to be made of a scene: all of it, until the scene's samples are done, unless fields
/// and methods say otherwise.
///
/// [`run`](Self::run) renders; [`picture`](Self::picture) makes channels and attributes of that.
#[derive(Debug)]
pub struct Render {
    scene: Scene,
    plan: Plan,
    crop: Option<Window>,
    goal: Option<Goal>,
    /// Wall-clock time after which no further pass begins.
    pub time: Option<Duration>,
    /// Instruction set; the bits are the same with each.
    pub instructions: Instructions,
    /// Layers about the first surface that each pixel shows.
    pub layers: Vec<Layer>,
    /// Spectral bins besides R, G, B.
    pub spectral: Option<BinGrid>,
}

impl Render {
    /// Plans a scene.
    ///
    /// # Errors
    /// [`PlanError`] where the scene cannot be carried out.
    pub fn new(scene: Scene) -> Result<Self, PlanError> {
        let plan = Plan::new(&scene, false)?;
        Ok(Self::planned(scene, plan))
    }

    /// Takes a plan that was made of the same scene.
    pub fn planned(scene: Scene, plan: Plan) -> Self {
        Self {
            scene,
            plan,
            crop: None,
            goal: None,
            time: None,
            instructions: Instructions::best(),
            layers: Vec::new(),
            spectral: None,
        }
    }

    /// Renders only these pixels; coordinates are those of the whole picture.
    ///
    /// # Errors
    /// [`Outside`] where there are none, or not all of them are in the picture.
    pub fn cropped(mut self, crop: Window) -> Result<Self, Outside> {
        let size = self.scene.image.size;
        if !crop.is_inside(&Window::whole(size)) {
            return Err(Outside { window: crop, size });
        }
        self.crop = Some(crop);
        Ok(self)
    }

    /// The scene as it is rendered.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// How the scene is rendered.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// How the scene is rendered, and why, line by line.
    pub fn explain(&self) -> Vec<String> {
        explain(&self.scene, &self.plan)
    }

    /// The part of the picture that is wanted, if not all of it.
    pub fn crop(&self) -> Option<Window> {
        self.crop
    }

    /// The wanted error that the samples were chosen for, if they were.
    pub fn goal(&self) -> Option<Goal> {
        self.goal
    }

    /// The pixels wanted: the crop, or the whole picture.
    pub fn window(&self) -> Window {
        self.crop
            .unwrap_or_else(|| Window::whole(self.scene.image.size))
    }

    /// Renders with other random numbers from now on, as if `image.seed` were this.
    pub fn reseed(&mut self, seed: u64) {
        self.scene.set_seed(seed);
        self.plan.reseed(seed);
    }

    /// Renders, on the threads of the current `rayon` pool. The bits do not depend on how many
    /// there are.
    pub fn run(&self) -> Rendered {
        self.run_watched(&mut Unwatched)
    }

    /// As [`run`](Self::run), with a call of `progress` after each pass.
    pub fn run_watched(&self, progress: &mut dyn Progress) -> Rendered {
        let request = Request {
            window: self.window(),
            samples: self.scene.image.spp,
            time: self.time,
            instructions: self.instructions,
            bins: self.spectral.as_ref(),
        };
        render(&self.plan, &request, progress)
    }

    /// Checks that the picture fits into memory.
    ///
    /// # Errors
    /// [`TooLarge`] where it takes more than the system says it can give.
    pub fn check_memory(&self) -> Result<(), TooLarge> {
        let (needed, available) = (self.memory(), available());
        if needed > available {
            return Err(TooLarge { needed, available });
        }
        Ok(())
    }

    /// Bytes of the finished picture: the sums of each pixel, the estimate made of them, and the
    /// channels of the file, of which the writer makes a copy.
    fn memory(&self) -> u64 {
        // R, G, B, their standard errors, and the count of samples.
        const CHANNELS: usize = 7;
        let bins = self.spectral.as_ref();
        let bins = bins.map_or(0, |grid| grid.centres().len());
        let (replicates, samples) = (self.plan.choices.replicates, self.scene.image.spp);
        let sums = Pixels::bytes_per_pixel(replicates, samples)
            + bins * Bins::bytes_per_pixel(replicates, samples);
        let layers: usize = self.layers.iter().map(|layer| layer.channels()).sum();
        let channels = CHANNELS + layers + 2 * bins;
        let pixel = sums + size_of::<Estimate>() + 2 * channels * size_of::<f32>();
        let window = self.window();
        let pixels = u64::from(window.width()) * u64::from(window.height());
        pixels.saturating_mul(pixel as u64)
    }
}

/// Choosing the samples.
impl Render {
    /// Takes as many samples as the wanted error needs. Pilots with seeds of their own choose the
    /// number and are thrown away, so that the choice does not bend the picture (see
    /// [`goal`](super::goal)). `None` where `progress` stopped them; nothing has changed then.
    ///
    /// # Errors
    /// [`PlanError`] where the scene cannot be carried out with that number.
    pub fn aim(
        &mut self,
        goal: Goal,
        progress: &mut dyn Progress,
    ) -> Result<Option<Chosen>, PlanError> {
        let planned = self.scene.image.spp;
        let mut failed = None;
        let pixels = self.window().pixels();
        let chosen = choose(goal, pixels, MOST_SAMPLES, |samples, number| {
            let pilot = self.pilot(samples, number, progress);
            pilot.unwrap_or_else(|error| {
                failed = Some(error);
                None
            })
        });
        match chosen {
            Some(chosen) => {
                self.scene.set_samples(chosen.samples);
                self.goal = Some(goal);
            }
            None => self.scene.image.spp = planned,
        }
        self.plan = Plan::new(&self.scene, self.plan.choices.full)?;
        failed.map_or(Ok(chosen), Err)
    }

    /// Renders this many samples a pixel with the seed of pilot `number`; `None` where `progress`
    /// stopped it.
    fn pilot(
        &mut self,
        samples: u32,
        number: u32,
        progress: &mut dyn Progress,
    ) -> Result<Option<Rendered>, PlanError> {
        self.scene.image.spp = samples;
        if self.scene.image.sampler.needs_count() {
            self.plan = Plan::new(&self.scene, self.plan.choices.full)?;
        }
        self.plan
            .reseed(seed(self.scene.image.seed, "pilot", number));
        let request = Request {
            window: self.window(),
            instructions: self.instructions,
            ..Request::whole(self.scene.image.size, samples)
        };
        let rendered = render(&self.plan, &request, progress);
        Ok((rendered.samples == samples).then_some(rendered))
    }
}
