//! Reading transforms, with entries as exact as they can be.

use glam::DVec3;

use super::fields::{Fields, Report, every, one_of};
use super::tree::{Node, Place, Value};
use crate::math::affine::Affine;
use crate::math::exact::Exact;
use crate::math::number::Number;

const STEPS: &[&str] = &[
    "translate",
    "rotate_x",
    "rotate_y",
    "rotate_z",
    "rotate",
    "scale",
    "shear",
    "matrix",
];

/// Reads a list of transforms; the first acts first.
pub(super) fn read(report: &Report, what: &str, node: &Node) -> Option<Affine> {
    let expected = "an array of transforms, such as [{ rotate_y = 30 }, { scale = 2 }]";
    let nodes = report.list(what, node, expected)?;
    let steps = nodes.iter().enumerate();
    let steps = every(steps.map(|(i, node)| step(report, &format!("{what}[{i}]"), node)))?;
    let composed = steps.into_iter().reduce(|first, then| then.after(&first));
    Some(composed.unwrap_or(Affine::IDENTITY))
}

/// A matrix that maps space onto a plane, or whose entries are not numbers, places nothing.
pub(super) fn check(report: &Report, place: Place, affine: &Affine) -> Option<()> {
    if !affine.rows.as_flattened().iter().all(|x| x.is_finite()) {
        let message = "the object's matrix has entries that are infinite";
        return report.fail(place, message, "sizes and transforms that stay finite");
    }
    if is_singular(affine) {
        let message = "the object's matrix is singular";
        return report.fail(place, message, "an invertible transform");
    }
    Some(())
}

fn step(report: &Report, what: &str, node: &Node) -> Option<Affine> {
    let fields = Fields::open(report, what, node, STEPS)?;
    let (kind, inner) = fields.exactly_one(STEPS)?;
    let path = fields.path(kind);
    match kind {
        "translate" => report.vector(&path, inner).map(Affine::translate),
        "rotate_x" => Some(rotation(DVec3::X, report.number(&path, inner)?)),
        "rotate_y" => Some(rotation(DVec3::Y, report.number(&path, inner)?)),
        "rotate_z" => Some(rotation(DVec3::Z, report.number(&path, inner)?)),
        "rotate" => rotate(report, &path, inner),
        "scale" => scale(report, &path, inner),
        "shear" => shear(report, &path, inner),
        _ => matrix(report, &path, inner),
    }
}

fn rotate(report: &Report, what: &str, node: &Node) -> Option<Affine> {
    let fields = Fields::open(report, what, node, &["axis", "angle"])?;
    let axis = fields.required("axis", "axis = [x, y, z]", |what, node| {
        report.direction(what, node)
    });
    let angle = fields.required("angle", "angle = degrees", |what, node| {
        report.number(what, node)
    });
    Some(rotation(axis?, angle?))
}

fn scale(report: &Report, what: &str, node: &Node) -> Option<Affine> {
    let factor = |what: &str, node: &Node| {
        report.number_that(what, node, "a factor other than 0", |x| x != 0.0)
    };
    let Value::List(nodes) = &node.value else {
        return factor(what, node).map(|s| Affine::scale(DVec3::splat(s)));
    };
    let numbers = report.vector(what, node)?;
    for (i, node) in nodes.iter().enumerate() {
        factor(&format!("{what}[{i}]"), node)?;
    }
    Some(Affine::scale(numbers))
}

/// `xy = k` adds k·y to x, and so on.
fn shear(report: &Report, what: &str, node: &Node) -> Option<Affine> {
    const KEYS: [(&str, usize, usize); 6] = [
        ("xy", 0, 1),
        ("xz", 0, 2),
        ("yx", 1, 0),
        ("yz", 1, 2),
        ("zx", 2, 0),
        ("zy", 2, 1),
    ];
    let names = KEYS.map(|(name, ..)| name);
    let fields = Fields::open(report, what, node, &names)?;
    if fields.table.entries.is_empty() {
        return fields.missing(format!("{what} is empty"), &one_of(&names));
    }
    let mut affine = Affine::IDENTITY;
    for (name, row, column) in KEYS {
        affine.rows[row][column] =
            fields.optional(name, 0.0, |what, node| report.number(what, node))?;
    }
    Some(affine)
}

fn matrix(report: &Report, what: &str, node: &Node) -> Option<Affine> {
    let expected = "3 rows of 4 numbers, or 4 with [0, 0, 0, 1] as the last";
    let nodes = report.list(what, node, expected)?;
    if !(3..=4).contains(&nodes.len()) {
        let message = format!("{what} has {} rows", nodes.len());
        return report.fail(node.place, message, expected);
    }
    let mut rows = [[0.0; 4]; 4];
    for (i, (row, node)) in rows.iter_mut().zip(nodes).enumerate() {
        *row = report.numbers(&format!("{what}[{i}]"), node)?;
    }
    if let Some(last) = nodes.get(3)
        && rows[3] != [0.0, 0.0, 0.0, 1.0]
    {
        let message = format!("the last row of {what} is not [0, 0, 0, 1]");
        return report.fail(last.place, message, "an affine matrix");
    }
    Some(Affine {
        rows: [rows[0], rows[1], rows[2]],
    })
}

/// Rotation about a unit axis, counterclockwise when looking against it (Rodrigues 1840):
/// R = a aᵀ + (1 − a aᵀ) cos θ + [a]ₓ sin θ. Written this way an axis along x, y or z gives
/// entries of exactly 0, 1, ± sin θ and cos θ.
fn rotation(axis: DVec3, degrees: f64) -> Affine {
    let (sin, cos) = sin_cos_degrees(degrees);
    let a = axis.to_array();
    let mut affine = Affine::IDENTITY;
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let square = a[i] * a[i];
        affine.rows[i][i] = square + (1.0 - square) * cos;
        let product = a[i] * a[j] * (1.0 - cos);
        affine.rows[i][j] = product - a[k] * sin;
        affine.rows[j][i] = product + a[k] * sin;
    }
    // 0 − 0 is 0 but −0 + 0 is 0 as well; only a lone −0 is left to be made 0.
    affine.rows = affine.rows.map(|row| row.map(|entry| entry + 0.0));
    affine
}

/// Sine and cosine of an angle in degrees, exact where they are rational (Niven 1956: at
/// multiples of 90°, and one of the two at multiples of 30°).
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    // Exact: the remainder always is, and the difference is because both are within a factor of
    // two of each other or one of them is 0 (Sterbenz 1974).
    let angle = degrees % 360.0;
    let quarters = (angle / 90.0).round();
    let rest = angle - 90.0 * quarters;
    let (sin, cos) = if rest.abs() == 30.0 {
        (0.5_f64.copysign(rest), 0.75_f64.sqrt())
    } else {
        let radians = rest.to_radians();
        (libm::sin(radians), libm::cos(radians))
    };
    // `quarters` is an integer from −4 to 4.
    match quarters as i32 & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Whether the determinant of the linear part is exactly zero.
pub(super) fn is_singular(affine: &Affine) -> bool {
    let rows = affine
        .rows
        .map(|[x, y, z, _]| [x, y, z].map(|entry| Exact::scaled(entry, 0)));
    let minor = |i: usize, j: usize| {
        let product = |a: usize, b: usize| rows[1][a].times(&rows[2][b]);
        product(i, j).minus(&product(j, i))
    };
    let terms = [(0, minor(1, 2)), (1, minor(2, 0)), (2, minor(0, 1))];
    let terms = terms.map(|(column, minor)| rows[0][column].times(&minor));
    terms[0]
        .plus(&terms[1])
        .plus(&terms[2])
        .magnitude()
        .is_none()
}
