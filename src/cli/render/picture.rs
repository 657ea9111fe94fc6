//! From sums to channels and attributes.

use std::fmt::Write as _;

use etalon::film::provenance::Provenance;
use etalon::film::{Attribute, Channel, Picture, names};
use etalon::plan::choose::Precision;
use etalon::plan::explain;
use etalon::render::Instructions;

use super::super::args::Render;
use super::super::error::CommandError;
use super::job::Job;
use super::layers;
use super::report::{Outcome, settings};

/// The picture with all its layers and where it comes from.
pub fn assemble(
    arguments: &Render,
    job: &Job,
    outcome: &Outcome<'_>,
    instructions: Instructions,
) -> Result<Picture, CommandError> {
    let rendered = outcome.rendered;
    let window = job.window;
    let mut picture = Picture::new(window.width() as usize, window.height() as usize);
    let estimates = rendered.rgb();
    let single = |v: [f64; 3]| v.map(|v| v as f32);
    let mean: Vec<_> = estimates.iter().map(|e| single(e.mean)).collect();
    picture.push_triple(names::BEAUTY, names::RGB, &mean);
    let replicates = job.plan.choices.replicates.count(rendered.samples);
    if replicates > 1 {
        let errors: Vec<_> = estimates.iter().map(|e| single(e.standard_error)).collect();
        picture.push_triple(names::STANDARD_ERROR, names::RGB, &errors);
    }
    let samples = vec![rendered.samples; window.pixels()];
    picture
        .channels
        .push(Channel::integer(names::SAMPLES, samples));
    layers::push(&mut picture, arguments, job, rendered)?;
    picture
        .attributes
        .extend(provenance(job, outcome, replicates).attributes());
    further(&mut picture, arguments, job, outcome, instructions);
    Ok(picture)
}

fn provenance(job: &Job, outcome: &Outcome<'_>, replicates: u32) -> Provenance {
    let rendered = outcome.rendered;
    let scene = &job.scene;
    let error = rendered.mean_luminance().standard_error;
    let limited = scene.image.max_depth.is_some();
    Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene_path: scene.source.path.clone(),
        scene_text: scene.source.text.clone(),
        panel: scene.panel.clone(),
        seed: scene.image.seed,
        spp: rendered.samples.into(),
        sampler: scene.image.sampler.name().to_owned(),
        replicates,
        precision: match job.plan.choices.precision {
            Precision::Single => "f32",
            Precision::Double => "f64",
        }
        .to_owned(),
        wavelengths: job.plan.choices.wavelengths,
        plan: explain::explain(scene, &job.plan).join("\n"),
        max_depth: scene.image.max_depth,
        seconds: rendered.seconds,
        samples_per_second: outcome.samples_per_second(),
        nan_count: rendered.not_a_number,
        standard_error: error.is_finite().then_some(error),
        energy_cut: limited.then(|| rendered.cut_off().value),
        lights_left_out: job.plan.left_out.clone(),
    }
}

/// What this command knows beyond the provenance of every picture.
fn further(
    picture: &mut Picture,
    arguments: &Render,
    job: &Job,
    outcome: &Outcome<'_>,
    instructions: Instructions,
) {
    let rendered = outcome.rendered;
    let mut text = |name: &str, value: String| {
        let attribute = (name.to_owned(), Attribute::Text(value));
        picture.attributes.push(attribute);
    };
    let settings: Vec<_> = settings(arguments, job)
        .iter()
        .map(|(key, value)| format!("{key}={value}"))
        .collect();
    if !settings.is_empty() {
        text("settings", settings.join("\n"));
    }
    if let Some(crop) = arguments.crop {
        let ([x0, y0], [x1, y1]) = (crop.from, crop.to);
        let [width, height] = job.scene.image.size;
        text("crop", format!("{x0},{y0},{x1},{y1} of {width}x{height}"));
    }
    text("instructions", instructions.name().to_owned());
    text("rungs", rungs(outcome, job));
    let planned = job.scene.image.spp;
    if rendered.samples < planned && job.scene.image.sampler.needs_count() {
        text("sppPlanned", planned.to_string());
    }
    if let Some(error) = arguments.target_error {
        let attribute = ("targetError".to_owned(), Attribute::Double(error));
        picture.attributes.push(attribute);
    }
    if job.scene.image.max_depth.is_some() {
        let name = "energyCutStandardError".to_owned();
        let error = Attribute::Double(rendered.cut_off().standard_error);
        picture.attributes.push((name, error));
    }
}

/// Who has decided the rays, as shares.
fn rungs(outcome: &Outcome<'_>, job: &Job) -> String {
    let rungs = outcome.rendered.rungs;
    let share = |part: u64, whole: u64| part as f64 / whole.max(1) as f64;
    let lanes = match job.plan.choices.precision {
        Precision::Single => "f32",
        Precision::Double => "f64",
    };
    let ladder = rungs.ladder;
    let questions = ladder.double + ladder.double_double + ladder.exact;
    let mut text = format!(
        "{} rays: {:.9} decided in lanes of {lanes}, {:.9} taken to the ladder; its {questions} \
         questions: {:.9} decided in f64, {:.9} in double-double, {:.9} exactly",
        rungs.rays,
        share(rungs.rays - rungs.undecided.min(rungs.rays), rungs.rays),
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
