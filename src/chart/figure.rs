//! A chart with two logarithmic axes, drawn as SVG.

use plotters::coord::combinators::LogCoord;
use plotters::coord::{CoordTranslate, Shift};
use plotters::prelude::*;

use crate::stats::Estimate;

/// Points that belong together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// What the legend says.
    pub label: String,
    pub colour: RGBColor,
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
    /// Half the width of the interval about y; NaN where there is none.
    pub half: f64,
}

/// Number of markers.
pub const MARKERS: usize = 4;

/// A line that theory gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide {
    pub label: &'static str,
    /// A point of it.
    pub through: (f64, f64),
    /// d log y/d log x.
    pub slope: f64,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    pub title: String,
    /// Name of the horizontal axis.
    pub x: String,
    /// Name of the vertical axis.
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
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    #[error("the chart cannot be drawn: no point has an abscissa and an ordinate above zero")]
    Nothing,
    #[error("the chart cannot be drawn: {0}")]
    Drawing(#[from] DrawingAreaErrorKind<std::io::Error>),
}

const WIDTH: u32 = 960;
const PLOT: u32 = 560;
const LINE: u32 = 22;
const GREY: RGBColor = RGBColor(120, 120, 120);
const FONT: &str = "sans-serif";

type Axes = Cartesian2d<LogCoord<f64>, LogCoord<f64>>;
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
        let [x, y] = self.ranges().ok_or(FigureError::Nothing)?;
        let lines = self.series.len() + self.notes.len() + usize::from(self.front.is_some());
        let height = PLOT + LINE * lines as u32 + 12;
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
            root.fill(&WHITE)?;
            let (plot, legend) = root.split_vertically(PLOT);
            let mut chart = ChartBuilder::on(&plot)
                .caption(&self.title, (FONT, 20))
                .margin(10)
                .x_label_area_size(46)
                .y_label_area_size(70)
                .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())?;
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
                .draw()?;
            self.behind(&mut chart, x, y)?;
            for series in &self.series {
                series.draw(&mut chart)?;
            }
            self.legend(&legend)?;
            root.present()?;
        }
        Ok(text)
    }

    /// Whole decades around everything that has points.
    fn ranges(&self) -> Option<[(f64, f64); 2]> {
        let marks = |s: &Series| [s.points.as_slice(), &s.floor].concat();
        let all: Vec<Mark> = self.series.iter().flat_map(marks).collect();
        let all: Vec<&Mark> = all.iter().filter(|mark| mark.is_drawable()).collect();
        let x = limits(all.iter().map(|mark| mark.x), 1.25)?;
        let y = limits(all.iter().map(|mark| mark.y), 1.6)?;
        Some([x, y])
    }

    /// Guides, levels and the front.
    fn behind(
        &self,
        chart: &mut Chart<'_, '_>,
        x: (f64, f64),
        y: (f64, f64),
    ) -> Result<(), FigureError> {
        let name = |at: (f64, f64), text: &str, offset: (i32, i32)| {
            let style = (FONT, 14).into_font().color(&GREY);
            [EmptyElement::at(at) + Text::new(text.to_owned(), offset, style)]
        };
        for guide in &self.guides {
            if let Some(line) = guide.within(x, y) {
                chart.draw_series(DashedLineSeries::new(line, 3, 5, GREY.into()))?;
                chart.draw_series(name(line[1], guide.label, (-30, -22)))?;
            }
        }
        for (level, text) in &self.levels {
            if y.0 < *level && *level < y.1 {
                let line = [(x.0, *level), (x.1, *level)];
                chart.draw_series(DashedLineSeries::new(line, 8, 4, GREY.into()))?;
                chart.draw_series(name(line[0], text, (8, -16)))?;
            }
        }
        if let Some((_, front)) = &self.front {
            chart.draw_series(LineSeries::new(front.iter().copied(), broad()))?;
        }
        Ok(())
    }

    fn legend(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), FigureError> {
        let mut y = 4;
        let mut line = |text: &str, size: u32, colour: RGBColor| {
            let style = (FONT, size).into_font().color(&colour);
            area.draw(&Text::new(text.to_owned(), (74, y), style))?;
            y += LINE as i32;
            Ok::<i32, FigureError>(y - LINE as i32 + 7)
        };
        let sample = |at: i32, style: ShapeStyle| {
            area.draw(&PathElement::new(vec![(30, at), (62, at)], style))
        };
        for series in &self.series {
            let at = line(&series.label, 16, BLACK)?;
            sample(at, series.colour.stroke_width(2))?;
            draw_marker(area, (46, at), series.marker, series.colour.filled())?;
        }
        if let Some((name, _)) = &self.front {
            sample(line(name, 16, BLACK)?, broad())?;
        }
        for note in &self.notes {
            line(note, 15, GREY)?;
        }
        Ok(())
    }
}

/// How the front is drawn.
fn broad() -> ShapeStyle {
    RGBColor(245, 205, 90).mix(0.75).stroke_width(11)
}

impl Guide {
    /// The ends of the part of the line inside the plot.
    fn within(&self, x: (f64, f64), y: (f64, f64)) -> Option<[(f64, f64); 2]> {
        let at = |x: f64| self.through.1 * (x / self.through.0).powf(self.slope);
        let reach = |y: f64| self.through.0 * (y / self.through.1).powf(1.0 / self.slope);
        let (from, to) = (x.0.max(reach(y.1)), x.1.min(reach(y.0)));
        let inside = from < to && from > 0.0 && to.is_finite();
        inside.then(|| [(from, at(from)), (to, at(to))])
    }
}

impl Series {
    fn draw(&self, chart: &mut Chart<'_, '_>) -> Result<(), FigureError> {
        let colour = self.colour;
        if let Some(fit) = self.fit {
            chart.draw_series(LineSeries::new(fit, colour.mix(0.45).stroke_width(1)))?;
        }
        let points = || self.points.iter().filter(|mark| mark.is_drawable());
        let line = points().map(|mark| (mark.x, mark.y));
        chart.draw_series(LineSeries::new(line, colour.stroke_width(2)))?;
        let bars = points().filter(|mark| mark.half > 0.0 && mark.half < mark.y);
        chart.draw_series(bars.map(|Mark { x, y, half }| {
            PathElement::new(vec![(*x, y - half), (*x, y + half)], colour.stroke_width(1))
        }))?;
        let filled = points().map(|mark| (mark, colour.filled()));
        let floor = self.floor.iter().filter(|mark| mark.is_drawable());
        let hollow = floor.map(|mark| (mark, colour.stroke_width(1)));
        for (mark, style) in filled.chain(hollow) {
            draw_marker(chart.plotting_area(), (mark.x, mark.y), self.marker, style)?;
        }
        Ok(())
    }
}

impl Mark {
    /// A point with the 95 % interval of its ordinate.
    pub fn new(x: f64, y: Estimate) -> Self {
        let half = y.half_width(0.05);
        let y = y.value;
        Self { x, y, half }
    }

    /// A point without an interval.
    pub fn bare(x: f64, y: f64) -> Self {
        let half = f64::NAN;
        Self { x, y, half }
    }

    fn is_drawable(&self) -> bool {
        self.x > 0.0 && self.y > 0.0 && self.x.is_finite() && self.y.is_finite()
    }
}

/// A marker of the legend or of a curve.
fn draw_marker<C: CoordTranslate>(
    area: &DrawingArea<SVGBackend<'_>, C>,
    at: C::From,
    marker: usize,
    style: ShapeStyle,
) -> Result<(), FigureError>
where
    C::From: Clone,
{
    let at = EmptyElement::at(at);
    match marker % MARKERS {
        0 => area.draw(&(at + Circle::new((0, 0), 4, style)))?,
        1 => area.draw(&(at + TriangleMarker::new((0, 0), 5, style)))?,
        2 => area.draw(&(at + Rectangle::new([(-4, -4), (4, 4)], style)))?,
        _ => area.draw(&(at + Polygon::new([(-6, 0), (0, -6), (6, 0), (0, 6)], style)))?,
    }
    Ok(())
}

/// The range of numbers, widened by a factor on both sides; `None` without numbers.
fn limits(numbers: impl Iterator<Item = f64>, margin: f64) -> Option<(f64, f64)> {
    let all = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = numbers.fold(all, |(low, high), x| (x.min(low), x.max(high)));
    (low <= high).then_some((low / margin, high * margin))
}
