//! From sums to a picture: channels, standard errors and provenance.

use std::fmt::Write as _;

use super::builder::Render;
use super::layers;
use super::session::Rendered;
use super::trace::Singular;
use crate::film::{Attribute, Channel, Picture, hash, names};
use crate::integrate::intersect::Tiers;
use crate::plan::choose::Precision;

impl Render {
    /// The picture of what [`run`](Self::run) has rendered: R, G, B and their standard errors, the
    /// count of samples, the layers asked for, and everything needed to render it again.
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
        picture.attributes.extend(self.provenance(rendered));
        Ok(picture)
    }

    /// Everything needed to render the picture again, and what is known about its error.
    ///
    /// What does not apply is absent, but an absent limit of the path length is said as the text
    /// "unlimited"; whole numbers that need more than 31 bits, and the seed always, are decimal text.
    fn provenance(&self, rendered: &Rendered) -> Vec<(String, Attribute)> {
        let (scene, plan) = (self.scene(), self.plan());
        let (source, image) = (&scene.source, &scene.image);
        let text = |value: &str| Some(Attribute::Text(value.to_owned()));
        let count = |value: u64| Some(Attribute::whole_number(value));
        let double = |value: f64| Some(Attribute::Double(value));
        let settings = source
            .set
            .iter()
            .map(|(key, value)| format!("{key}={value}"));
        let settings = settings.collect::<Vec<_>>().join("\n");
        let settings = Some(settings).filter(|_| !source.set.is_empty());
        let strata = rendered.samples < image.spp && image.sampler.needs_count();
        let planned = strata.then(|| image.spp.to_string());
        let [width, height] = image.size;
        let crop = self
            .crop()
            .map(|crop| format!("{crop} of {width}x{height}"));
        let error = rendered.mean_luminance().standard_error;
        let depth = image.max_depth;
        let cut_off = depth.map(|_| rendered.cut_off());
        let (cut, cut_error) = cut_off.map(|cut| (cut.value, cut.standard_error)).unzip();
        let depth = depth.map_or(text("unlimited"), |depth| count(depth.into()));
        // Some readers drop empty texts, and "none" is an answer.
        let lights = match plan.left_out.join(", ") {
            lights if lights.is_empty() => "none".to_owned(),
            lights => lights,
        };
        let tiers = tiers(&rendered.tiers, plan.choices.precision);
        let attributes = [
            ("etalonVersion", text(env!("CARGO_PKG_VERSION"))),
            ("sceneFile", text(&source.path)),
            ("sceneHash", text(&hash(&source.text))),
            ("sceneText", text(&source.text)),
            ("panel", scene.panel.as_deref().and_then(text)),
            ("settings", settings.as_deref().and_then(text)),
            ("seed", text(&image.seed.to_string())),
            ("spp", count(rendered.samples.into())),
            ("sppPlanned", planned.as_deref().and_then(text)),
            ("sampler", text(image.sampler.name())),
            ("replicates", count(rendered.replicates().into())),
            ("precision", text(plan.choices.precision.name())),
            ("wavelengths", count(plan.choices.wavelengths.into())),
            ("instructions", text(self.instructions.name())),
            ("plan", text(&self.explain().join("\n"))),
            ("tiers", text(&tiers)),
            ("maxDepth", depth),
            ("crop", crop.as_deref().and_then(text)),
            (
                "targetError",
                self.goal().and_then(|goal| double(goal.error)),
            ),
            ("seconds", double(rendered.seconds)),
            ("samplesPerSecond", double(rendered.samples_per_second())),
            ("nanCount", count(rendered.not_a_number)),
            ("standardError", double(error).filter(|_| error.is_finite())),
            ("energyCutByMaxDepth", cut.and_then(double)),
            ("energyCutStandardError", cut_error.and_then(double)),
            ("lightsLeftOut", text(&lights)),
        ];
        let known = |(name, value): (&str, Option<_>)| Some((name.to_owned(), value?));
        attributes.into_iter().filter_map(known).collect()
    }
}

/// Shares of rays and questions that each arithmetic has decided.
fn tiers(tiers: &Tiers, precision: Precision) -> String {
    let share = |part: u64, whole: u64| part as f64 / whole.max(1) as f64;
    let decided = |parts: [u64; 3], whole: u64| {
        let [double, double_double, exact] = parts.map(|part| share(part, whole));
        format!(
            "{double:.9} decided in f64, {double_double:.9} in double-double, {exact:.9} exactly"
        )
    };
    let ladder = tiers.ladder;
    let parts = [ladder.double, ladder.double_double, ladder.exact];
    let questions = parts.iter().sum();
    let mut text = format!(
        "{} rays: {:.9} decided in lanes of {}, {:.9} taken to the ladder; its {questions} \
         questions: {}",
        tiers.rays,
        share(tiers.rays - tiers.undecided.min(tiers.rays), tiers.rays),
        precision.name(),
        share(tiers.undecided, tiers.rays),
        decided(parts, questions),
    );
    let implicit = tiers.implicit;
    let rays = implicit.rays();
    if rays > 0 {
        let parts = [implicit.double, implicit.double_double, implicit.exact];
        let _ = write!(
            text,
            "; {rays} questions about implicit surfaces: {}, {} undecided, {} not certified",
            decided(parts, rays),
            implicit.undecided,
            implicit.uncertified,
        );
    }
    text
}
