//! Rays with known first hits, from files or as they came with the program.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;

use super::Answer;
use etalon::inside::field::expression::{Expression, Parameter, parse, rational};
use etalon::inside::shape::Ray;

/// Rays and surfaces that come with the program.
const RAYS: &str = include_str!("../../../../tests/data/implicit.csv");
const SHAPES: &str = include_str!("../../../../tests/data/implicit_shapes.csv");

/// Why a set of rays cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum OracleError {
    /// A column is missing.
    #[error("the heading has no column \"{0}\"")]
    Column(&'static str),
    /// A line cannot be read.
    #[error("line {line}: {what}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// There is no ray.
    #[error("there are no rays")]
    Empty,
}

/// A surface in a cube.
#[derive(Debug, Clone)]
pub struct OracleShape {
    /// What rays call it.
    pub name: String,
    /// The clip cube is [−h, h]³.
    pub half_width: f64,
    /// The field.
    pub field: Arc<Expression>,
}

impl OracleShape {
    /// The clip cube's corners.
    pub fn inside(&self) -> [DVec3; 2] {
        [
            DVec3::splat(-self.half_width),
            DVec3::splat(self.half_width),
        ]
    }
}

/// A ray with its truth.
#[derive(Debug, Clone)]
pub struct OracleRay {
    shape: String,
    class: String,
    /// The ray.
    pub ray: Ray,
    /// Hits count after this, and at it where it is 0.
    pub t_min: f64,
    /// The first one.
    pub first: Option<f64>,
    /// From it to the next one.
    pub gap: f64,
}

impl OracleRay {
    /// Whether an answer is the truth: a miss for a miss, and for a hit one that cannot be taken
    /// for the next root, to a thousandth of the clip cube's edge. Digits are not what is asked.
    pub fn is_right(&self, answer: Answer, half_width: f64) -> bool {
        match (answer, self.first) {
            (Answer::Miss, None) => true,
            (Answer::Hit(t), Some(first)) => {
                let edge = 2.0 * half_width / self.ray.direction.length();
                (t - first).abs() <= (0.5 * self.gap).min(1e-3 * edge)
            }
            _ => false,
        }
    }
}

/// Surfaces and rays.
#[derive(Debug, Clone)]
pub struct Oracle {
    /// Surfaces.
    pub shapes: Vec<OracleShape>,
    rays: Vec<OracleRay>,
}

impl Oracle {
    /// Reads both tables; what is not given is taken from the ones that come with the program.
    ///
    /// # Errors
    /// [`OracleError`] where a table has no rays, columns are missing or a line cannot be read.
    pub fn new(rays: Option<&str>, shapes: Option<&str>) -> Result<Self, OracleError> {
        let shapes = read_shapes(shapes.unwrap_or(SHAPES))?;
        let rays = read_rays(rays.unwrap_or(RAYS), &shapes)?;
        if rays.is_empty() {
            return Err(OracleError::Empty);
        }
        Ok(Self { shapes, rays })
    }

    /// The rays of a shape and class.
    pub fn rays_of(&self, shape: &str, class: &str) -> impl Iterator<Item = &OracleRay> {
        self.rays
            .iter()
            .filter(move |ray| ray.shape == shape && ray.class == class)
    }

    /// The surface of that name.
    pub fn shape(&self, name: &str) -> Option<&OracleShape> {
        self.shapes.iter().find(|shape| shape.name == name)
    }
}

fn at(line: usize, what: impl ToString) -> OracleError {
    OracleError::Line {
        line,
        what: what.to_string(),
    }
}

/// Lines `name;half_width;degree;expression[, NAME=value]` below a heading.
fn read_shapes(text: &str) -> Result<Vec<OracleShape>, OracleError> {
    let lines = text.lines().enumerate().skip(1);
    let lines = lines.filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(i, line)| {
            let fields: Vec<&str> = line.split(';').collect();
            let &[name, half, _, written] = fields.as_slice() else {
                return Err(at(i + 1, "not name;half_width;degree;expression"));
            };
            let half_width: f64 = half.parse().map_err(|e| at(i + 1, e))?;
            if !(half_width > 0.0 && half_width.is_finite()) {
                return Err(at(i + 1, "the half width is not positive"));
            }
            let (expression, parameters) = with_parameters(written);
            let field = parse(expression, &parameters).map_err(|e| at(i + 1, e))?;
            Ok(OracleShape {
                name: name.to_owned(),
                half_width,
                field: Arc::new(field),
            })
        })
        .collect()
}

fn with_parameters(written: &str) -> (&str, Vec<Parameter>) {
    let mut parts = written.split(", ");
    let expression = parts.next().unwrap_or_default();
    let parameters = parts.filter_map(|part| {
        let (name, value) = part.split_once('=')?;
        Some(Parameter {
            name: name.trim().to_owned(),
            value: rational(value.trim())?,
        })
    });
    (expression, parameters.collect())
}

fn read_rays(text: &str, shapes: &[OracleShape]) -> Result<Vec<OracleRay>, OracleError> {
    const COLUMNS: [&str; 12] = [
        "shape", "class", "ox", "oy", "oz", "dx", "dy", "dz", "tmin", "hit", "t", "gap",
    ];
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .from_reader(text.as_bytes());
    let heading = reader.headers().map_err(|e| at(1, e))?.clone();
    let mut place = HashMap::new();
    for column in COLUMNS {
        let found = heading.iter().position(|name| name == column);
        place.insert(column, found.ok_or(OracleError::Column(column))?);
    }
    let mut rays = Vec::new();
    for (i, record) in reader.records().enumerate() {
        let line = i + 2;
        let record = record.map_err(|e| at(line, e))?;
        let text = |column: &str| record.get(place[column]).unwrap_or_default();
        let number = |column: &str| -> Result<f64, OracleError> {
            text(column)
                .parse()
                .map_err(|e| at(line, format!("{column}: {e}")))
        };
        if !shapes.iter().any(|shape| shape.name == text("shape")) {
            return Err(at(line, format!("no shape is named \"{}\"", text("shape"))));
        }
        let first = (text("hit") == "1").then(|| number("t")).transpose()?;
        rays.push(OracleRay {
            shape: text("shape").to_owned(),
            class: text("class").to_owned(),
            ray: Ray {
                origin: DVec3::new(number("ox")?, number("oy")?, number("oz")?),
                direction: DVec3::new(number("dx")?, number("dy")?, number("dz")?),
            },
            t_min: number("tmin")?,
            first,
            gap: text("gap").parse().unwrap_or(f64::INFINITY),
        });
    }
    Ok(rays)
}
