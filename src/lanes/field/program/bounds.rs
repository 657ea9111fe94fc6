//! How wrong a rounded evaluation of a program can be, once and for all rays.
//!
//! Both ends of a clipped line lie in a box, so that every coefficient of every form has a
//! majorant, the same for all lines; so have its rounding error and its change with the ends.
//! Running the program on these triples once (Higham 2002, *Accuracy and Stability of Numerical
//! Algorithms*, §3.3, a priori) leaves one bound a ray and none an operation.

use super::{Factor, Program, Step};

/// Bounds of one coefficient, or of all Bernstein coefficients of a field.
#[derive(Debug, Clone, Copy, Default)]
pub struct Bound {
    /// Of its magnitude.
    pub size: f64,
    /// Of its error, the ends taken as exact.
    pub error: f64,
    /// Of its change, for a change of 1 in every coordinate of the ends.
    pub change: f64,
}

/// The rounding errors of an arithmetic.
#[derive(Debug, Clone, Copy)]
pub struct Rounding {
    /// Error of one sum or product, relative to the sum or product of the magnitudes.
    pub unit: f64,
    /// Roundings of one multiplication and addition.
    pub steps: f64,
    pub parts: usize,
}

/// One f64 a number, with fused multiplication and addition.
pub const PLAIN: Rounding = Rounding {
    unit: f64::EPSILON / 2.0,
    steps: 1.0,
    parts: 1,
};

/// Largest error of an operation by underflow, with room for the few operations inside of a
/// double-double one: 2⁻¹⁰⁷⁴ each.
const UNDERFLOW: f64 = 64.0 * f64::from_bits(1);

/// Pays for the rounding of the bounds themselves and for computed numbers being larger than
/// exact ones: a bound is a sum of positive terms of at most 2¹⁰ operations a coefficient.
const INFLATION: f64 = 1.0 + 1.0 / (1 << 20) as f64;

/// Bounds of a field's Bernstein coefficients for lines whose ends lie within `reach` of 0 on each axis.
pub fn bounds(program: &Program, reach: [f64; 3], rounding: Rounding) -> Bound {
    let mut rows = vec![Bound::default(); program.rows];
    for step in &program.steps {
        match step {
            Step::Coordinate { axis, to } => {
                let end = Bound {
                    size: reach[*axis],
                    error: 0.0,
                    change: 1.0,
                };
                rows[to.at..to.at + 2].fill(end);
            }
            Step::Product { a, b, to } => {
                let terms = (a.degree.min(b.degree) + 1) as f64;
                for i in 0..=a.degree {
                    for j in 0..=b.degree {
                        let product = rows[a.at + i].times(rows[b.at + j]);
                        let sum = rows[to.at + i + j];
                        rows[to.at + i + j] = sum.plus(product);
                    }
                }
                for row in &mut rows[to.at..=to.at + to.degree] {
                    *row = row.rounded(terms * rounding.steps, rounding);
                }
            }
            Step::Combination {
                terms,
                constant,
                to,
            } => {
                let mut sum = vec![Bound::of(constant, rounding)];
                for (factor, form) in terms {
                    while sum.len() <= form.degree {
                        sum = elevated(&sum, rounding);
                    }
                    let factor = Bound::of(factor, rounding);
                    for (i, s) in sum.iter_mut().enumerate() {
                        let term = factor.times(rows[form.at + i]);
                        *s = s.plus(term).rounded(rounding.steps, rounding);
                    }
                }
                while sum.len() <= to.degree {
                    sum = elevated(&sum, rounding);
                }
                rows[to.at..=to.at + to.degree].copy_from_slice(&sum);
            }
        }
    }
    let result = program.result;
    let mut field = Bound::default();
    for i in 0..=result.degree {
        let binomial = binomial(result.degree, i);
        // Division by the binomial: its rounded reciprocal and a product.
        let row = rows[result.at + i].rounded(2.0 * rounding.steps, rounding);
        field.size = larger(field.size, row.size / binomial);
        field.error = larger(field.error, row.error / binomial);
        field.change = larger(field.change, row.change / binomial);
    }
    Bound {
        size: field.size * INFLATION,
        error: field.error * INFLATION,
        change: field.change * INFLATION,
    }
}

pub fn binomial(n: usize, i: usize) -> f64 {
    (0..i).fold(1.0, |c, j| c * (n - j) as f64 / (j + 1) as f64)
}

/// The larger; NaN where one is.
fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

fn elevated(form: &[Bound], rounding: Rounding) -> Vec<Bound> {
    let mut result = vec![Bound::default(); form.len() + 1];
    for (i, row) in form.iter().enumerate() {
        for to in &mut result[i..i + 2] {
            *to = to.plus(*row);
        }
    }
    let rounded = |row: &Bound| row.rounded(1.0, rounding);
    result.iter().map(rounded).collect()
}

impl Bound {
    fn of(factor: &Factor, rounding: Rounding) -> Self {
        let [high, low] = factor.parts;
        // Each part is within a unit in the last place of the exact one.
        let left = if rounding.parts == 1 {
            low
        } else {
            low * f64::EPSILON
        };
        Self {
            size: high.abs() * INFLATION,
            error: left.abs() * (1.0 + 2.0 * f64::EPSILON),
            change: 0.0,
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            size: self.size + other.size,
            error: self.error + other.error,
            change: self.change + other.change,
        }
    }

    fn times(self, other: Self) -> Self {
        Self {
            size: self.size * other.size,
            error: self.error * (other.size + other.error) + self.size * other.error,
            change: self.change * other.size + self.size * other.change,
        }
    }

    /// After so many roundings.
    fn rounded(self, count: f64, rounding: Rounding) -> Self {
        Self {
            error: self.error
                + count * (rounding.unit * INFLATION * (self.size + self.error) + UNDERFLOW),
            ..self
        }
    }
}
