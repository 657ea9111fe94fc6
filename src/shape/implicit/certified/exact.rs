//! One ray, decided exactly.

use std::cmp::Ordering;

use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};

use super::Certified;
use crate::math::exact::Exact;
use crate::root::exact::{ExactRoot, Point, Stretch, first_root};
use crate::shape::Ray;
use crate::shape::ladder::ScaledRay;

/// A ray in integers: local point = (origin + t direction) / scale.
struct IntegerRay {
    origin: [BigInt; 3],
    direction: [BigInt; 3],
    scale: BigInt,
}

/// What the ray's start is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ExactStart {
    /// Nothing is known.
    Free,
    /// A point of the surface, rounded with this unit roundoff.
    OnSurface(f64),
}

impl IntegerRay {
    /// The common power of two is of no concern. t is in units of the scaled direction.
    fn new(placed: &Certified, ray: &ScaledRay) -> Self {
        let line = placed.ladder.exact.local(ray);
        let all = line
            .origin
            .iter()
            .chain(&line.direction)
            .chain([&line.scale]);
        let exponents = all.filter(|x| x.magnitude().is_some()).map(|x| x.parts().1);
        let least = exponents.min().unwrap_or(0);
        let integer = |x: &Exact| {
            let (mantissa, exponent) = x.parts();
            if mantissa.is_zero() {
                BigInt::zero()
            } else {
                mantissa << (exponent - least).unsigned_abs()
            }
        };
        Self {
            origin: line.origin.each_ref().map(integer),
            direction: line.direction.each_ref().map(integer),
            scale: integer(&line.scale),
        }
    }

    /// Where the line is in the closed clip box and the limits are kept; `None` for nowhere.
    fn stretch(&self, placed: &Certified, limits: [f64; 2]) -> Option<Stretch> {
        let [t_min, t_max] = limits;
        let mut stretch = Stretch {
            low: Point::of(t_min),
            low_counts: t_min == 0.0,
            // Where there is no limit, a face follows: the direction is not zero.
            high: Point::of(f64::MAX),
            high_counts: false,
        };
        if t_max < f64::MAX {
            stretch.high = Point::of(t_max);
        }
        for axis in 0..3 {
            let (o, d) = (&self.origin[axis], &self.direction[axis]);
            // Lower face ≤ (o + t d) / scale ≤ upper face.
            let room = [placed.clip.lower[axis], placed.clip.upper[axis]].map(|face| {
                let face = Point::of(face);
                (
                    &face.numerator * &self.scale - o * &face.denominator,
                    face.denominator,
                )
            });
            if d.is_zero() {
                if room[0].0.is_positive() || room[1].0.is_negative() {
                    return None;
                }
                continue;
            }
            let [mut enter, mut leave] = room.map(|(room, denominator)| Point {
                numerator: if d.is_negative() { -room } else { room },
                denominator: denominator * d.abs(),
            });
            if d.is_negative() {
                std::mem::swap(&mut enter, &mut leave);
            }
            if enter.compare(&stretch.low) == Ordering::Greater {
                (stretch.low, stretch.low_counts) = (enter, true);
            }
            if leave.compare(&stretch.high) == Ordering::Less {
                (stretch.high, stretch.high_counts) = (leave, true);
            }
        }
        Some(stretch)
    }
}

/// The first hit of a ray, with its multiplicity; t in units of the direction.
pub(super) fn first_hit(
    placed: &Certified,
    ray: &Ray,
    limits: [f64; 2],
    start: ExactStart,
) -> Option<ExactRoot> {
    if !ray.is_valid() || limits[0].is_nan() || limits[1].is_nan() {
        return None;
    }
    let scaled = ScaledRay::new(ray);
    let unit = crate::math::number::power_of_two(scaled.exponent());
    let line = IntegerRay::new(placed, &scaled);
    let stretch = line.stretch(placed, limits.map(|t| t * unit))?;
    let coordinates = [0, 1, 2].map(|i| [line.origin[i].clone(), line.direction[i].clone()]);
    let one = [line.scale.clone(), BigInt::zero()];
    let mut first: Option<ExactRoot> = None;
    for factor in &placed.factors {
        let mut coefficients = factor.program.exact(&coordinates, &one);
        if let ExactStart::OnSurface(roundoff) = start
            && is_start(&coefficients, roundoff)
        {
            coefficients = beyond_start(coefficients);
        }
        let Some(root) = first_root(&coefficients, &stretch) else {
            continue;
        };
        let root = ExactRoot {
            multiplicity: root.multiplicity.map(|m| m * factor.power),
            ..root
        };
        first = Some(match first {
            Some(other) => earlier(other, root),
            None => root,
        });
    }
    first.map(|root| ExactRoot {
        t: root.t / unit,
        enclosure: root.enclosure.map(|t| t / unit),
        ..root
    })
}

/// The earlier root; of two that f64 cannot tell apart, what holds for both.
fn earlier(a: ExactRoot, b: ExactRoot) -> ExactRoot {
    let (first, other) = if a.t <= b.t { (a, b) } else { (b, a) };
    if first.enclosure[1] < other.enclosure[0] {
        return first;
    }
    ExactRoot {
        multiplicity: None,
        enclosure: [
            first.enclosure[0].min(other.enclosure[0]),
            first.enclosure[1].min(other.enclosure[1]),
        ],
        ..first
    }
}

/// Whether the factor is the one whose root the start is: its value is small beside what it is
/// elsewhere on the line. The start is off by some 2⁴ roundings of coordinates that may be 2¹²
/// times as large as the object; a factor that is not the one is not as small.
fn is_start(coefficients: &[BigInt], roundoff: f64) -> bool {
    let largest = coefficients.iter().skip(1).map(BigInt::bits).max();
    let bits = (1.0 / roundoff).log2() as u64 - 16;
    coefficients[0].bits() + bits < largest.unwrap_or(0)
}

/// The field less its value at the start, divided by t: the level through the start itself.
fn beyond_start(coefficients: Vec<BigInt>) -> Vec<BigInt> {
    let mut rest: Vec<BigInt> = coefficients.into_iter().skip(1).collect();
    while rest.len() > 1 && rest[0].is_zero() {
        rest.remove(0);
    }
    if rest.is_empty() {
        rest.push(BigInt::one());
    }
    rest
}
