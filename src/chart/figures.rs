//! The charts of studies: error over the abscissa, error over seconds, estimated over actual error.

use plotters::style::RGBColor;

use super::curve::{front, grouped};
use super::figure::{Guide, MARKERS, Mark, Series};
use super::{Curve, Figure, Key, Point, Row};

/// Colours that those who confuse red and green tell apart (M. Okabe and K. Ito, "Color Universal
/// Design", 2008), without the yellow that is too light for lines.
const PALETTE: [[u8; 3]; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [86, 180, 233],
    [230, 159, 0],
    [40, 40, 40],
];

/// The relative mean squared error at which programs are compared where nothing else is said.
pub const USUAL_ERROR: f64 = 1e-3;

/// Slopes of the root mean squared error that theory gives, with their names.
const SLOPES: [(f64, &str); 3] = [(-0.5, "−1/2"), (-0.75, "−3/4"), (-1.0, "−1")];

/// Root mean squared error over the abscissa, with fitted slopes and the lines of theory.
pub fn error_over_abscissa(curves: &[Curve], abscissa: Key) -> Figure {
    let of_samples = abscissa == Key::Spp;
    let mark = |point: &Point| Mark::new(point.x, point.rmse());
    let floor = |point: &Point| point.rows.first().map_or(0.0, |row| row.reference_rmse);
    let mut series = series(curves, mark, |point| Mark::bare(point.x, floor(point)));
    for (series, curve) in series.iter_mut().zip(curves) {
        let Some(slope) = curve.slope().filter(|_| of_samples) else {
            continue;
        };
        let [low, high] = slope.interval();
        let bent = if slope.straight { "" } else { ", not straight" };
        series.label = format!(
            "{}: slope {:.3}, 95 % interval {low:.3} to {high:.3}{bent}",
            series.label, slope.value
        );
        if let (Some(first), Some(last)) = (series.points.first(), series.points.last()) {
            let end = |mark: &Mark| (mark.x, slope.at(mark.x));
            series.fit = Some([end(first), end(last)]);
        }
    }
    let first = series.iter().filter_map(|s| s.points.first());
    let top = first.max_by(|a, b| a.y.total_cmp(&b.y));
    let guides = top.filter(|_| of_samples).map(|top| {
        SLOPES.map(|(slope, label)| Guide {
            label,
            through: (top.x, 1.15 * top.y),
            slope,
        })
    });
    Figure {
        title: format!("Error over {}", name(abscissa)),
        x: name(abscissa).to_owned(),
        y: "root mean squared error".to_owned(),
        guides: guides.into_iter().flatten().collect(),
        levels: level_of_reference(curves, |row| row.reference_rmse),
        series,
        ..Figure::default()
    }
}

/// Relative mean squared error over seconds, with the Pareto front.
pub fn error_over_seconds(curves: &[Curve], at: f64) -> Figure {
    let seconds = |point: &Point| point.mean(|row| row.seconds).value;
    let mark = |point: &Point| Mark::new(seconds(point), point.mean(|row| row.relmse));
    let floor = |point: &Point| point.mean(|row| row.reference_relmse).value;
    Figure {
        title: "Speed and accuracy".to_owned(),
        x: "seconds of a render".to_owned(),
        y: "relative mean squared error".to_owned(),
        series: series(curves, mark, |point| {
            Mark::bare(seconds(point), floor(point))
        }),
        front: Some((
            "Pareto front: nothing is both faster and more accurate".to_owned(),
            front(curves),
        )),
        levels: level_of_reference(curves, |row| row.reference_relmse),
        notes: faster(curves, at),
        ..Figure::default()
    }
}

/// Estimated over actual error: 1 is a correct error bar.
pub fn estimated_over_actual(curves: &[Curve], abscissa: Key) -> Figure {
    let mark = |point: &Point| Mark::bare(point.x, point.estimated_over_actual());
    // Where most of the error has been subtracted there is no ratio.
    let mut series = series(curves, mark, |point| Mark::bare(point.x, f64::NAN));
    series.retain(|s| s.points.iter().any(|m| m.y > 0.0));
    let levels = [0.5, 0.8, 0.9, 1.0, 1.1, 1.25, 2.0].map(|level| {
        let name = if level == 1.0 { "honest" } else { "" };
        (level, format!("{} {name}", Figure::number(level)))
    });
    Figure {
        title: "Is the error bar honest? Estimated over actual error".to_owned(),
        x: name(abscissa).to_owned(),
        y: "estimated / actual root mean squared error".to_owned(),
        series,
        levels: levels.to_vec(),
        notes: vec![
            "Above 1 the error bar is too long, below 1 too short.".to_owned(),
            "Samples that fall into a single scramble have no error bar and no point.".to_owned(),
        ],
        ..Figure::default()
    }
}

/// Name of an axis of a chart.
fn name(key: Key) -> &'static str {
    match key {
        Key::Spp => "samples a pixel",
        Key::MaxDepth => "longest path in segments",
        Key::Scrambles => "scrambles a render",
        Key::Wavelengths => "wavelengths a path",
        other => other.column(),
    }
}

/// A series for each curve: programs by hue where there are several, curves by hue where there is
/// one; and a marker. Points above the floor are joined; those at it are marked on it, and end the
/// curve.
fn series(
    curves: &[Curve],
    mark: impl Fn(&Point) -> Mark,
    floor: impl Fn(&Point) -> Mark,
) -> Vec<Series> {
    let indices = grouped(0..curves.len(), |i| &curves[*i].renderer);
    let series = |(i, curve): (usize, &Curve)| {
        let mut programs = indices.iter().enumerate();
        let place = programs.find_map(|(program, (_, own))| {
            Some((program, own.iter().position(|index| *index == i)?))
        });
        let (program, of_program) = place.unwrap_or_default();
        let (hue, shade) = if indices.len() > 1 {
            (program, of_program)
        } else {
            (i, i / PALETTE.len())
        };
        let label = match curve.label.as_str() {
            "" => &curve.renderer,
            _ => &curve.label,
        };
        let (at_floor, above): (Vec<&Point>, Vec<&Point>) =
            curve.points.iter().partition(|point| point.at_floor());
        Series {
            label: label.clone(),
            colour: shaded(PALETTE[hue % PALETTE.len()], shade),
            marker: of_program % MARKERS,
            points: above.into_iter().map(&mark).collect(),
            floor: at_floor.into_iter().map(&floor).collect(),
            fit: None,
        }
    };
    curves.iter().enumerate().map(series).collect()
}

/// A colour, each shade a step nearer to white.
fn shaded(colour: [u8; 3], shade: usize) -> RGBColor {
    let kept = 0.72_f64.powi(shade.min(4) as i32);
    let [r, g, b] = colour.map(|c| (255.0 - kept * (255.0 - f64::from(c))) as u8);
    RGBColor(r, g, b)
}

/// The reference's own error as a level.
fn level_of_reference(curves: &[Curve], of: impl Fn(&Row) -> f64) -> Vec<(f64, String)> {
    let rows = curves.iter().flat_map(|c| &c.points).flat_map(|p| &p.rows);
    let level = rows.map(of).fold(0.0, f64::max);
    let name = "the reference's own error".to_owned();
    (level > 0.0).then_some((level, name)).into_iter().collect()
}

/// What each program takes for the same error, in words: at `at` where all reach it, else at the
/// middle of what all reach. A program takes as long as the fastest of its methods; between two
/// numbers of samples of a method, its line says how long.
fn faster(curves: &[Curve], at: f64) -> Vec<String> {
    let programs = grouped(curves, |curve| curve.renderer.clone());
    let fronts: Vec<Vec<(f64, f64)>> = programs
        .iter()
        .map(|(_, curves)| front(curves.iter().copied()))
        .collect();
    // Fronts fall: their first error is their largest.
    let ends = fronts
        .iter()
        .map(|front| Some((front.first()?.1, front.last()?.1)));
    let ends: Option<Vec<(f64, f64)>> = ends.collect();
    let Some(ends) = ends.filter(|ends| ends.len() > 1) else {
        return Vec::new();
    };
    let largest = ends.iter().map(|end| end.0).fold(f64::INFINITY, f64::min);
    let smallest = ends.iter().map(|end| end.1).fold(0.0, f64::max);
    if smallest > largest {
        return vec!["The programs reach no error in common.".to_owned()];
    }
    let error = if (smallest..=largest).contains(&at) {
        at
    } else {
        (smallest * largest).sqrt()
    };
    let mut own: Vec<(&str, f64)> = Vec::new();
    for ((name, curves), whole) in programs.iter().zip(&fronts) {
        let methods = curves
            .iter()
            .filter_map(|curve| between(&front([*curve]), error));
        let seconds = methods.chain(between(whole, error));
        own.push((name, seconds.fold(f64::INFINITY, f64::min)));
    }
    own.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (best, least) = own[0];
    let others = own[1..].iter().map(|(name, seconds)| {
        format!(
            "At relmse {error:.1e} {best} takes {least:.3} s and {name} {seconds:.3} s: {:.1} times as long.",
            seconds / least
        )
    });
    others.collect()
}

/// Seconds at an error along a front, straight between its points on logarithmic axes; `None` where
/// it does not reach the error.
fn between(front: &[(f64, f64)], error: f64) -> Option<f64> {
    if let [(seconds, only)] = front {
        return (*only == error).then_some(*seconds);
    }
    front.windows(2).find_map(|pair| {
        let ((s0, e0), (s1, e1)) = (pair[0], pair[1]);
        (e1..=e0).contains(&error).then(|| {
            let share = (error / e0).ln() / (e1 / e0).ln();
            s0 * (s1 / s0).powf(share)
        })
    })
}
