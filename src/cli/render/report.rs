//! What is printed when a render has ended.

use std::fmt::Write as _;

use etalon::inside::render::goal::reached;
use etalon::inside::scene::Image;
use etalon::{Chosen, Rendered, Scene, Target};

use super::super::progress::interrupted;
use super::super::quoted;
use super::job::Job;

/// What was measured, in lines; `chosen` is how pilots chose the samples, and the seconds that took.
pub fn lines(job: &Job, rendered: &Rendered, chosen: Option<(Chosen, f64)>) -> String {
    let image = &job.render.scene().image;
    let mut text = format!("{}: ", job.output.display());
    if interrupted() && rendered.samples < image.spp {
        text.push_str("interrupted after ");
    }
    text.push_str(&count(image, rendered));
    let _ = write!(
        text,
        " in {:.2} s, {:.2} M samples/s; mean luminance {}",
        rendered.seconds,
        rendered.samples_per_second() * 1e-6,
        luminance(rendered)
    );
    if image.max_depth.is_some() {
        let share = rendered.cut_off();
        let _ = write!(
            text,
            "; cut off by max_depth {} ± {}",
            percent(share.value),
            percent(share.standard_error)
        );
    }
    if let (Some(goal), Some((chosen, seconds))) = (job.render.goal(), chosen) {
        let _ = write!(
            text,
            "; {} {} reached, {} asked for{}; pilots of {} spp in {seconds:.2} s chose the samples",
            match goal.target {
                Target::Image => "error of the mean",
                Target::Block => "error of the worst block",
            },
            percent(reached(rendered, goal.target)),
            percent(goal.error),
            if chosen.short {
                ", which takes more samples than can be had"
            } else {
                ""
            },
            chosen.spent,
        );
    }
    let _ = write!(text, "; {} NaN", rendered.not_a_number);
    if let Some(command) = replay(job.render.scene(), rendered) {
        let _ = write!(text, "\nfirst NaN: {command}");
    }
    text
}

/// The samples reached. Strata are cut for a number of samples, and stay cut for it.
fn count(image: &Image, rendered: &Rendered) -> String {
    let (done, planned) = (rendered.samples, image.spp);
    if done < planned && image.sampler.needs_count() {
        format!("{done} spp (of strata for {planned})")
    } else {
        format!("{done} spp")
    }
}

fn luminance(rendered: &Rendered) -> String {
    let mean = rendered.mean_luminance();
    if mean.standard_error.is_nan() {
        return format!("{:.6}, standard error unknown with 1 replicate", mean.value);
    }
    let relative = mean
        .relative_error()
        .map_or_else(String::new, |relative| format!(" ({})", percent(relative)));
    format!("{:.6} ± {:.2e}{relative}", mean.value, mean.standard_error)
}

/// A share as a percentage with three significant digits.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent == 0.0 {
        return "0 %".to_owned();
    }
    let decimals = 2.0 - percent.abs().log10().floor();
    if (0.0..7.0).contains(&decimals) {
        format!("{percent:.*} %", decimals as usize)
    } else {
        format!("{percent:.2e} %")
    }
}

/// The command that follows the first sample that was not a number.
fn replay(scene: &Scene, rendered: &Rendered) -> Option<String> {
    let first = rendered.first_not_a_number?;
    let mut text = format!("etalon replay {}", quoted(&scene.source.path));
    if let Some(panel) = &scene.panel {
        let _ = write!(text, " --panel {}", quoted(panel));
    }
    for (key, value) in &scene.source.set {
        let _ = write!(text, " --set {}", quoted(&format!("{key}={value}")));
    }
    let _ = write!(
        text,
        " --pixel {},{} --sample {}",
        first.x, first.y, first.sample
    );
    Some(text)
}
