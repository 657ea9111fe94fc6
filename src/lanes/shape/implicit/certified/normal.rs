//! The direction of the gradient at a hit where f64 does not determine it.

use glam::DVec3;
use num_bigint::BigInt;
use num_rational::BigRational;

use super::Certified;
use super::exact::hit_points;
use crate::field::differentiate::{Differentiable, Gradients};
use crate::field::tape::{Algebra, Binary, Tape, Unary};
use crate::math::exact::Exact;
use crate::math::number::Number;
use crate::shape::Ray;

/// Bits by which an enclosure is narrowed: f64 holds 53 of t, the oracle of hard rays misses singular
/// points by 2⁻⁴⁰, and what is left says whether the gradient vanishes.
const BITS: u32 = 192;
/// Largest difference between the gradient's directions at both ends of the narrowed enclosure.
const SAME: f64 = 1.0 / (1u64 << 40) as f64;

impl Certified {
    /// Direction of the gradient, in object coordinates and of length 1, at the hit that an enclosure
    /// holds. `None` where it vanishes there, as at a singular point or on a square, unless its
    /// direction is the same on both sides.
    #[cold]
    pub fn gradient_direction(
        &self,
        field: &Tape,
        ray: &Ray,
        enclosure: [f64; 2],
    ) -> Option<DVec3> {
        let [before, after] = hit_points(self, ray, enclosure, BITS)?;
        let a = direction(&gradient(field, &before)?)?;
        let b = direction(&gradient(field, &after)?)?;
        ((a - b).length() <= SAME).then_some(a)
    }
}

/// ∇f, up to the relative precision of exact quotients; `None` for fields that are no polynomials.
fn gradient(field: &Tape, point: &[Exact; 3]) -> Option<[Exact; 3]> {
    let numbers = Exactly(point);
    let found = field.evaluate(&Gradients(&numbers), &mut Vec::new())?;
    let [x, y, z] = found.gradient.map(|d| d.unwrap_or_else(|| Some(zero())));
    Some([x?, y?, z?])
}

/// The unit vector along a vector that may be far beyond the range of f64.
fn direction(v: &[Exact; 3]) -> Option<DVec3> {
    let largest = v.iter().filter_map(Exact::magnitude).max()?;
    let scaled = v.each_ref().map(|x| x.shifted(-largest).to_f64());
    DVec3::from_array(scaled).try_normalize()
}

fn zero() -> Exact {
    Exact::integer(BigInt::ZERO)
}

/// Exact arithmetic at a point; `None` for what is no polynomial.
struct Exactly<'a>(&'a [Exact; 3]);

impl Algebra for Exactly<'_> {
    type Value = Option<Exact>;

    fn coordinate(&self, axis: usize) -> Option<Exact> {
        Some(self.0[axis].clone())
    }

    fn constant(&self, _: usize, exact: &BigRational) -> Option<Exact> {
        let numerator = Exact::integer(exact.numer().clone());
        if exact.is_integer() {
            return Some(numerator);
        }
        Some(numerator.divided_by(&Exact::integer(exact.denom().clone())))
    }

    fn unary(&self, function: Unary, a: &Option<Exact>) -> Option<Exact> {
        match function {
            Unary::Negative => Some(a.as_ref()?.negated()),
            _ => None,
        }
    }

    fn binary(&self, function: Binary, a: &Option<Exact>, b: &Option<Exact>) -> Option<Exact> {
        let (a, b) = (a.as_ref()?, b.as_ref()?);
        match function {
            Binary::Sum => Some(a.plus(b)),
            Binary::Difference => Some(a.minus(b)),
            Binary::Product => Some(a.times(b)),
            Binary::Quotient => Some(a.divided_by(b)),
            _ => None,
        }
    }

    fn whole_power(&self, a: &Option<Exact>, n: i32) -> Option<Exact> {
        let a = a.as_ref()?;
        let power = |n| (1..n).fold(a.clone(), |power: Exact, _| power.times(a));
        match u32::try_from(n).ok()? {
            0 => Some(Exact::of(1.0)),
            n => Some(power(n)),
        }
    }
}

impl Differentiable for Exactly<'_> {
    fn number(&self, x: f64) -> Option<Exact> {
        Some(Exact::of(x))
    }

    fn where_negative(
        &self,
        _: &Option<Exact>,
        _: &Option<Exact>,
        _: &Option<Exact>,
    ) -> Option<Exact> {
        None
    }
}
