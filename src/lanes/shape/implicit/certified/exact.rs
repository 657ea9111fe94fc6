//! The first hit of one ray, decided exactly.

use std::cmp::Ordering;

use num_bigint::BigInt;
use num_traits::{One, Signed, ToPrimitive, Zero};

use super::Certified;
use crate::field::program::{Program, Whole};
use crate::math::exact::Exact;
use crate::math::number::{Number, power_of_two};
use crate::root::exact::{ExactRoot, Point, Stretch, first_root, sharpened};
use crate::shape::Ray;
use crate::shape::ladder::ScaledRay;

/// A ray in integers: local point = (origin + t direction) / scale, with t in units of the scaled
/// direction and a common power of two left out.
struct IntegerRay {
    /// Origin and direction by coordinate.
    coordinates: [[BigInt; 2]; 3],
    scale: BigInt,
    /// Factor from t of the world ray to t here.
    unit: f64,
}

impl IntegerRay {
    fn new(placed: &Certified, ray: &Ray) -> Self {
        let scaled = ScaledRay::new(ray);
        let line = placed.ladder.exact.local(&scaled);
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
            coordinates: [0, 1, 2].map(|i| [&line.origin[i], &line.direction[i]].map(integer)),
            scale: integer(&line.scale),
            unit: power_of_two(scaled.exponent),
        }
    }

    /// Coefficients of a factor's field in powers of t.
    fn coefficients(&self, program: &Program) -> Option<Vec<BigInt>> {
        program.powers(&self.coordinates, &self.scale, program.result.degree)
    }

    /// Where the line is in the closed clip box and the limits are kept; `None` for nowhere.
    fn stretch(&self, placed: &Certified, limits: [f64; 2]) -> Option<Stretch> {
        let [t_min, t_max] = limits;
        let mut stretch = Stretch {
            low: Point::of(t_min),
            low_counts: t_min == 0.0,
            // Where there is no limit, a face is: the direction is not zero.
            high: Point::of(f64::MAX),
            high_counts: false,
        };
        if t_max < f64::MAX {
            stretch.high = Point::of(t_max);
        }
        for axis in 0..3 {
            let [o, d] = &self.coordinates[axis];
            // Lower face ≤ (o + t d) / scale ≤ upper face.
            let room = [placed.clip[0][axis], placed.clip[1][axis]].map(|face| {
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

/// The first hit of a ray, with its multiplicity, perhaps near the hint; t in units of the direction.
/// A ray that leaves the surface starts at a point that was rounded with `start_roundoff`.
pub(super) fn first_hit(
    placed: &Certified,
    ray: &Ray,
    limits: [f64; 2],
    start_roundoff: Option<f64>,
    hint: f64,
) -> Option<ExactRoot> {
    if !ray.is_valid() || limits[0].is_nan() || limits[1].is_nan() {
        return None;
    }
    let line = IntegerRay::new(placed, ray);
    let unit = line.unit;
    let stretch = line.stretch(placed, limits.map(|t| t * unit))?;
    let hint = Some(hint * unit).filter(|x| x.is_finite());
    let mut first: Option<ExactRoot> = None;
    for factor in &placed.factors {
        let mut coefficients = line.coefficients(&factor.program)?;
        if let Some(roundoff) = start_roundoff
            && is_start(&coefficients, roundoff)
        {
            coefficients = beyond_start(coefficients);
        }
        let Some(root) = first_root(&coefficients, &stretch, hint) else {
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

/// The local point of a ray's first hit: the exact points at both ends of its enclosure narrowed by
/// this many bits, up to the relative precision of quotients of exact numbers. `None` where the field
/// vanishes there more than once because a factor has a power.
pub(super) fn hit_points(
    placed: &Certified,
    ray: &Ray,
    enclosure: [f64; 2],
    bits: u32,
) -> Option<[[Exact; 3]; 2]> {
    let line = IntegerRay::new(placed, ray);
    let unit = line.unit;
    let mut first: Option<([Exact; 2], u32)> = None;
    for factor in &placed.factors {
        let coefficients = line.coefficients(&factor.program)?;
        let Some(ends) = sharpened(&coefficients, enclosure.map(|t| t * unit), bits) else {
            continue;
        };
        let earlier = first
            .as_ref()
            .is_none_or(|(known, _)| ends[0].minus(&known[0]).sign() == Some(Ordering::Less));
        if earlier {
            first = Some((ends, factor.power));
        }
    }
    let (ends, power) = first?;
    let local = placed.ladder.exact.local(&ScaledRay::new(ray));
    let point = |t: &Exact| {
        [0, 1, 2].map(|i| {
            let place = local.origin[i].plus(&local.direction[i].times(t));
            place.divided_by(&local.scale)
        })
    };
    (power == 1).then(|| ends.each_ref().map(point))
}

/// How many times t is a root of the field along the ray, 0 where it is none; t is in units of the
/// direction.
pub(super) fn order_of_vanishing(
    placed: &Certified,
    program: &Program,
    ray: &Ray,
    t: f64,
) -> usize {
    let line = IntegerRay::new(placed, ray);
    let at = Point::of(t * line.unit);
    // (o + (t + τ) d) / s = (o q + p d + τ' d) / (s q) for t = p / q and τ' = q τ.
    let (p, q) = (&at.numerator, &at.denominator);
    let mut coordinates = line.coordinates;
    for [o, d] in &mut coordinates {
        *o = &*o * q + &*d * p;
    }
    let mut scale = &line.scale * q;
    // Common powers of two are left out.
    let shift = trailing(coordinates.iter().map(|[o, _]| o).chain([&scale]));
    scale >>= shift;
    let shift_directions = trailing(coordinates.iter().map(|[_, d]| d));
    for [o, d] in &mut coordinates {
        *o >>= shift;
        *d >>= shift_directions;
    }
    let degree = program.result.degree;
    let small = small(&coordinates, &scale);
    // Mostly the first two powers decide, and machine integers hold them.
    for highest in [1, 2, 4, degree] {
        let highest = highest.min(degree);
        let quick = small.as_ref().and_then(|(coordinates, scale)| {
            Some(first_other_than_zero(&program.powers(
                coordinates,
                scale,
                highest,
            )?))
        });
        let order = quick.unwrap_or_else(|| {
            let powers = program.powers(&coordinates, &scale, highest);
            powers.map_or(Some(0), |powers| first_other_than_zero(&powers))
        });
        if let Some(order) = order {
            return order;
        }
    }
    0
}

fn first_other_than_zero<N: Whole>(powers: &[N]) -> Option<usize> {
    powers.iter().position(|c| !c.is_zero())
}

fn trailing<'a>(numbers: impl Iterator<Item = &'a BigInt>) -> u64 {
    numbers
        .filter_map(BigInt::trailing_zeros)
        .min()
        .unwrap_or(0)
}

/// The same numbers as machine integers, if they fit.
fn small(coordinates: &[[BigInt; 2]; 3], scale: &BigInt) -> Option<([[i128; 2]; 3], i128)> {
    let mut small = [[0; 2]; 3];
    for (to, from) in small.iter_mut().flatten().zip(coordinates.iter().flatten()) {
        *to = from.to_i128()?;
    }
    Some((small, scale.to_i128()?))
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

/// Whether the start is a root of this factor: whether its value is small beside what it is elsewhere on
/// the line. The start is off by some 2⁴ roundings of coordinates that may be 2¹² times as large as the
/// object, 16 bits in all.
fn is_start(coefficients: &[BigInt], roundoff: f64) -> bool {
    let largest = coefficients.iter().skip(1).map(BigInt::bits).max();
    let bits = (1.0 / roundoff).log2() as u64 - 16;
    coefficients[0].bits() + bits < largest.unwrap_or(0)
}

/// The field less its value at the start, divided by t: what is left when the root at the start is
/// divided out.
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
