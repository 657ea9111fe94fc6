//! Bounds of the part of a ray within a box, from which finders by enclosures start.

use std::cmp::Ordering;

use glam::DVec3;

use super::along::EnclosedLine;
use crate::math::double_double::DoubleDouble;
use crate::math::interval::ScalarInterval;
use crate::math::number::Number;
use crate::math::scalar_lane::One;
use crate::shape::line::LocalRay;

/// A stretch of a ray, counted from about where it enters the box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clipped {
    /// t where s is 0; t = start + s.
    pub start: f64,
    /// The line for s ≥ 0.
    pub line: EnclosedLine,
    /// Bounds of t where the stretch begins.
    pub near: [f64; 2],
    /// Bounds of t where the stretch ends.
    pub far: [f64; 2],
}

/// The part of a ray with t in [t_min, t_max] within a closed box; `None` where there is none.
///
/// The bounds hold for the exact ray: those of the given line in double-double, whose own error is
/// known, are rounded outward.
pub fn clipped(
    ray: &LocalRay<DoubleDouble>,
    inside: &[DVec3; 2],
    [t_min, t_max]: [f64; 2],
) -> Option<Clipped> {
    let origin = divided(&ray.origin, &ray.scale);
    let direction = divided(&ray.direction, &ray.scale);
    let (mut near, mut far) = ([t_min; 2], [t_max; 2]);
    for axis in 0..3 {
        let [lower, upper] = inside.map(|corner| ScalarInterval::splat(One, [corner[axis]; 2]));
        let (o, d) = (enclosed(&origin[axis]), enclosed(&direction[axis]));
        if d.low == 0.0 && d.high == 0.0 {
            let outside = o.high < lower.low || o.low > upper.high;
            let within = o.low >= lower.low && o.high <= upper.high;
            if outside {
                return None;
            }
            if !within {
                // Whether the ray runs just inside or just outside of a face is not known.
                near[1] = f64::INFINITY;
            }
            continue;
        }
        let (first, second) = ((lower - o) / d, (upper - o) / d);
        let (enter, leave) = (first.smaller(second), first.larger(second));
        near = [near[0].max(enter.low), near[1].max(enter.high)];
        far = [far[0].min(leave.low), far[1].min(leave.high)];
    }
    let bounded = near[0].is_finite() && far[1].is_finite();
    if !bounded || near[0] > far[1] {
        return None;
    }
    let t: DoubleDouble = DoubleDouble::of(near[0]);
    let base = [0, 1, 2].map(|i| {
        let at = ray.origin[i].plus(&ray.direction[i].times(&t));
        bounds(&at.divided_by(&ray.scale))
    });
    Some(Clipped {
        start: near[0],
        line: EnclosedLine {
            base,
            direction: direction.each_ref().map(bounds),
        },
        near,
        far,
    })
}

/// Quotients, in which zero stays exact; division alone would give it an error.
fn divided(v: &[DoubleDouble; 3], scale: &DoubleDouble) -> [DoubleDouble; 3] {
    v.each_ref().map(|x| match x.sign() {
        Some(Ordering::Equal) => DoubleDouble::of(0.0),
        _ => x.divided_by(scale),
    })
}

fn enclosed(x: &DoubleDouble) -> ScalarInterval {
    ScalarInterval::splat(One, bounds(x))
}

/// The narrowest bounds in f64 that the error allows.
fn bounds(x: &DoubleDouble) -> [f64; 2] {
    let middle = x.to_f64();
    let rest = x.minus(&DoubleDouble::of(middle));
    if rest.sign() == Some(Ordering::Equal) {
        return [middle; 2];
    }
    let radius = around(&rest);
    // Within one step of the leading word, the sign of the rest tells on which side x lies.
    let step = middle.next_up() - middle;
    let low = match rest.sign() {
        Some(Ordering::Greater) => middle,
        _ if radius <= 0.5 * step => middle.next_down(),
        _ => lower(middle, radius),
    };
    let high = match rest.sign() {
        Some(Ordering::Less) => middle,
        _ if radius <= step => middle.next_up(),
        _ => -lower(-middle, radius),
    };
    [low, high]
}

/// A bound of |x|; infinite where nothing is known.
fn around(x: &DoubleDouble) -> f64 {
    let size = (x.to_f64().abs() + x.error()) * (1.0 + 8.0 * f64::EPSILON);
    if size.is_nan() { f64::INFINITY } else { size }
}

fn lower(x: f64, radius: f64) -> f64 {
    (ScalarInterval::point(One, x) - ScalarInterval::point(One, radius)).low
}
