//! `etalon compare`: picture against picture, or against a number.

mod text;

use std::path::{Path, PathBuf};

use etalon::inside::compare::stale::{Freshness, different_scenes, freshness};
use etalon::inside::compare::write_heatmap;
use etalon::{Attribute, CompareError, Comparison, Side};
use serde::Serialize;

use super::args::Compare;
use super::{Answer, Failure, say};

/// What is printed, as text or as JSON.
#[derive(Serialize)]
struct Report {
    /// The picture.
    a: PathBuf,
    /// The picture that it is compared with, or the number.
    #[serde(skip_serializing_if = "Option::is_none")]
    b: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<f64>,
    /// Width and height in pixels.
    size: [usize; 2],
    #[serde(flatten)]
    comparison: Comparison,
    /// The relative difference at the ends of the heat map's scale.
    heatmap_scale: Option<f64>,
    notes: Vec<String>,
}

pub fn run(arguments: &Compare) -> Result<Answer, Failure> {
    let read = |path: &Path| Side::read(path).map_err(|error| words(&error));
    let a = read(&arguments.a)?;
    let b = arguments.b.as_deref().map(read).transpose()?;
    let report = match (&b, arguments.truth) {
        (Some(b), _) => with_picture(arguments, &a, b)?,
        (None, Some(truth)) => with_number(&a, truth),
        (None, None) => return Err("nothing to compare with".into()),
    };
    if arguments.json {
        say(&serde_json::to_string_pretty(&report)?)?;
    } else {
        say(text::text(&report).trim_end())?;
    }
    match &report.comparison.judgement {
        Some(judgement) if judgement.consistent => Ok(Answer::Good),
        Some(_) => Ok(Answer::No),
        None => Err(format!("no verdict: {}", why_not(&a, b.as_ref())).into()),
    }
}

/// Why pictures cannot be compared, and what to type.
fn words(error: &CompareError) -> String {
    match error {
        CompareError::NotFinite { .. } => {
            format!("{error}: render it again, or find out with etalon replay where they come from")
        }
        CompareError::Sizes { .. } => format!("{error} (etalon render --size)"),
        other => other.to_string(),
    }
}

fn with_picture(arguments: &Compare, a: &Side, b: &Side) -> Result<Report, Failure> {
    let comparison = Comparison::of_sides(a, b).map_err(|error| words(&error))?;
    let stale = [a, b].map(stale);
    if let Some(difference) = different_scenes(a, b) {
        let words: Vec<String> = [Some(difference)]
            .into_iter()
            .chain(stale)
            .flatten()
            .collect();
        return Err(words.join("; ").into());
    }
    if let (None, Some(words)) = (a.text("sceneHash"), &stale[1]) {
        return Err(words.clone().into());
    }
    let mut notes: Vec<String> = stale.into_iter().flatten().collect();
    notes.extend(only_one(a, b));
    notes.extend(other_lengths(a, b));
    let heatmap_scale = match &arguments.heatmap {
        Some(path) => write_heatmap(path, a, b)?,
        None => None,
    };
    if arguments.heatmap.is_some() && heatmap_scale.is_none() {
        notes.push("no heat map: a picture has no R, G, B".to_owned());
    }
    Ok(Report {
        a: a.path.clone(),
        b: Some(b.path.clone()),
        truth: None,
        size: [a.width, a.height],
        comparison,
        heatmap_scale,
        notes,
    })
}

fn with_number(a: &Side, truth: f64) -> Report {
    Report {
        a: a.path.clone(),
        b: None,
        truth: Some(truth),
        size: [a.width, a.height],
        comparison: Comparison::with_truth(a, truth),
        heatmap_scale: None,
        notes: stale(a).into_iter().collect(),
    }
}

/// A note about a picture whose scene has changed since it was rendered. Scene files are looked for
/// from the current directory and from every directory above the picture.
fn stale(side: &Side) -> Option<String> {
    let path = side
        .path
        .canonicalize()
        .unwrap_or_else(|_| side.path.clone());
    let roots = std::iter::once(Path::new("")).chain(path.ancestors().skip(1));
    let found = roots
        .map(|root| freshness(side, root))
        .find(|found| !matches!(found, Freshness::Missing(_)));
    match found {
        Some(Freshness::Stale(scene)) => Some(format!(
            "{} is stale: {} has changed since it was made",
            side.path.display(),
            scene.display()
        )),
        _ => None,
    }
}

/// Notes about channels that only one picture has.
fn only_one(a: &Side, b: &Side) -> Vec<String> {
    let missing = |from: &Side, other: &Side| {
        let names: Vec<&str> = from
            .channels
            .iter()
            .filter(|channel| other.channel(&channel.name).is_none())
            .map(|channel| channel.name.as_str())
            .collect();
        (!names.is_empty())
            .then(|| format!("only {} has {}", from.path.display(), names.join(", ")))
    };
    [missing(a, b), missing(b, a)]
        .into_iter()
        .flatten()
        .collect()
}

/// A note about pictures whose paths may have different lengths.
fn other_lengths(a: &Side, b: &Side) -> Option<String> {
    let [own, others] = [a, b].map(|side| match side.attribute("maxDepth")? {
        Attribute::Int(depth) => Some(depth.to_string()),
        Attribute::Text(text) => Some(text.clone()),
        _ => None,
    });
    let (own, others) = (own?, others?);
    (own != others).then(|| {
        format!(
            "{} was made with max_depth {own} and {} with {others}",
            a.path.display(),
            b.path.display()
        )
    })
}

fn why_not(a: &Side, b: Option<&Side>) -> String {
    let names: Vec<String> = std::iter::once(a)
        .chain(b)
        .filter(|side| side.freedom.is_none())
        .map(|side| side.path.display().to_string())
        .collect();
    if names.is_empty() {
        return "no channel has variances in both pictures".to_owned();
    }
    format!(
        "{} says no variance of its pixels (channels standard_error.… or variance.…, and the \
         attribute replicates, at least 2): etalon render --replicates 8 writes them",
        names.join(" and ")
    )
}
