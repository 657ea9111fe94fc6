//! t, point and normal of a decided crossing, rounded once.

use glam::DVec3;

use super::ladder::{Frame, ScaledRay};
use super::line::{Crossing, Feature, LocalRay};
use super::{Hit, Tier};
use crate::math::number::{Number, dot, power_of_two};

/// Error allowed to a value before it is rounded to f64: a sixteenth of a unit in the last place
/// (relative to the value for t, to 1 for the others).
const SHARP: f64 = f64::EPSILON / 32.0;

/// t of a crossing, in units of the scaled direction. A root is taken in the form without
/// cancellation: (−b ± √disc) / a where the signs agree, else c / (−b ∓ √disc).
pub fn parameter<N: Number>(crossing: &Crossing, ray: &LocalRay<N>) -> N {
    let dimensions = match crossing.fraction(ray) {
        Ok(t) => return t.numerator.divided_by(&t.denominator),
        Err(dimensions) => dimensions,
    };
    let quadratic = ray.quadratic(dimensions);
    let root = quadratic.discriminant.square_root();
    let vertex = quadratic.b.negated();
    let ahead = vertex.to_f64() >= 0.0;
    if ahead == crossing.leaving {
        let sum = vertex.plus(&root.negated_if(!crossing.leaving));
        sum.divided_by(&quadratic.a)
    } else {
        let sum = vertex.plus(&root.negated_if(crossing.leaving));
        quadratic.c.divided_by(&sum)
    }
}

fn rounded<N: Number>(v: &[N; 3]) -> DVec3 {
    DVec3::from_array(v.each_ref().map(N::to_f64))
}

fn within<N: Number>(v: &[N; 3], bound: f64) -> bool {
    v.iter().all(|x| x.error() <= bound)
}

/// The hit at a crossing that `tier` has decided; `None` where this kind of number is not sharp enough.
pub fn hit<N: Number>(
    crossing: &Crossing,
    frame: &Frame<N>,
    ray: &ScaledRay,
    tier: Tier,
) -> Option<Hit> {
    let line = frame.local(ray);
    let t = parameter(crossing, &line);
    let sharp_t = t.error() <= SHARP * t.to_f64().abs();
    if !sharp_t {
        return None;
    }
    // Canonical coordinates times the scale, a common factor that does not change the normal.
    let at = [0, 1, 2].map(|i| line.origin[i].plus(&line.direction[i].times(&t)));
    let mut local = at.each_ref().map(|x| x.divided_by(&line.scale));
    let mut outward = [0.0; 3].map(N::of);
    match crossing.feature {
        Feature::Round { dimensions } => outward[..dimensions].clone_from_slice(&at[..dimensions]),
        Feature::Face { axis, positive } => {
            outward[axis] = N::of(if positive { 1.0 } else { -1.0 });
            local[axis] = outward[axis].clone();
        }
        Feature::Flat => {
            outward[2] = N::of(1.0);
            local[2] = N::of(0.0);
        }
    }
    // Normals go by the inverse transpose, here the transposed adjugate.
    let normal = [0, 1, 2].map(|j| {
        dot(
            &outward,
            &frame.adjugate.each_ref().map(|row| row[j].clone()),
        )
    });
    let length = dot(&normal, &normal).square_root();
    let normal = normal.map(|x| x.divided_by(&length));
    let origin: [N; 3] = ray.origin();
    let direction: [N; 3] = ray.direction();
    let point = [0, 1, 2].map(|i| origin[i].plus(&direction[i].times(&t)));
    let sharp = within(&local, SHARP)
        && within(&normal, SHARP)
        && within(&point, SHARP * rounded(&point).abs().max_element());
    sharp.then(|| Hit {
        t: t.to_f64() * power_of_two(-ray.exponent),
        point: rounded(&point),
        normal: rounded(&normal),
        local: rounded(&local),
        front: !crossing.leaving,
        tier,
    })
}
