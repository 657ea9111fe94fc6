//! From sums to a picture: channels, standard errors, and where it comes from.

use std::fmt::Write as _;

use super::builder::Render;
use super::layers;
use super::session::{Rendered, Share};
use super::trace::Singular;
use crate::film::provenance::Provenance;
use crate::film::{Attribute, Channel, Picture, names};
use crate::integrate::intersect::Rungs;
use crate::plan::choose::Precision;

impl Render {
    /// The picture of what [`run`](Self::run) has rendered: R, G, B and their standard errors, the
    /// count of samples, the layers asked for, and all that it takes to make it again.
    ///
    /// # Errors
    /// [`Singular`] where layers are wanted of an object whose matrix has no inverse.
    pub fn picture(&self, rendered: &Rendered) -> Result<Picture, Singular> {
        let window = rendered.window;
        let mut picture = Picture::new(window.width() as usize, window.height() as usize);
        let estimates = rendered.rgb();
        let single = |v: [f64; 3]| v.map(|v| v as f32);
        let mean: Vec<_> = estimates.iter().map(|e| single(e.mean)).collect();
        picture.push_triple(names::BEAUTY, names::RGB, &mean);
        if rendered.replicates() > 1 {
            let errors: Vec<_> = estimates.iter().map(|e| single(e.standard_error)).collect();
            picture.push_triple(names::STANDARD_ERROR, names::RGB, &errors);
        }
        let samples = vec![rendered.samples; window.pixels()];
        picture
            .channels
            .push(Channel::integer(names::SAMPLES, samples));
        let (scene, instructions) = (self.scene(), self.instructions);
        layers::push(&mut picture, &self.layers, scene, window, instructions)?;
        if let Some(grid) = &self.spectral {
            layers::push_spectral(&mut picture, grid, rendered);
        }
        let limited = self.scene().image.max_depth.is_some();
        let cut_off = limited.then(|| rendered.cut_off());
        let provenance = self.provenance(rendered, cut_off);
        picture.attributes.extend(provenance);
        self.further(&mut picture, rendered, cut_off);
        Ok(picture)
    }

    fn provenance(&self, rendered: &Rendered, cut_off: Option<Share>) -> Vec<(String, Attribute)> {
        let (scene, plan) = (self.scene(), self.plan());
        let error = rendered.mean_luminance().standard_error;
        let provenance = Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene_path: scene.source.path.clone(),
            scene_text: scene.source.text.clone(),
            panel: scene.panel.clone(),
            seed: scene.image.seed,
            spp: rendered.samples.into(),
            sampler: scene.image.sampler.name().to_owned(),
            replicates: rendered.replicates(),
            precision: plan.choices.precision.name().to_owned(),
            wavelengths: plan.choices.wavelengths,
            plan: self.explain().join("\n"),
            max_depth: scene.image.max_depth,
            seconds: rendered.seconds,
            samples_per_second: rendered.samples_per_second(),
            nan_count: rendered.not_a_number,
            standard_error: error.is_finite().then_some(error),
            energy_cut: cut_off.map(|share| share.value),
            lights_left_out: plan.left_out.clone(),
        };
        provenance.attributes()
    }

    /// What is known beyond the provenance of every picture.
    fn further(&self, picture: &mut Picture, rendered: &Rendered, cut_off: Option<Share>) {
        let scene = self.scene();
        let mut add = |name: &str, value| picture.attributes.push((name.to_owned(), value));
        let settings = scene.source.set.iter();
        let settings: Vec<_> = settings
            .map(|(key, value)| format!("{key}={value}"))
            .collect();
        if !settings.is_empty() {
            add("settings", Attribute::Text(settings.join("\n")));
        }
        if let Some(crop) = self.crop() {
            let [width, height] = scene.image.size;
            add(
                "crop",
                Attribute::Text(format!("{crop} of {width}x{height}")),
            );
        }
        let instructions = self.instructions.name().to_owned();
        add("instructions", Attribute::Text(instructions));
        let rungs = rungs(&rendered.rungs, self.plan().choices.precision);
        add("rungs", Attribute::Text(rungs));
        let planned = scene.image.spp;
        if rendered.samples < planned && scene.image.sampler.needs_count() {
            add("sppPlanned", Attribute::Text(planned.to_string()));
        }
        if let Some(goal) = self.goal() {
            add("targetError", Attribute::Double(goal.error));
        }
        if let Some(share) = cut_off {
            let error = Attribute::Double(share.standard_error);
            add("energyCutStandardError", error);
        }
    }
}

/// Who has decided the rays, as shares.
fn rungs(rungs: &Rungs, precision: Precision) -> String {
    let share = |part: u64, whole: u64| part as f64 / whole.max(1) as f64;
    let ladder = rungs.ladder;
    let questions = ladder.double + ladder.double_double + ladder.exact;
    let mut text = format!(
        "{} rays: {:.9} decided in lanes of {}, {:.9} taken to the ladder; its {questions} \
         questions: {:.9} decided in f64, {:.9} in double-double, {:.9} exactly",
        rungs.rays,
        share(rungs.rays - rungs.undecided.min(rungs.rays), rungs.rays),
        precision.name(),
        share(rungs.undecided, rungs.rays),
        share(ladder.double, questions),
        share(ladder.double_double, questions),
        share(ladder.exact, questions),
    );
    let implicit = rungs.implicit;
    let rays = implicit.rays();
    if rays > 0 {
        let _ = write!(
            text,
            "; {rays} questions about implicit surfaces: {:.9} decided in f64, {:.9} in \
             double-double, {:.9} exactly, {} undecided, {} not certified",
            share(implicit.double, rays),
            share(implicit.double_double, rays),
            share(implicit.exact, rays),
            implicit.undecided,
            implicit.uncertified,
        );
    }
    text
}
