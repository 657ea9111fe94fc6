//! The charts of studies: error over the abscissa, error over seconds, estimated over actual error.

use super::{Curve, Figure, Guide, Key, MARKERS, Mark, Point, Row, Series, front};

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

/// Root mean squared error over the abscissa, with fitted slopes and the lines of theory.
pub fn error_over_abscissa(curves: &[Curve], abscissa: Key) -> Figure {
    let of_samples = abscissa == Key::Spp;
    let series: Vec<Series> = each(curves, |curve, series| {
        let mark = |point: &Point| {
            let error = point.rmse();
            Mark {
                x: point.x,
                y: error.value,
                half: error.half,
            }
        };
        place(curve, series, mark, |point| {
            let row = point.rows.first();
            (point.x, row.map_or(0.0, |row| row.reference_rmse))
        });
        let Some(slope) = curve.slope().filter(|_| of_samples) else {
            return;
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
    });
    let first = series.iter().filter_map(|s| s.points.first());
    let top = first.max_by(|a, b| a.y.total_cmp(&b.y)).copied();
    let guide = |(slope, label): (f64, &str)| {
        top.map(|top| Guide {
            label: label.to_owned(),
            through: (top.x, 1.15 * top.y),
            slope,
        })
    };
    let guides = [(-0.5, "−1/2"), (-0.75, "−3/4"), (-1.0, "−1")];
    Figure {
        title: format!("Error over {}", name(abscissa)),
        x: name(abscissa).to_owned(),
        y: "root mean squared error".to_owned(),
        guides: if of_samples {
            guides.into_iter().filter_map(guide).collect()
        } else {
            Vec::new()
        },
        levels: floor(curves, |row| row.reference_rmse),
        series,
        ..Figure::default()
    }
}

/// Relative mean squared error over seconds, with the Pareto front.
pub fn error_over_seconds(curves: &[Curve], at: f64) -> Figure {
    let series = each(curves, |curve, series| {
        let mark = |point: &Point| {
            let error = point.mean(|row| row.relmse);
            Mark {
                x: point.mean(|row| row.seconds).value,
                y: error.value,
                half: error.half,
            }
        };
        place(curve, series, mark, |point| {
            let seconds = point.mean(|row| row.seconds).value;
            (seconds, point.mean(|row| row.reference_relmse).value)
        });
    });
    let coordinates = |(c, p): &(usize, usize)| {
        let point = &curves[*c].points[*p];
        let seconds = point.mean(|row| row.seconds).value;
        (seconds, point.mean(|row| row.relmse).value)
    };
    let front: Vec<_> = front(curves).iter().map(coordinates).collect();
    Figure {
        title: "Speed and accuracy".to_owned(),
        x: "seconds of a render".to_owned(),
        y: "relative mean squared error".to_owned(),
        series,
        front: Some((
            "Pareto front: nothing is both faster and more accurate".to_owned(),
            front,
        )),
        levels: floor(curves, |row| row.reference_relmse),
        notes: faster(curves, at),
        ..Figure::default()
    }
}

/// Estimated over actual error: 1 is an honest error bar.
pub fn estimated_over_actual(curves: &[Curve], abscissa: Key) -> Figure {
    let mut series = each(curves, |curve, series| {
        series.points = curve
            .above_floor()
            .map(|point| Mark {
                x: point.x,
                y: point.estimated_over_actual(),
                half: f64::NAN,
            })
            .collect();
    });
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

/// How the abscissa is called.
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
/// one; and a marker.
fn each(curves: &[Curve], fill: impl Fn(&Curve, &mut Series)) -> Vec<Series> {
    let mut renderers: Vec<&str> = Vec::new();
    for curve in curves {
        if !renderers.contains(&curve.renderer.as_str()) {
            renderers.push(&curve.renderer);
        }
    }
    let mut counts = vec![0; renderers.len()];
    let mut all = Vec::new();
    for (i, curve) in curves.iter().enumerate() {
        let own = renderers.iter().position(|r| **r == curve.renderer);
        let own = own.unwrap_or(0);
        let of_program = counts[own];
        counts[own] += 1;
        let (hue, shade) = if renderers.len() > 1 {
            (own, of_program)
        } else {
            (i, i / PALETTE.len())
        };
        let mut series = Series {
            label: if curve.label.is_empty() {
                curve.renderer.clone()
            } else {
                curve.label.clone()
            },
            colour: shaded(PALETTE[hue % PALETTE.len()], shade),
            marker: of_program % MARKERS,
            ..Series::default()
        };
        fill(curve, &mut series);
        all.push(series);
    }
    all
}

/// A colour, each shade a step nearer to white.
fn shaded(colour: [u8; 3], shade: usize) -> [u8; 3] {
    let kept = 0.72_f64.powi(shade.min(4) as i32);
    colour.map(|c| (255.0 - kept * (255.0 - f64::from(c))) as u8)
}

/// Points above the floor are joined; those at it are marked on it, and end the curve.
fn place(
    curve: &Curve,
    series: &mut Series,
    mark: impl Fn(&Point) -> Mark,
    at_floor: impl Fn(&Point) -> (f64, f64),
) {
    for point in &curve.points {
        if point.at_floor() {
            let (x, y) = at_floor(point);
            series.floor.push(Mark {
                x,
                y,
                half: f64::NAN,
            });
        } else {
            series.points.push(mark(point));
        }
    }
}

/// The reference's own error as a level.
fn floor(curves: &[Curve], of: impl Fn(&Row) -> f64) -> Vec<(f64, String)> {
    let rows = curves.iter().flat_map(|c| &c.points).flat_map(|p| &p.rows);
    let floor = rows.map(of).fold(0.0, f64::max);
    if floor > 0.0 {
        vec![(floor, "the reference's own error".to_owned())]
    } else {
        Vec::new()
    }
}

/// Errors and seconds along a line that falls.
type Line = Vec<(f64, f64)>;

/// What each program takes for the same error, in words: at `at` where all reach it, else at the
/// middle of what all reach. A program takes as long as the fastest of its methods; between two
/// numbers of samples of a method, its line says how long.
fn faster(curves: &[Curve], at: f64) -> Vec<String> {
    // By program: its front, and those of its methods.
    let mut programs: Vec<(String, Vec<Line>)> = Vec::new();
    for curve in curves {
        if programs.iter().any(|(name, _)| *name == curve.renderer) {
            continue;
        }
        let own: Vec<Curve> = curves
            .iter()
            .filter(|c| c.renderer == curve.renderer)
            .cloned()
            .collect();
        let methods = own.iter().map(|c| line(std::slice::from_ref(c)));
        let lines = std::iter::once(line(&own)).chain(methods).collect();
        programs.push((curve.renderer.clone(), lines));
    }
    if programs.len() < 2 || programs.iter().any(|(_, lines)| lines[0].is_empty()) {
        return Vec::new();
    }
    // Fronts fall: their first error is their largest.
    let largest = programs
        .iter()
        .map(|(_, lines)| lines[0][0].0)
        .fold(f64::INFINITY, f64::min);
    let smallest = programs
        .iter()
        .filter_map(|(_, lines)| lines[0].last())
        .fold(0.0, |smallest: f64, (error, _)| smallest.max(*error));
    if smallest > largest {
        return vec!["The programs reach no error in common.".to_owned()];
    }
    let error = if (smallest..=largest).contains(&at) {
        at
    } else {
        (smallest * largest).sqrt()
    };
    let seconds = |lines: &[Line]| {
        let methods = lines.iter().filter_map(|line| between(line, error));
        methods.fold(f64::INFINITY, f64::min)
    };
    let own = programs.iter().map(|(name, lines)| (name, seconds(lines)));
    let mut own: Vec<(&String, f64)> = own.collect();
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

/// The front of some curves.
fn line(curves: &[Curve]) -> Line {
    let coordinates = |(c, p): &(usize, usize)| {
        let point = &curves[*c].points[*p];
        let seconds = point.mean(|row| row.seconds).value;
        (point.mean(|row| row.relmse).value, seconds)
    };
    front(curves).iter().map(coordinates).collect()
}

/// Seconds at an error along a line, straight between its points on logarithmic axes; `None` where
/// it does not reach the error.
fn between(line: &[(f64, f64)], error: f64) -> Option<f64> {
    if let [(only, seconds)] = line {
        return (*only == error).then_some(*seconds);
    }
    line.windows(2).find_map(|pair| {
        let ((e0, s0), (e1, s1)) = (pair[0], pair[1]);
        (e1..=e0).contains(&error).then(|| {
            let share = (error / e0).ln() / (e1 / e0).ln();
            s0 * (s1 / s0).powf(share)
        })
    })
}
