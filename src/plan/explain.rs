//! The plan in words.

use std::collections::BTreeMap;

use super::bounds::{Blur, GAP_SHARE, PIXEL_SHARE};
use super::choose::Precision;
use super::{Plan, of_model};
use crate::film::pixels::Pixels;
use crate::integrate::needs::Needs;
use crate::math::lanes::Scalar;
use crate::sample::replicates::Replicates;
use crate::scene::{FinderChoice, Lens, Object, Scene, Shape};

/// As many names as a line lists.
const LISTED: usize = 6;

/// What the scene holds, what the loop needs for it, and what was chosen and why, line by line.
pub fn explain(scene: &Scene, plan: &Plan) -> Vec<String> {
    let mut lines = vec![picture(scene), objects(scene), camera(scene, plan.needs())];
    lines.extend(lights(scene, plan));
    lines.push(kept(plan.needs()));
    lines.extend(omitted(plan));
    lines.push(wavelengths(scene, plan));
    lines.push(precision(plan));
    lines.push(intersection(scene, plan));
    lines.push(sampler(scene, plan));
    lines.push(depth(scene));
    lines.push(memory(scene, plan));
    for light in &plan.left_out {
        lines.push(format!(
            "light left out: {light}, which paths from the camera cannot carry"
        ));
    }
    lines
}

fn picture(scene: &Scene) -> String {
    let image = &scene.image;
    let panel = scene.panel.as_ref();
    let panel = panel.map_or_else(String::new, |name| format!(", panel {name}"));
    let ([width, height], spp) = (image.size, image.spp);
    let path = &scene.source.path;
    format!("{path}{panel}: {width} × {height} pixels, {spp} camera paths each")
}

/// How often each word occurs, the words in alphabetical order.
fn counted(words: impl Iterator<Item = String>) -> String {
    let mut counts = BTreeMap::<String, usize>::new();
    for word in words {
        *counts.entry(word).or_default() += 1;
    }
    let counts = counts.into_iter();
    let counts: Vec<String> = counts.map(|(word, n)| format!("{n} {word}")).collect();
    counts.join(", ")
}

fn objects(scene: &Scene) -> String {
    if scene.objects.is_empty() {
        return "objects: none".to_owned();
    }
    let objects = scene.objects.iter().map(|object| {
        let material = scene.material_of(&object.value);
        let emits = material.emission.as_ref().map_or("", |_| ", emitting");
        let shape = shape_kind(&object.value);
        format!("{shape} ({}{emits})", material.surface.words())
    });
    format!("objects: {}", counted(objects))
}

fn shape_kind(object: &Object) -> String {
    let Shape::Implicit(implicit) = &object.shape else {
        return object.shape.name().to_owned();
    };
    let what = match &implicit.field.polynomial {
        Some(polynomial) => format!("of degree {}", polynomial.degree()),
        None => format!("of {} operations", implicit.field.tape.operations().len()),
    };
    match implicit.name {
        Some(name) => format!("implicit {name} {what}"),
        None => format!("implicit surface {what}"),
    }
}

fn camera(scene: &Scene, needs: Needs) -> String {
    match (scene.camera.lens, needs.lens) {
        (Some(Lens { radius, focus }), _) => {
            format!("camera: a lens of radius {radius}, sharp at distance {focus}")
        }
        (None, true) => "camera: no lens, yet its numbers are drawn".to_owned(),
        (None, false) => "camera: no lens, whose two numbers are not drawn".to_owned(),
    }
}

/// A sampled light: its object if it has one, what it is called else, how it is sampled, and how often.
struct Sampled {
    object: u32,
    kind: &'static str,
    how: &'static str,
    probability: f64,
}

fn lights(scene: &Scene, plan: &Plan) -> Vec<String> {
    let sampled: Vec<Sampled> = of_model!(&plan.tables, model => {
        let lights = model.lights.iter().map(|light| Sampled {
            object: light.object,
            kind: light.shape.name(),
            how: light.shape.strategy(),
            probability: light.probability.to_f64(),
        });
        lights.collect()
    });
    let mut by_strategy = BTreeMap::<&str, Vec<String>>::new();
    for light in &sampled {
        let object = scene.objects.get(light.object as usize);
        let name = object.map_or(light.kind, |object| object.name.as_str());
        let share = 100.0 * light.probability;
        let names = by_strategy.entry(light.how).or_default();
        names.push(format!("{name} ({share:.0} %)"));
    }
    let lines = by_strategy.iter();
    let mut lines: Vec<String> = lines
        .map(|(how, names)| format!("lights sampled {how}: {}", listed(names)))
        .collect();
    let found = found_only(scene, &sampled);
    if !found.is_empty() {
        let names = listed(&found);
        lines.push(format!("lights that only scattered rays find: {names}"));
    }
    if lines.is_empty() {
        lines.push("lights: none, so the picture is black".to_owned());
    }
    lines
}

/// What emits and is not sampled.
fn found_only(scene: &Scene, sampled: &[Sampled]) -> Vec<String> {
    let emitting = scene.objects.iter().enumerate().filter(|(index, object)| {
        let emits = scene.material_of(&object.value).emission.is_some();
        emits && !sampled.iter().any(|light| light.object as usize == *index)
    });
    let mut found: Vec<String> = emitting.map(|(_, object)| object.name.clone()).collect();
    if scene.environment.is_some() {
        found.push("the environment".to_owned());
    }
    found
}

/// Names, shortened when there are many.
fn listed(names: &[String]) -> String {
    let shown = names.len().min(LISTED);
    let mut text = names[..shown].join(", ");
    if names.len() > shown {
        text.push_str(&format!(" … and {} more", names.len() - shown));
    }
    text
}

/// The branches of the loop that are in it, or are not.
fn named(needs: Needs, wanted: bool) -> Vec<&'static str> {
    let kept = needs.branches().filter(|(_, needed)| *needed == wanted);
    kept.map(|(name, _)| name).collect()
}

fn kept(needs: Needs) -> String {
    match named(needs, true).as_slice() {
        [] => "in the loop: nothing but the environment".to_owned(),
        names => format!("in the loop: {}", names.join(", ")),
    }
}

fn omitted(plan: &Plan) -> Option<String> {
    if plan.choices.full {
        return Some("left out of the loop: nothing, as asked for".to_owned());
    }
    let names = named(plan.needs(), false).join(", ");
    (!names.is_empty()).then(|| format!("left out of the loop, as nothing here needs it: {names}"))
}

fn wavelengths(scene: &Scene, plan: &Plan) -> String {
    let count = plan.choices.wavelengths;
    let objects = scene.objects.iter();
    let disperse = objects.filter(|o| scene.material_of(&o.value).surface.disperses());
    let names: Vec<String> = disperse.map(|object| object.name.clone()).collect();
    if names.is_empty() {
        format!("wavelengths: {count} a path; nothing disperses, so all live to the end")
    } else {
        format!(
            "wavelengths: {count} a path; all but one end where it is refracted by {}",
            listed(&names)
        )
    }
}

fn precision(plan: &Plan) -> String {
    let choices = &plan.choices;
    let (name, verdict) = match choices.precision {
        Precision::Single => ("single (f32)", "suffices"),
        Precision::Double => ("double (f64)", "because single does not suffice"),
    };
    if choices.asked {
        let doubt = doubt(plan).map_or_else(String::new, |doubt| format!("; {doubt}"));
        return format!("precision: {name}, as asked for{doubt}");
    }
    if choices.implicit {
        return format!(
            "precision: {name}: hits on implicit surfaces are proved in double, and rays leave from \
             where they are"
        );
    }
    format!(
        "precision: {name} {verdict}: in single, {}",
        bound(choices.blur)
    )
}

/// How far off positions may be in single precision.
fn bound(blur: Blur) -> String {
    let Blur {
        position, pixels, ..
    } = blur;
    let gap = blur.gap.map_or_else(
        || "no two objects have a gap between them".to_owned(),
        |gap| {
            let share = position / gap;
            format!("{share:.1e} of the smallest gap, {gap:.3e} (allowed {GAP_SHARE})")
        },
    );
    format!(
        "positions are off by at most {position:.1e}, and by at most {pixels:.1e} of a pixel's width \
         there (allowed {PIXEL_SHARE}); {gap}"
    )
}

/// What speaks against the precision that was asked for, if anything does.
pub fn doubt(plan: &Plan) -> Option<String> {
    let choices = &plan.choices;
    let single = choices.asked && choices.precision == Precision::Single;
    if !single || choices.single_suffices() {
        return None;
    }
    if !choices.implicit {
        return Some(format!(
            "double would have been taken, because in single {}",
            bound(choices.blur)
        ));
    }
    let position = choices.blur.position;
    Some(format!(
        "double would have been taken: hits on implicit surfaces are proved in double and then \
         rounded to single, which puts them off by up to {position:.1e}, so that sheets closer than {:.1e} \
         may be taken one for the other",
        position / GAP_SHARE
    ))
}

fn intersection(scene: &Scene, plan: &Plan) -> String {
    let (hierarchy, occluders) = of_model!(&plan.tables, model => {
        (model.hierarchy.is_some(), model.occluders.objects.len())
    });
    let count = scene.objects.len();
    let way = match (hierarchy, count) {
        (true, _) => format!("a hierarchy of boxes over {count} objects"),
        (false, 1) => "each ray asks a list of 1 object".to_owned(),
        (false, _) => format!("each ray asks a list of {count} objects"),
    };
    let mut text =
        format!("intersection: {way}; what lanes leave undecided goes to the exact ladder");
    if occluders < count {
        text.push_str(&format!(
            "; shadow rays ask {occluders}, as the others can hide no light"
        ));
    }
    let finders: Vec<FinderChoice> = of_model!(&plan.tables, model => {
        let implicits = model.implicits.iter();
        implicits.map(|(_, implicit)| implicit.finder.kind).collect()
    });
    for kind in FinderChoice::ALL.iter().rev() {
        let count = finders.iter().filter(|finder| *finder == kind).count();
        if count > 0 {
            text.push_str(&format!("; {count} implicit by {}", kind.words()));
        }
    }
    text
}

fn sampler(scene: &Scene, plan: &Plan) -> String {
    let name = scene.image.sampler.words();
    let replicates = plan.choices.replicates;
    let reached = replicates.count(scene.image.spp);
    let law = match replicates {
        Replicates::Fixed(_) => "",
        Replicates::Growing => ", growing with the samples",
    };
    let error = if reached > 1 {
        "from which the standard error comes"
    } else {
        "so that the standard error stays unknown"
    };
    format!("sampler: {name}; replicates: {reached}{law}, {error}")
}

fn depth(scene: &Scene) -> String {
    scene.image.max_depth.map_or_else(
        || "paths: of any length; Russian roulette ends them without bias".to_owned(),
        |n| format!("paths: at most {n} segments; some go on to measure what that cuts off"),
    )
}

fn memory(scene: &Scene, plan: &Plan) -> String {
    let [width, height] = scene.image.size.map(u64::from);
    let pixel = Pixels::bytes_per_pixel(plan.choices.replicates, scene.image.spp);
    let sums = width * height * pixel as u64;
    let spectra = of_model!(&plan.tables, model => model.spectra.bytes());
    let [sums, spectra] = [sums as f64, spectra as f64].map(|bytes| bytes / f64::from(1 << 20));
    format!("memory: {sums:.1} MiB of sums, {spectra:.1} MiB of spectra")
}
