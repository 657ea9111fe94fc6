//! A chart with two logarithmic axes, drawn as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

/// Points that belong together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// What the legend says.
    pub label: String,
    /// Its colour: red, green, blue.
    pub colour: [u8; 3],
    /// Which of the [`MARKERS`] its points have.
    pub marker: usize,
    /// Points joined by a line.
    pub points: Vec<Mark>,
    /// Points marked where the curve ends at the reference's floor.
    pub floor: Vec<Mark>,
    /// Two ends of a fitted line.
    pub fit: Option<[(f64, f64); 2]>,
}

/// A point with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    pub x: f64,
    pub y: f64,
    /// Half the width of the interval about y.
    pub half: f64,
}

/// Number of markers.
pub const MARKERS: usize = 4;

/// A line that theory gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    pub label: String,
    /// A point of it.
    pub through: (f64, f64),
    /// d log y/d log x.
    pub slope: f64,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    pub title: String,
    /// What the abscissa is.
    pub x: String,
    /// What the ordinate is.
    pub y: String,
    pub series: Vec<Series>,
    /// Lines that theory gives.
    pub guides: Vec<Guide>,
    /// Points joined by a broad line behind everything, with a name.
    pub front: Option<(String, Vec<(f64, f64)>)>,
    /// Dashed levels with names.
    pub levels: Vec<(f64, String)>,
    /// Lines below the legend.
    pub notes: Vec<String>,
}

/// The chart could not be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the chart cannot be drawn: {0}")]
pub struct FigureError(String);

fn failed(error: impl ToString) -> FigureError {
    FigureError(error.to_string())
}

const WIDTH: u32 = 960;
const PLOT: u32 = 560;
const LINE: u32 = 22;
const GREY: RGBColor = RGBColor(120, 120, 120);
const FONT: &str = "sans-serif";

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Axes = Cartesian2d<
    plotters::coord::combinators::LogCoord<f64>,
    plotters::coord::combinators::LogCoord<f64>,
>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Axes>;

impl Figure {
    /// A number of an axis.
    pub fn number(x: f64) -> String {
        if (0.01..100_000.0).contains(&x) {
            let text = format!("{x:.2}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            format!("{x:.0e}")
        }
    }

    /// Draws it.
    ///
    /// # Errors
    /// [`FigureError`] where there is nothing above zero to draw, or drawing fails.
    pub fn svg(&self) -> Result<String, FigureError> {
        let ranges = self
            .ranges()
            .ok_or_else(|| failed("no point has an abscissa and an ordinate above zero"))?;
        let lines = self.series.len() + self.notes.len() + usize::from(self.front.is_some());
        let height = PLOT + LINE * lines as u32 + 12;
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
            root.fill(&WHITE).map_err(failed)?;
            let (plot, legend) = root.split_vertically(PLOT);
            self.plot(&plot, ranges)?;
            self.legend(&legend)?;
            root.present().map_err(failed)?;
        }
        Ok(text)
    }

    /// Whole decades around everything that has points.
    fn ranges(&self) -> Option<[(f64, f64); 2]> {
        let marks = self
            .series
            .iter()
            .flat_map(|s| s.points.iter().chain(&s.floor));
        let all: Vec<(f64, f64)> = marks.map(|m| (m.x, m.y)).filter(|p| drawable(*p)).collect();
        let x = limits(all.iter().map(|p| p.0), 1.25)?;
        let y = limits(all.iter().map(|p| p.1), 1.6)?;
        Some([x, y])
    }

    fn plot(&self, area: &Area<'_>, [x, y]: [(f64, f64); 2]) -> Result<(), FigureError> {
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, (FONT, 20))
            .margin(10)
            .x_label_area_size(46)
            .y_label_area_size(70)
            .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .bold_line_style(RGBColor(225, 225, 225))
            .light_line_style(TRANSPARENT)
            .x_desc(self.x.as_str())
            .y_desc(self.y.as_str())
            .axis_desc_style((FONT, 16))
            .label_style((FONT, 14))
            .x_labels(12)
            .y_labels(10)
            .x_label_formatter(&|x| Self::number(*x))
            .y_label_formatter(&|y| Self::number(*y))
            .draw()
            .map_err(failed)?;
        self.behind(&mut chart, x, y)?;
        for series in &self.series {
            series.draw(&mut chart)?;
        }
        Ok(())
    }

    /// Guides, levels and the front.
    fn behind(
        &self,
        chart: &mut Chart<'_, '_>,
        x: (f64, f64),
        y: (f64, f64),
    ) -> Result<(), FigureError> {
        for guide in &self.guides {
            let line = guide.within(x, y);
            let Some(end) = line.last().copied() else {
                continue;
            };
            let dashes = DashedLineSeries::new(line, 3, 5, GREY.into());
            chart.draw_series(dashes).map_err(failed)?;
            let style = (FONT, 14).into_font().color(&GREY);
            let name = EmptyElement::at(end) + Text::new(guide.label.clone(), (-30, -22), style);
            chart.draw_series([name]).map_err(failed)?;
        }
        for (level, name) in &self.levels {
            if *level <= y.0 || *level >= y.1 {
                continue;
            }
            let line = [(x.0, *level), (x.1, *level)];
            let dashes = DashedLineSeries::new(line, 8, 4, GREY.into());
            chart.draw_series(dashes).map_err(failed)?;
            let style = (FONT, 14).into_font().color(&GREY);
            let name = EmptyElement::at((x.0, *level)) + Text::new(name.clone(), (8, -16), style);
            chart.draw_series([name]).map_err(failed)?;
        }
        if let Some((_, front)) = &self.front {
            let style = RGBColor(245, 205, 90).mix(0.75).stroke_width(11);
            chart
                .draw_series(LineSeries::new(front.iter().copied(), style))
                .map_err(failed)?;
        }
        Ok(())
    }

    fn legend(&self, area: &Area<'_>) -> Result<(), FigureError> {
        let mut y = 4;
        let mut line = |text: &str, style: TextStyle<'_>| {
            let element = Text::new(text.to_owned(), (74, y), style);
            area.draw(&element).map_err(failed)?;
            y += LINE as i32;
            Ok::<i32, FigureError>(y - LINE as i32 + 7)
        };
        for series in &self.series {
            let at = line(&series.label, (FONT, 16).into_font().color(&BLACK))?;
            let path = vec![(30, at), (62, at)];
            let element = PathElement::new(path, series.style().stroke_width(2));
            area.draw(&element).map_err(failed)?;
            draw_marker(area, (46, at), series)?;
        }
        if let Some((name, _)) = &self.front {
            let at = line(name, (FONT, 16).into_font().color(&BLACK))?;
            let style = RGBColor(245, 205, 90).mix(0.75).stroke_width(11);
            let element = PathElement::new(vec![(30, at), (62, at)], style);
            area.draw(&element).map_err(failed)?;
        }
        for note in &self.notes {
            line(note, (FONT, 15).into_font().color(&GREY))?;
        }
        Ok(())
    }
}

impl Guide {
    /// The part of the line inside the plot.
    fn within(&self, x: (f64, f64), y: (f64, f64)) -> Vec<(f64, f64)> {
        let at = |x: f64| self.through.1 * (x / self.through.0).powf(self.slope);
        let reach = |y: f64| self.through.0 * (y / self.through.1).powf(1.0 / self.slope);
        let (from, to) = (x.0.max(reach(y.1)), x.1.min(reach(y.0)));
        let inside = from < to && from > 0.0 && to.is_finite();
        let ends = inside.then(|| vec![(from, at(from)), (to, at(to))]);
        ends.unwrap_or_default()
    }
}

impl Series {
    fn style(&self) -> RGBColor {
        let [r, g, b] = self.colour;
        RGBColor(r, g, b)
    }

    fn draw(&self, chart: &mut Chart<'_, '_>) -> Result<(), FigureError> {
        let colour = self.style();
        if let Some(fit) = self.fit {
            let style = colour.mix(0.45).stroke_width(1);
            chart
                .draw_series(LineSeries::new(fit, style))
                .map_err(failed)?;
        }
        let points: Vec<Mark> = self.points.iter().copied().filter(Mark::drawable).collect();
        let line = points.iter().map(|m| (m.x, m.y));
        chart
            .draw_series(LineSeries::new(line, colour.stroke_width(2)))
            .map_err(failed)?;
        let bars = points.iter().filter_map(|m| m.bar());
        let bars = bars.map(|ends| PathElement::new(ends.to_vec(), colour.stroke_width(1)));
        chart.draw_series(bars).map_err(failed)?;
        for mark in &points {
            draw_point(chart, (mark.x, mark.y), self.marker, colour.filled())?;
        }
        for mark in self.floor.iter().filter(|m| m.drawable()) {
            draw_point(chart, (mark.x, mark.y), self.marker, colour.stroke_width(1))?;
        }
        Ok(())
    }
}

impl Mark {
    fn drawable(&self) -> bool {
        drawable((self.x, self.y))
    }

    fn bar(&self) -> Option<[(f64, f64); 2]> {
        let bar = self.half > 0.0 && self.half < self.y;
        bar.then_some([(self.x, self.y - self.half), (self.x, self.y + self.half)])
    }
}

fn drawable((x, y): (f64, f64)) -> bool {
    x > 0.0 && y > 0.0 && x.is_finite() && y.is_finite()
}

/// A marker of the legend.
fn draw_marker(area: &Area<'_>, at: (i32, i32), series: &Series) -> Result<(), FigureError> {
    let style = series.style().filled();
    let (x, y) = at;
    match series.marker % MARKERS {
        0 => area.draw(&Circle::new(at, 5, style)),
        1 => area.draw(&TriangleMarker::new(at, 6, style)),
        2 => area.draw(&Rectangle::new([(x - 4, y - 4), (x + 4, y + 4)], style)),
        _ => area.draw(&Polygon::new(diamond(at), style)),
    }
    .map_err(failed)
}

fn diamond((x, y): (i32, i32)) -> Vec<(i32, i32)> {
    vec![(x - 6, y), (x, y - 6), (x + 6, y), (x, y + 6)]
}

/// A marker of a curve.
fn draw_point(
    chart: &mut Chart<'_, '_>,
    at: (f64, f64),
    marker: usize,
    style: ShapeStyle,
) -> Result<(), FigureError> {
    match marker % MARKERS {
        0 => chart.draw_series([Circle::new(at, 4, style)]).map(drop),
        1 => chart
            .draw_series([TriangleMarker::new(at, 5, style)])
            .map(drop),
        2 => chart
            .draw_series([EmptyElement::at(at) + Rectangle::new([(-4, -4), (4, 4)], style)])
            .map(drop),
        _ => chart
            .draw_series([EmptyElement::at(at) + Polygon::new(diamond((0, 0)), style)])
            .map(drop),
    }
    .map_err(failed)
}

/// The range of numbers, widened by a factor on both sides.
fn limits(numbers: impl Iterator<Item = f64>, margin: f64) -> Option<(f64, f64)> {
    let bounds = numbers.fold(None, |bounds: Option<(f64, f64)>, x| {
        let (low, high) = bounds.unwrap_or((x, x));
        Some((low.min(x), high.max(x)))
    });
    bounds.map(|(low, high)| (low / margin, high * margin))
}
