//! `etalon coverage`: are the error bars of scenes and samplers honest?

use std::fmt::Write as _;
use std::path::Path;

use etalon::inside::study::StudyError;
use etalon::inside::study::choice::stem;
use etalon::inside::study::coverage::{Count, Coverage, SURVEY, Survey, cover};
use etalon::inside::study::subject::Subject;
use etalon::{Instructions, Overrides, Scene};

use super::{Answer, Failure, args, say, scene_words, threads, write};

/// Samples of the survey over those of a tested render. What the survey has not seen contributes
/// to a tested render with a probability of a sixteenth at most, on average.
const SURVEY_SHARE: u32 = 16;
/// Shares of blocks between which 95 % intervals are honest.
const HONEST: [f64; 2] = [0.93, 0.97];
/// Edge of blocks: pictures are whole blocks where they can be.
const BLOCK: u32 = etalon::inside::stats::blocks::EDGE as u32;

pub fn run(arguments: &args::Coverage) -> Result<Answer, Failure> {
    let pool = threads(arguments.threads)?;
    let mut table = String::from("scene,sampler,spp,enough,enough_held,few,few_held\n");
    let mut total = Coverage::default();
    for path in &arguments.scenes {
        for (sampler, coverage) in pool.install(|| test(arguments, path))? {
            total = total.plus(coverage);
            say(&line(&stem(path), &sampler, coverage))?;
            let Coverage { enough, few } = coverage;
            // Writing to a string cannot fail.
            let _ = writeln!(
                table,
                "{},{sampler},{},{},{},{},{}",
                stem(path),
                arguments.spp,
                enough.all,
                enough.held,
                few.all,
                few.held
            );
        }
    }
    say(&line("all", "all", total))?;
    if let Some(path) = &arguments.output {
        write(path, &table)?;
    }
    let share = total.enough.share();
    let honest = share.is_nan() || (HONEST[0]..=HONEST[1]).contains(&share);
    Ok(if honest { Answer::Good } else { Answer::No })
}

/// Tests one scene with each sampler.
fn test(arguments: &args::Coverage, path: &Path) -> Result<Vec<(String, Coverage)>, Failure> {
    let failed = |error| match error {
        StudyError::Scene(error) => scene_words(&error),
        other => other.to_string(),
    };
    let mut overrides = Overrides {
        set: arguments.set.clone(),
        ..Overrides::default()
    };
    let scene = Scene::load_with(path, &overrides).map_err(|error| scene_words(&error))?;
    let [width, height] = scene.image.size;
    let scale = f64::from(arguments.edge) / f64::from(width.max(height));
    let pixels = |n: u32| {
        let scaled = f64::from(n) * scale / f64::from(BLOCK);
        (scaled.round() as u32).max(1) * BLOCK
    };
    let size = format!("[{}, {}]", pixels(width), pixels(height));
    overrides.set.push(("image.size".to_owned(), size));
    let subject = Subject {
        path: path.to_owned(),
        overrides,
        instructions: Instructions::best(),
    };
    let with = |name: &str, settings: &[(&str, String)]| {
        let mut overrides = subject.overrides.clone();
        let settings = settings.iter();
        overrides
            .set
            .extend(settings.map(|(key, value)| (format!("image.{key}"), value.clone())));
        subject.ready(&overrides, name.to_owned()).map_err(failed)
    };
    let survey = [
        ("sampler", "independent".to_owned()),
        ("spp", SURVEY.to_string()),
        ("replicates", SURVEY.to_string()),
    ];
    let renders = (SURVEY_SHARE * arguments.spp).div_ceil(SURVEY);
    let blocks = Survey::new(&mut with("survey", &survey)?, renders).blocks();
    let mut all = Vec::new();
    for sampler in &arguments.samplers {
        let settings = [
            ("sampler", sampler.clone()),
            ("spp", arguments.spp.to_string()),
        ];
        let mut ready = with(sampler, &settings)?;
        let coverage = (0..arguments.renders)
            .map(|render| cover(&mut ready, render, &blocks))
            .fold(Coverage::default(), Coverage::plus);
        all.push((sampler.clone(), coverage));
    }
    Ok(all)
}

fn line(scene: &str, sampler: &str, coverage: Coverage) -> String {
    let Coverage { enough, few } = coverage;
    let all = (enough.all + few.all).max(1);
    let share = |count: Count| {
        if count.all == 0 {
            "     -".to_owned()
        } else {
            format!("{:5.2} %", 100.0 * count.share())
        }
    };
    format!(
        "{scene:18} {sampler:12} {} of {:7} blocks with enough contributing samples held; {} of {:6} with fewer \
         ({:.1} % of all)",
        share(enough),
        enough.all,
        share(few),
        few.all,
        100.0 * few.all as f64 / all as f64
    )
}
