//! Surfaces in a table. The tests of etalon include this file.

use std::sync::Arc;

use etalon::inside::field::expression::{Expression, Parameter, parse, rational};

/// A surface within the cube [−half_width, half_width]³.
#[derive(Debug, Clone)]
pub struct OracleShape {
    /// What rays call it.
    pub name: String,
    pub half_width: f64,
    pub degree: u32,
    pub field: Arc<Expression>,
}

/// Lines `name;half_width;degree;expression[, NAME=value]` below a heading; or the number of the line
/// that cannot be read, counted from 1, and what is wrong with it.
pub fn read_shapes(text: &str) -> Result<Vec<OracleShape>, (usize, String)> {
    let lines = (1..).zip(text.lines()).skip(1);
    let lines = lines.filter(|(_, line)| !line.trim().is_empty());
    let read = |(number, line): (usize, &str)| read_shape(line).map_err(|what| (number, what));
    lines.map(read).collect()
}

fn read_shape(line: &str) -> Result<OracleShape, String> {
    let fields: Vec<&str> = line.split(';').collect();
    let &[name, half, degree, written] = fields.as_slice() else {
        return Err("not name;half_width;degree;expression".to_owned());
    };
    let half_width: f64 = half.parse().map_err(|e| format!("{e}"))?;
    if !(half_width > 0.0 && half_width.is_finite()) {
        return Err("the half width is not positive".to_owned());
    }
    let mut parts = written.split(", ");
    let expression = parts.next().unwrap_or_default();
    let parameters = parts.filter_map(|part| {
        let (name, value) = part.split_once('=')?;
        Some(Parameter {
            name: name.trim().to_owned(),
            value: rational(value.trim())?,
        })
    });
    let parameters: Vec<Parameter> = parameters.collect();
    let field = parse(expression, &parameters).map_err(|e| e.to_string())?;
    Ok(OracleShape {
        name: name.to_owned(),
        half_width,
        degree: degree.parse().map_err(|e| format!("degree: {e}"))?,
        field: Arc::new(field),
    })
}
