//! Rays with known first hits, from files or as they came with the program.

use std::collections::HashMap;

use glam::DVec3;

use super::Answer;
use super::shapes::{OracleShape, read_shapes};
use etalon::inside::shape::Ray;

/// Rays and surfaces that come with the program.
const RAYS: &str = include_str!("../../../../tests/data/implicit.csv");
const SHAPES: &str = include_str!("../../../../tests/data/implicit_shapes.csv");

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum OracleError {
    #[error("the heading has no column \"{0}\"")]
    Column(&'static str),
    /// Counted from 1.
    #[error("line {0}: {1}")]
    Line(usize, String),
    #[error("there are no rays")]
    Empty,
}

fn at(line: usize, what: impl ToString) -> OracleError {
    OracleError::Line(line, what.to_string())
}

#[derive(Debug, Clone)]
pub struct OracleRay {
    shape: String,
    class: String,
    pub ray: Ray,
    /// Hits count after this, and at it where it is 0.
    pub t_min: f64,
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

#[derive(Debug, Clone)]
pub struct Oracle {
    pub shapes: Vec<OracleShape>,
    rays: Vec<OracleRay>,
}

impl Oracle {
    /// Reads both tables; what is not given is taken from the ones that come with the program.
    ///
    /// # Errors
    /// [`OracleError`] where a table has no rays, columns are missing or a line cannot be read.
    pub fn new(rays: Option<&str>, shapes: Option<&str>) -> Result<Self, OracleError> {
        let shapes =
            read_shapes(shapes.unwrap_or(SHAPES)).map_err(|(line, what)| at(line, what))?;
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

    pub fn shape(&self, name: &str) -> Option<&OracleShape> {
        self.shapes.iter().find(|shape| shape.name == name)
    }
}

fn read_rays(text: &str, shapes: &[OracleShape]) -> Result<Vec<OracleRay>, OracleError> {
    const COLUMNS: [&str; 12] = [
        "shape", "class", "ox", "oy", "oz", "dx", "dy", "dz", "tmin", "hit", "t", "gap",
    ];
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .from_reader(text.as_bytes());
    let heading = reader.headers().map_err(|e| at(1, e))?;
    if let Some(missing) = COLUMNS
        .iter()
        .find(|name| heading.iter().all(|h| h != **name))
    {
        return Err(OracleError::Column(missing));
    }
    let mut rays = Vec::new();
    for (line, record) in (2..).zip(reader.deserialize()) {
        let record: HashMap<String, String> = record.map_err(|e| at(line, e))?;
        let text = |column: &str| record.get(column).map_or("", String::as_str);
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
