//! The results as CSV and as a picture: share wrong and share undecided over time a ray.

use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;

use super::{CLASSES, Contestant, Precision, Result, Score};

/// The results as CSV, by finder and class, `all` being all classes together.
pub fn csv(results: &[Result]) -> String {
    let mut text = String::from(
        "finder,precision,steps,class,rays,wrong,undecided,wrong_share,undecided_share,ns_per_ray\n",
    );
    for result in results {
        let classes = CLASSES.into_iter().zip(result.scores);
        for (class, score) in classes.chain([("all", result.all())]) {
            let contestant = result.contestant;
            text += &format!(
                "{},{},{},{class},{},{},{},{:.6},{:.6},{:.1}\n",
                contestant.name(),
                contestant.precision().name(),
                contestant.steps(),
                score.rays,
                score.wrong,
                score.undecided,
                score.wrong_share(),
                score.undecided_share(),
                score.nanoseconds_a_ray()
            );
        }
    }
    text
}

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the chart cannot be drawn: {0}")]
pub struct ChartError(String);

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for ChartError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self(error.to_string())
    }
}

/// Where shares of zero are drawn: below any share that the rays of a class can have.
const NONE: f64 = 2e-4;
const SIZE: (u32, u32) = (1500, 800);

/// The results as an SVG picture, a panel for each class and one for all.
///
/// # Errors
/// [`ChartError`] where drawing fails.
pub fn svg(results: &[Result]) -> std::result::Result<String, ChartError> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let (top, bottom) = root.split_vertically(740);
        let panels = top.split_evenly((2, 4));
        for (i, panel) in panels.iter().enumerate() {
            let title = *CLASSES.get(i).unwrap_or(&"all");
            let scores = results.iter().map(|result| {
                let score = result.scores.get(i).copied();
                (result.contestant, score.unwrap_or_else(|| result.all()))
            });
            draw(panel, title, &scores.collect::<Vec<_>>())?;
        }
        legend(&bottom)?;
        root.present()?;
    }
    Ok(text)
}

pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

pub(crate) type Outcome = std::result::Result<(), ChartError>;

fn draw(area: &Area, title: &str, scores: &[(Contestant, Score)]) -> Outcome {
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18))
        .margin(6)
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d((100f64..1e7).log_scale(), (1.5e-4f64..1.0).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("ns a ray")
        .y_desc("share of rays")
        .x_labels(6)
        .y_labels(5)
        .x_label_formatter(&|x| format!("1e{:.0}", x.log10()))
        .y_label_formatter(&|y| format!("{:.0e}", y))
        .draw()?;
    for precision in Precision::ALL {
        let sweep = scores.iter().filter(
            |(contestant, _)| matches!(contestant, Contestant::SignChange(p, _) if *p == precision),
        );
        let line: Vec<(f64, f64)> = sweep.map(|(_, score)| point(score, false)).collect();
        let colour = colour("sign-change", precision);
        chart.draw_series(LineSeries::new(line, colour))?;
    }
    for (contestant, score) in scores {
        let colour = colour(contestant.name(), contestant.precision());
        let wrong = Circle::new(point(score, false), 4, colour.filled());
        chart.draw_series([wrong])?;
        if score.undecided > 0 {
            let undecided = Circle::new(point(score, true), 6, colour.stroke_width(2));
            chart.draw_series([undecided])?;
        }
    }
    Ok(())
}

fn point(score: &Score, undecided: bool) -> (f64, f64) {
    let share = if undecided {
        score.undecided_share()
    } else {
        score.wrong_share()
    };
    (score.nanoseconds_a_ray(), share.max(NONE))
}

/// The colour of a method in all charts.
pub(crate) fn colour(name: &str, precision: Precision) -> RGBColor {
    match (name, precision) {
        ("textbook" | "sign-change", Precision::Single) => RGBColor(230, 150, 60),
        ("textbook" | "sign-change", _) => RGBColor(190, 60, 40),
        ("sphere-trace", _) => RGBColor(130, 90, 170),
        ("interval", _) => RGBColor(30, 110, 180),
        ("polynomial", _) => RGBColor(40, 140, 80),
        _ => RGBColor(20, 20, 20),
    }
}

fn legend(area: &Area) -> Outcome {
    let [single, double] = Precision::ALL.map(|precision| colour("sign-change", precision));
    let proved = ["sphere-trace", "interval", "polynomial", "auto"];
    let proved = proved.map(|name| (name, colour(name, Precision::Double)));
    let stepping = [
        ("sign-change f32 (100 to 10 000 steps)", single),
        ("sign-change f64", double),
    ];
    let mut x = 30;
    for (text, shade) in stepping.into_iter().chain(proved) {
        area.draw(&Circle::new((x, 20), 5, shade.filled()))?;
        area.draw(&Text::new(text, (x + 10, 12), ("sans-serif", 15)))?;
        x += 40 + 8 * text.len() as i32;
    }
    let note = "filled: wrong, ring: undecided; at 2e-4: none";
    Ok(area.draw(&Text::new(note, (x, 12), ("sans-serif", 15)))?)
}
