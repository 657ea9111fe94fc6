//! Unit normals of implicit surfaces, also where the gradient vanishes.
//!
//! The gradient gives the normal wherever it is larger than the noise of its evaluation. It
//! vanishes at cusps and nodes, which have no normal, but also at points where the surface is
//! smooth: on the heart's curve z = 0, x² + 9/4 y² = 1 the field is locally a³ − b³, whose
//! gradient is zero although a = b is as smooth as can be. There the normal is
//!
//! 1. that of the surface *beside* the point: the line of the ray is moved sideways by a small
//!    distance, in four directions and by growing steps, until it meets a change of sign near by
//!    where the gradient is larger than its noise; at a smooth point this is the normal but for
//!    the curvature over that distance, at a node that of one of the sheets;
//! 2. where nothing changes sign beside it (a field that is a square), the gradient at points
//!    displaced *back* along the ray, where it points to the side that the ray comes from;
//! 3. where all of these vanish, the direction that the ray comes from.
//!
//! Close to such points the gradient is small but not noise, and turns so fast that the rounding of
//! the hit's own coordinates decides where it points. Where an enclosure of a polynomial's hit is known
//! (as for `trace`), a gradient that is not certain to [`SHARP`] is taken at the exact root instead: t
//! narrowed to some 2⁻²⁴⁴ of the clipped ray and everything else exact
//! (`shape::implicit::certified`). At both ends
//! of that enclosure it has the same direction, or else the point is singular for all that could
//! matter, and the rule above holds.

use glam::DVec3;

use super::bounded;
use super::evaluate::Field;

/// A gradient gives a direction where its error is below this part of it: an angle of a
/// milliradian, less than a picture shows.
const NOISE: f64 = 1.0 / 1024.0;
/// The same where an enclosure of the hit is known: an angle that six printed digits do not show. Most
/// errors are far below, for the bound adds up errors that hardly ever have the same sign.
pub const SHARP: f64 = 1.0 / (1u64 << 22) as f64;
/// First distance to look beside a point, relative to the size of the clip box: half the digits,
/// so that a root's own rounding, 2⁻⁵², is as small against it as it is against 1.
const FIRST: f64 = 1.0 / 67_108_864.0;
/// Growth of the distance, and how often it grows: up to 2⁻¹⁰ of the box.
const GROWTH: f64 = 16.0;
const DISTANCES: usize = 5;
/// Steps on each side of the point in which a moved line is searched, over four distances.
const STEPS: i32 = 16;

/// Outward unit normal, in object coordinates, of the surface f = 0 at a point on it that is met
/// in this direction (any length but zero). `size` is that of the clip box. Always finite and of
/// unit length where direction and point are finite.
pub fn outward(field: &Field, point: DVec3, direction: DVec3, size: f64) -> DVec3 {
    if let Some(normal) = of_gradient(field, point) {
        return normal;
    }
    let along = unit(direction).unwrap_or(DVec3::Z);
    let distances = std::iter::successors(Some(size * FIRST), |r| Some(r * GROWTH));
    let distances = || distances.clone().take(DISTANCES);
    let beside = distances().find_map(|r| beside(field, point, along, r));
    let behind = || distances().find_map(|r| of_gradient(field, point - along * r));
    beside.or_else(behind).unwrap_or(-along)
}

fn of_gradient(field: &Field, point: DVec3) -> Option<DVec3> {
    let (gradient, error) = bounded::gradient(field, point, 0.0);
    // Written so that NaN fails.
    let clear = error <= gradient.length() * NOISE && error.is_finite();
    unit(gradient).filter(|_| clear)
}

fn unit(v: DVec3) -> Option<DVec3> {
    // The squares of very short or long vectors would leave the range of f64.
    (v / v.abs().max_element()).try_normalize()
}

/// The normal at a change of sign near the point on a line that is moved by `r`.
fn beside(field: &Field, point: DVec3, along: DVec3, r: f64) -> Option<DVec3> {
    let (u, v) = along.any_orthonormal_pair();
    // Directions that are along no axis: singular curves like to be.
    let (sine, cosine) = (libm::sin(1.0), libm::cos(1.0));
    let (a, b) = (u * cosine + v * sine, v * cosine - u * sine);
    [a, b, -a, -b].into_iter().find_map(|sideways| {
        let start = point + sideways * r;
        of_gradient(field, start + along * change(field, start, along, r)?)
    })
}

/// The change of sign nearest to the start of a line, within four `r` on both sides.
fn change(field: &Field, start: DVec3, along: DVec3, r: f64) -> Option<f64> {
    let step = 4.0 * r / f64::from(STEPS);
    let negative = |t: f64| field.value(start + along * t) < 0.0;
    let at_start = negative(0.0);
    let changed = (1..=STEPS)
        .flat_map(|i| [f64::from(i), f64::from(-i)])
        .find(|i| negative(i * step) != at_start)?;
    let (mut near, mut far) = (0.0, changed * step);
    // As many halvings as there are bits between the interval and the last digit.
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (near + far);
        if negative(middle) == at_start {
            near = middle;
        } else {
            far = middle;
        }
    }
    Some(far)
}
