//! The failure maps as CSV and as one picture: share of wrong and undecided answers over difficulty, a
//! row a shape, a column a family, and the time a ray takes beside them.

use plotters::prelude::*;

use super::families::{FAMILIES, Family};
use super::{Method, Point, SUBJECTS, Subject};
use crate::finders::chart::{Area, ChartError, Outcome};
use crate::finders::{Precision, Score};
use etalon::inside::scene::FinderChoice;

/// One row a point.
pub fn csv(points: &[Point]) -> String {
    let mut text = String::from(
        "shape,family,difficulty,method,precision,planned,rays,wrong,undecided,ns_per_ray\n",
    );
    for point in points {
        text += &format!(
            "{},{},1e{},{},{},{},{},{},{},{:.1}\n",
            point.subject.name(),
            point.family.name(),
            point.exponent,
            point.method.name(),
            point.precision.name(),
            u8::from(point.method.is_planned()),
            point.score.rays,
            point.score.wrong,
            point.score.undecided,
            point.score.nanoseconds_a_ray()
        );
    }
    text
}

const SIZE: (u32, u32) = (1500, 1420);
/// Height of legend and column titles together, and width of the rows' names.
const HEADER: u32 = 112;
const NAMES: u32 = 104;
const FONT: (&str, i32) = ("sans-serif", 20);
const SMALL: (&str, i32) = ("sans-serif", 16);

/// All points as an SVG picture.
///
/// # Errors
/// [`ChartError`] where drawing fails.
pub fn svg(points: &[Point]) -> Result<String, ChartError> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let (top, below) = root.split_vertically(HEADER);
        legend(&top)?;
        let (names, panels) = below.split_horizontally(NAMES);
        let columns = FAMILIES.len() + 1;
        let titles = FAMILIES.map(Family::axis).into_iter().chain(["ns a ray"]);
        for (i, title) in titles.enumerate() {
            let width = (SIZE.0 - NAMES) as usize / columns;
            let place = ((NAMES as usize + i * width + 14) as i32, HEADER as i32 - 26);
            top.draw(&Text::new(title, place, FONT))?;
        }
        let names = names.split_evenly((SUBJECTS.len(), 1));
        let panels = panels.split_evenly((SUBJECTS.len(), columns));
        for (row, subject) in SUBJECTS.into_iter().enumerate() {
            let own: Vec<&Point> = points.iter().filter(|p| p.subject == subject).collect();
            let cells = &panels[row * columns..];
            names[row].draw(&Text::new(subject.name(), (8, 50), FONT))?;
            for (family, cell) in FAMILIES.into_iter().zip(cells) {
                let of_family = own.iter().filter(|p| p.family == family);
                shares(
                    cell,
                    subject,
                    family,
                    &of_family.copied().collect::<Vec<_>>(),
                )?;
            }
            times(&cells[FAMILIES.len()], subject, &own)?;
        }
        root.present()?;
    }
    Ok(text)
}

/// Shares over difficulty; harder is to the right.
fn shares(area: &Area, subject: Subject, family: Family, points: &[&Point]) -> Outcome {
    let exponents = family.exponents();
    let last = exponents.len() as f64 - 1.0;
    let mut chart = ChartBuilder::on(area)
        .margin(4)
        .x_label_area_size(24)
        .y_label_area_size(46)
        .build_cartesian_2d(-0.3..last + 0.3, -0.05f64..1.05)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_labels(exponents.len())
        .y_labels(3)
        .x_label_formatter(&|x| {
            let exponent = exponents
                .get(x.round() as usize)
                .map_or(0, |exponent| *exponent);
            if exponent % 3 == 0 && (x - x.round()).abs() < 0.1 {
                format!("1e{exponent}")
            } else {
                String::new()
            }
        })
        .y_label_formatter(&|y| format!("{:.0} %", 100.0 * y))
        .label_style(SMALL)
        .draw()?;
    for method in subject.methods() {
        let own = points.iter().filter(|p| p.method == *method);
        let place = |p: &Point| {
            let at = exponents.iter().position(|e| *e == p.exponent);
            at.unwrap_or_default() as f64
        };
        let line = |share: fn(&Score) -> f64| -> Vec<(f64, f64)> {
            let points = own.clone().map(|p| (place(p), share(&p.score)));
            points.collect()
        };
        let (wrong, undecided) = (line(Score::wrong_share), line(Score::undecided_share));
        let style = colour(*method).stroke_width(if method.is_planned() { 3 } else { 2 });
        chart.draw_series(LineSeries::new(wrong, style))?;
        if undecided.iter().any(|(_, share)| *share > 0.0) {
            let thin = colour(*method).stroke_width(1);
            chart.draw_series(DashedLineSeries::new(undecided, 4, 3, thin))?;
        }
    }
    planned_single(&mut chart, points, &exponents)
}

type Chart<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;

/// Marks where the plan would take f32.
fn planned_single(chart: &mut Chart, points: &[&Point], exponents: &[i32]) -> Outcome {
    let planned = points.iter().filter(|p| p.method.is_planned());
    let single = planned.filter(|p| p.precision == Precision::Single);
    let marks = single.filter_map(|p| {
        let at = exponents.iter().position(|e| *e == p.exponent)? as f64;
        Some(Circle::new((at, 0.0), 4, BLACK.filled()))
    });
    chart.draw_series(marks.collect::<Vec<_>>())?;
    Ok(())
}

/// Nanoseconds a ray by method: least, median and most over all points.
fn times(area: &Area, subject: Subject, points: &[&Point]) -> Outcome {
    let methods = subject.methods();
    let rows = methods.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .margin(4)
        .x_label_area_size(24)
        .y_label_area_size(10)
        .build_cartesian_2d((5f64..2e6).log_scale(), 0.0..rows)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .disable_y_mesh()
        .y_labels(0)
        .x_labels(6)
        .x_label_formatter(&|x| format!("1e{:.0}", x.log10()))
        .label_style(SMALL)
        .draw()?;
    for (i, method) in methods.iter().enumerate() {
        let own = points
            .iter()
            .filter(|p| p.method == *method && p.score.rays > 0);
        let mut each: Vec<f64> = own.map(|p| p.score.nanoseconds_a_ray()).collect();
        each.sort_by(f64::total_cmp);
        let (Some(&least), Some(&most)) = (each.first(), each.last()) else {
            continue;
        };
        let y = rows - 0.5 - i as f64;
        let shade = colour(*method);
        let line = PathElement::new(vec![(least, y), (most, y)], shade.stroke_width(2));
        chart.draw_series([line])?;
        let median = Circle::new((each[each.len() / 2], y), 4, shade.filled());
        chart.draw_series([median])?;
    }
    Ok(())
}

fn colour(method: Method) -> RGBColor {
    crate::finders::chart::colour(method.name(), method.precision(Precision::Double))
}

fn legend(area: &Area) -> Outcome {
    let entries = [
        (
            "textbook or 256 steps, f32",
            Method::Textbook(Precision::Single),
        ),
        ("the same, f64", Method::Textbook(Precision::Double)),
        ("sphere-trace", Method::Proved(FinderChoice::SphereTrace)),
        ("interval", Method::Proved(FinderChoice::Interval)),
        ("polynomial", Method::Proved(FinderChoice::Polynomial)),
        ("what the plan takes (dots: in f32)", Method::Ladder),
    ];
    let mut x = 20;
    for (text, method) in entries {
        let shade = colour(method);
        area.draw(&PathElement::new(
            vec![(x, 18), (x + 24, 18)],
            shade.stroke_width(4),
        ))?;
        area.draw(&Text::new(text, (x + 30, 8), FONT))?;
        x += 54 + 10 * text.len() as i32;
    }
    let note = "share of rays, harder to the right: solid wrong, dashed undecided; times: least, median (dot) \
                and most of a row's points";
    Ok(area.draw(&Text::new(note, (20, 38), FONT))?)
}
