//! Reading transforms, with entries as exact as they can be.

use glam::DVec3;

use super::fields::{Fields, Item, Report, every, one_of};
use super::tree::{Place, Value};
use crate::math::affine::Affine;
use crate::math::exact::Exact;
use crate::math::number::Number;

/// Transforms by their keys.
type Reader = fn(Item<'_>) -> Option<Affine>;
const STEPS: [(&str, Reader); 8] = [
    ("translate", |item| item.vector().map(Affine::translate)),
    ("rotate_x", |item| Some(rotation(DVec3::X, item.number()?))),
    ("rotate_y", |item| Some(rotation(DVec3::Y, item.number()?))),
    ("rotate_z", |item| Some(rotation(DVec3::Z, item.number()?))),
    ("rotate", rotate),
    ("scale", |item| scale(&item)),
    ("shear", shear),
    ("matrix", |item| matrix(&item)),
];

/// Reads a list of transforms; the first acts first.
pub(super) fn read(item: &Item<'_>) -> Option<Affine> {
    let expected = "an array of transforms, such as [{ rotate_y = 30 }, { scale = 2 }]";
    let steps = item.list(expected)?.into_iter().map(|item| {
        let keys = STEPS.map(|(key, _)| key);
        let (key, item) = Fields::open(item, &keys)?.exactly_one(&keys)?;
        let (_, read) = STEPS.iter().find(|(own, _)| *own == key)?;
        read(item)
    });
    let composed = every(steps)?.into_iter();
    let composed = composed.reduce(|first, then| then.after(&first));
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

fn rotate(item: Item<'_>) -> Option<Affine> {
    let fields = Fields::open(item, &["axis", "angle"])?;
    let axis = fields.required("axis", "axis = [x, y, z]", |axis| axis.direction());
    let angle = fields.required("angle", "angle = degrees", |angle| angle.number());
    Some(rotation(axis?, angle?))
}

fn scale(item: &Item<'_>) -> Option<Affine> {
    let factor = |item: &Item<'_>| item.number_that("a factor other than 0", |x| x != 0.0);
    if !matches!(item.node.value, Value::List(_)) {
        return factor(item).map(|s| Affine::scale(DVec3::splat(s)));
    }
    let numbers = item.vector()?;
    for entry in item.list("")? {
        factor(&entry)?;
    }
    Some(Affine::scale(numbers))
}

/// `xy = k` adds k·y to x, and so on.
fn shear(item: Item<'_>) -> Option<Affine> {
    const KEYS: [(&str, usize, usize); 6] = [
        ("xy", 0, 1),
        ("xz", 0, 2),
        ("yx", 1, 0),
        ("yz", 1, 2),
        ("zx", 2, 0),
        ("zy", 2, 1),
    ];
    let names = KEYS.map(|(name, ..)| name);
    let fields = Fields::open(item, &names)?;
    if fields.table.entries.is_empty() {
        return fields.missing(format!("{} is empty", fields.what), &one_of(&names));
    }
    let mut affine = Affine::IDENTITY;
    for (name, row, column) in KEYS {
        affine.rows[row][column] = fields.optional(name, 0.0, |number| number.number())?;
    }
    Some(affine)
}

fn matrix(item: &Item<'_>) -> Option<Affine> {
    let expected = "3 rows of 4 numbers, or 4 with [0, 0, 0, 1] as the last";
    let entries = item.list(expected)?;
    if !(3..=4).contains(&entries.len()) {
        let message = format!("{} has {} rows", item.path, entries.len());
        return item.fail(message, expected);
    }
    let mut rows = [[0.0; 4]; 4];
    for (row, entry) in rows.iter_mut().zip(&entries) {
        *row = entry.numbers()?;
    }
    if let Some(last) = entries.get(3)
        && rows[3] != [0.0, 0.0, 0.0, 1.0]
    {
        let message = format!("the last row of {} is not [0, 0, 0, 1]", item.path);
        return last.fail(message, "an affine matrix");
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
