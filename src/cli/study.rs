//! `etalon study`: error over samples and seconds, for a grid of choices.

use std::path::{Path, PathBuf};

use etalon::inside::chart::{self, Curve, Figure, Key, curves, figures};
use etalon::inside::study::budget::{BudgetError, Fits};
use etalon::inside::study::own::MARGIN;
use etalon::inside::study::reference::ReferenceError;
use etalon::inside::study::run::{Request, Study, run as run_study};
use etalon::inside::study::subject::Subject;
use etalon::inside::study::{StudyError, choice, report};

use super::progress::{Studying, listen};
use super::{Answer, Failure, args, quoted, say, scene_words, tell, threads, write};

/// Carries out a study, or goes on with one, and draws its charts.
pub fn run(arguments: &args::Study) -> Result<Answer, Failure> {
    let threads = threads(arguments.threads)?;
    listen();
    let request = request(arguments, threads.current_num_threads() as u32);
    let study = threads.install(|| run_study(&request, &mut Studying::new(arguments.quiet)));
    let study = study.map_err(|error| words(&error))?;
    publish(&request, &study)?;
    say(&summary(&request, &study))?;
    if !study.complete && !arguments.quiet {
        tell("note: interrupted; the same command goes on where this one stopped");
    }
    Ok(Answer::Good)
}

/// Why a study failed, and what to type instead.
fn words(error: &StudyError) -> String {
    match error {
        StudyError::OneReplicate => format!("--replicates: {error}"),
        StudyError::Other { .. } => {
            format!("{error}; choose another directory with -o, or remove that one")
        }
        StudyError::Scene(scene) => scene_words(scene),
        StudyError::Twice(_) => {
            format!("{error}: put all its values into one --over")
        }
        StudyError::Reference(ReferenceError::NoVariance(_)) => {
            format!("{error}, or use --reference auto")
        }
        StudyError::Reference(ReferenceError::Size { found: [x, y], .. }) => format!(
            "{error}: set the scene's size with --set 'image.size=[{x}, {y}]', or use another \
             reference"
        ),
        StudyError::Budget(BudgetError::Memory { size: [x, y], .. }) => {
            format!("{error} (--set 'image.size=[{x}, {y}]')")
        }
        StudyError::Budget(BudgetError::Seconds {
            needed,
            budget,
            enough,
            fits,
        }) => {
            let instead = match fits {
                Fits::AxisTo(_) => ",",
                Fits::Samples(n) => &format!(" (--set image.spp={n}),"),
                Fits::NoSamples => "; use fewer --replicates,",
                Fits::NoAxisTo(_) => {
                    "; use fewer --replicates or curves, a smaller --set image.size,"
                }
            };
            format!(
                "the study would take about {needed:.0} s, its reference included, and --budget is \
                 {budget:.0} s: {fits}{instead} or --budget {enough:.0}"
            )
        }
        other => other.to_string(),
    }
}

fn request(arguments: &args::Study, threads: u32) -> Request {
    let scene = &arguments.scene;
    let directory = arguments.output.clone().unwrap_or_else(|| {
        let name = choice::stem(&scene.scene);
        let panel = scene.panel.iter().map(|panel| format!("-{panel}"));
        PathBuf::from(format!("{name}{}-study", panel.collect::<String>()))
    });
    let words = std::env::args_os().skip(1);
    let words = words.map(|word| quoted(&word.to_string_lossy()));
    Request {
        subject: Subject {
            path: scene.scene.clone(),
            overrides: scene.overrides(&[]),
            instructions: arguments.instructions,
        },
        axes: arguments.over.clone(),
        replicates: arguments.replicates,
        reference: arguments.reference.clone(),
        budget: arguments.budget.as_secs_f64(),
        threads,
        directory,
        command: format!("etalon {}", words.collect::<Vec<_>>().join(" ")),
    }
}

/// Draws the charts and writes the report.
fn publish(request: &Request, study: &Study) -> Result<(), Failure> {
    let abscissa = study.grid.abscissa.key;
    let curves = curves(&study.rows, abscissa);
    if curves.is_empty() {
        return Ok(());
    }
    let figures = [
        ("error", figures::error_over_abscissa(&curves, abscissa)),
        (
            "speed",
            figures::error_over_seconds(&curves, figures::USUAL_ERROR),
        ),
        ("honesty", figures::estimated_over_actual(&curves, abscissa)),
    ];
    let mut drawn = Vec::new();
    for (name, figure) in &figures {
        // Without a point above zero there is nothing to see, such as error bars of one scramble.
        if let Ok(svg) = figure.svg() {
            write_chart(&request.directory.join(name), &svg)?;
            drawn.push(svg);
        }
    }
    let page = report::html(request, study, &curves, &drawn);
    write(&request.directory.join("report.html"), &page)
}

/// Writes a chart as NAME.svg and returns that path; NAME may have the ending already, any other dot
/// belongs to the name.
pub fn write_chart(base: &Path, svg: &str) -> Result<PathBuf, Failure> {
    let mut path = base.to_owned();
    if base.extension().is_none_or(|ending| ending != "svg") {
        path.as_mut_os_string().push(".svg");
    }
    write(&path, svg)?;
    Ok(path)
}

/// The result in lines: each curve, the reference, the report's place.
fn summary(request: &Request, study: &Study) -> String {
    let abscissa = study.grid.abscissa.key;
    let curves = curves(&study.rows, abscissa);
    let mut lines: Vec<String> = curves.iter().map(|curve| line(curve, abscissa)).collect();
    let [all, rendering] = study.seconds;
    lines.push(format!(
        "reference: {}{}",
        study.about_reference,
        known(study, &curves)
    ));
    lines.push(format!(
        "{}: {} renders; {all:.1} s, {:.1} % of them outside rendering",
        request.directory.join("report.html").display(),
        study.rows.len(),
        100.0 * (all - rendering) / all
    ));
    lines.join("\n")
}

/// How well the reference is known, compared with the best point.
fn known(study: &Study, curves: &[Curve]) -> String {
    let own = study.reference.rmse();
    if own == 0.0 {
        return String::new();
    }
    let times = chart::best(curves) / own;
    let enough = if times < MARGIN {
        "; points near it are known the worse, and marked where it is the larger part"
    } else {
        ""
    };
    format!(
        ", root mean squared standard error {own:.2e}, {times:.1} times below the best point's{enough}"
    )
}

fn line(curve: &Curve, abscissa: Key) -> String {
    let slope = curve.slope().filter(|_| abscissa == Key::Spp);
    let slope = slope.map_or_else(String::new, |slope| {
        let [low, high] = slope.interval();
        format!("; slope {:.3} ({low:.3} to {high:.3})", slope.value)
    });
    let last = curve.points.last().map_or_else(String::new, |point| {
        let relmse = point.mean(|row| row.relmse).value;
        let seconds = point.mean(|row| row.seconds).value;
        format!(
            "relmse {relmse:.3e} in {seconds:.3} s at {}={}",
            abscissa.column(),
            Figure::number(point.x)
        )
    });
    format!("{}: {last}{slope}", curve.label)
}
