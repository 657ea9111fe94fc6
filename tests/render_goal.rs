//! Renders that stop at a wanted error: unbiased, and near what was asked for; and error bars of
//! blocks that hold as often as they say.

use etalon::inside::render::goal::{choose, reached};
use etalon::inside::render::{Instructions, Unwatched};
use etalon::inside::study::coverage::{Coverage, Survey, cover};
use etalon::inside::study::subject::{Ready, Subject};
use etalon::{Estimate, Goal, Overrides, Rendered, Target};

use crate::statistics_support::moments;
use crate::support::Folder;

/// A small lamp over a floor, in a black room: most paths bring nothing.
const SCENE: &str = r#"
camera = { from = [0, 2, 4], to = [0, 0, 0], fov = 50 }
image = { size = [8, 8], spp = 8, max_depth = 3 }
materials.floor = { diffuse = 0.7 }
materials.lamp = { emit = 20 }
object = [
    { shape = { rectangle = { size = [3, 3] } }, material = "floor", transform = [{ rotate_x = -90 }] },
    { shape = { sphere = { radius = 0.15 } }, material = "lamp", transform = [{ translate = [0.4, 0.6, 0] }] },
]
"#;

/// The scene with settings of its image.
fn ready(settings: &[(&str, &str)]) -> Ready {
    let folder = Folder::new(SCENE);
    let subject = Subject {
        path: folder.path("scene.toml"),
        overrides: Overrides::default(),
        instructions: Instructions::best(),
    };
    let set = settings.iter();
    let set = set.map(|(key, value)| (format!("image.{key}"), (*value).to_owned()));
    let overrides = Overrides {
        set: set.collect(),
        ..Overrides::default()
    };
    subject.ready(&overrides, "test".to_owned()).unwrap()
}

fn render(ready: &mut Ready, seed: u64, samples: u32) -> Rendered {
    ready.render_for(seed, samples, None, &mut Unwatched)
}

fn goal(target: Target, error: f64) -> Goal {
    Goal { target, error }
}

const WANTED: f64 = 0.05;
const RENDERS: u64 = 1000;
/// Of each of the two tests of means below: one false alarm in ten thousand.
const LEVEL: f64 = 1e-4;

/// The mean of many renders with a fixed number of samples, and its error.
fn truth(ready: &mut Ready) -> Estimate {
    let render = |i: u64| render(ready, 1_000_000 + i, 512).mean_luminance().value;
    Estimate::mean(&(0..200).map(render).collect::<Vec<f64>>())
}

#[test]
fn a_goal_is_reached_without_bending_the_picture() {
    let mut ready = ready(&[("sampler", "independent")]);
    let truth = truth(&mut ready);
    let goal = goal(Target::Image, WANTED);
    let (mut means, mut samples) = (Vec::new(), 0);
    for run in 0..RENDERS {
        let chosen = choose(goal, 64, 1 << 20, |samples, number| {
            let seed = (run << 20) + 1 + u64::from(number);
            Some(render(&mut ready, seed, samples))
        })
        .unwrap();
        assert!(!chosen.short);
        samples += u64::from(chosen.samples);
        let rendered = render(&mut ready, run << 20, chosen.samples);
        means.push(rendered.mean_luminance().value);
    }
    let stopped = Estimate::mean(&means);
    let p = stopped.minus(&truth).p_value(0.0, 0.0);
    assert!(p > LEVEL, "biased: {stopped:?}, {truth:?}, p = {p}");
    let (mean, variance) = moments(&means);
    let error = variance.sqrt() / mean;
    let spp = samples / RENDERS;
    let words = format!("{error} reached, {WANTED} asked for, {spp} spp on average");
    assert!((error / WANTED - 1.0).abs() < 0.2, "{words}");
}

#[test]
fn a_render_that_stops_on_its_own_samples_would_be_noticed() {
    let mut ready = ready(&[("sampler", "independent")]);
    let truth = truth(&mut ready);
    // Eight replicates of four pixels' worth: small pilots that end as soon as they look good.
    let mut means = Vec::new();
    for run in 0..RENDERS {
        let mut samples = 2;
        loop {
            let rendered = render(&mut ready, run, samples);
            if reached(&rendered, Target::Image) <= 3.0 * WANTED || samples >= 64 {
                means.push(rendered.mean_luminance().value);
                break;
            }
            samples += 2;
        }
    }
    let stopped = Estimate::mean(&means);
    let p = stopped.minus(&truth).p_value(0.0, 0.0);
    assert!(p < LEVEL, "{stopped:?}, {truth:?}, p = {p}");
}

/// The largest relative standard error of a block that so many samples truly have, from many
/// renders with them.
fn true_worst_block(ready: &mut Ready, samples: u32) -> f64 {
    const MANY: u64 = 30;
    let mut sums: Vec<f64> = Vec::new();
    for run in 0..MANY {
        let rendered = render(ready, (1 << 40) + run, samples);
        let blocks = rendered.block_luminances();
        sums.resize(blocks.len(), 0.0);
        for (sum, block) in sums.iter_mut().zip(&blocks) {
            let relative = block.standard_error / block.value.max(f64::MIN_POSITIVE);
            *sum += relative * relative / MANY as f64;
        }
    }
    sums.into_iter().fold(0.0, f64::max).sqrt()
}

#[test]
fn the_worst_block_reaches_its_goal_too() {
    let goal = goal(Target::Block, WANTED);
    for sampler in ["independent", "stratified", "sobol"] {
        let ready = |samples: u32| {
            let size = ("size", "[24, 16]");
            ready(&[("sampler", sampler), size, ("spp", &samples.to_string())])
        };
        const RUNS: u64 = 50;
        let mut square = 0.0;
        for run in 0..RUNS {
            let chosen = choose(goal, 24 * 16, 1 << 20, |samples, number| {
                let seed = (run << 20) + 1 + u64::from(number);
                Some(render(&mut ready(samples), seed, samples))
            });
            let samples = chosen.unwrap().samples;
            square += true_worst_block(&mut ready(samples), samples).powi(2);
        }
        // Root of the mean square over runs, as for the picture's mean above.
        let ratio = (square / RUNS as f64).sqrt() / WANTED;
        assert!((0.8..1.2).contains(&ratio), "{sampler}: {ratio:.3}");
    }
}

#[test]
fn a_goal_that_needs_more_than_can_be_had_says_so() {
    let mut ready = ready(&[]);
    let goal = goal(Target::Image, 1e-6);
    let chosen = choose(goal, 64, 64, |samples, number| {
        Some(render(&mut ready, u64::from(number), samples))
    });
    let chosen = chosen.unwrap();
    assert!(chosen.short);
    assert_eq!(chosen.samples, 64);
    assert_eq!(choose(goal, 64, 64, |_, _| None), None, "stopped");
}

#[test]
fn intervals_of_blocks_hold_as_often_as_they_say() {
    let size = ("size", "[64, 48]");
    let survey = [
        ("sampler", "independent"),
        ("spp", "64"),
        ("replicates", "64"),
        size,
    ];
    let mut survey = ready(&survey);
    let blocks = Survey::new(&mut survey, 16).blocks();
    for sampler in ["independent", "stratified", "sobol"] {
        let mut ready = ready(&[("sampler", sampler), ("spp", "64"), size]);
        let test = |ready: &mut Ready, blocks: &[_]| {
            let renders = (0..24).map(|render| cover(ready, render, blocks));
            renders.fold(Coverage::default(), Coverage::plus)
        };
        let honest = test(&mut ready, &blocks).enough;
        // A binomial standard error of 1.3 % with 300 blocks, three of those, and the percentage
        // point that the threshold leaves.
        assert!(honest.all >= 300, "{honest:?}");
        let share = honest.share();
        assert!((0.90..=1.0).contains(&share), "{sampler}: {share}");
        // A truth that is off by three standard errors is held in few.
        let mut wrong = blocks.clone();
        for block in wrong.iter_mut().flatten() {
            block.truth.value *= 1.5;
        }
        let noticed = test(&mut ready, &wrong).enough;
        assert!(noticed.share() < 0.5, "{sampler}: {}", noticed.share());
    }
}
