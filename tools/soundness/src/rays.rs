//! First hits of general expressions against 128-bit evaluation and Lipschitz constants that were
//! proved by hand.
//!
//! Where |f| = v no zero lies within v/L, so steps of v/L from the start show that nothing lies
//! before an enclosure, or on the whole ray, without any interval; signs at the ends of an
//! enclosure show that something lies in it.

use std::cell::RefCell;
use std::cmp::Ordering;
use std::time::Instant;

use astro_float::{BigFloat, Consts, RoundingMode};
use etalon::inside::field::expression::parse;
use etalon::inside::field::tape::{Algebra, Binary, Tape, Unary};
use etalon::inside::math::affine::Affine;
use etalon::inside::root::Outcome;
use etalon::inside::shape::Ray;
use etalon::inside::shape::implicit::enclosed::{EnclosedField, Searching};
use etalon::inside::shape::ladder::{Ladder, ScaledRay};
use glam::DVec3;
use num_rational::BigRational;
use rayon::prelude::*;

use super::random::Source;

/// A field, half the width of its clip cube, and a bound of its gradient's length.
///
/// By hand: each partial derivative of the first is at most 2; √(2/e) and 3/5; 1 across and 2
/// along z; 2, 1 and 2.
const FIELDS: [(&str, f64, f64); 4] = [
    ("sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)", 6.0, 3.4642),
    ("exp(-x^2 - y^2 - z^2) - 1/3 + sin(3*x)/5", 2.0, 1.4578),
    ("sqrt(x^2 + y^2 + 1) - 3/2 + cos(2*z)", 3.0, 2.2361),
    ("tanh(2*x) + atan(y) + sin(2*z)", 3.0, 3.0001),
];

const PRECISION: usize = 128;
const NEAREST: RoundingMode = RoundingMode::ToEven;

/// 128-bit arithmetic at a point.
struct Big<'a> {
    point: [BigFloat; 3],
    constants: &'a RefCell<Consts>,
}

impl Algebra for Big<'_> {
    type Value = BigFloat;

    fn coordinate(&self, axis: usize) -> BigFloat {
        self.point[axis].clone()
    }

    fn constant(&self, _: usize, exact: &BigRational) -> BigFloat {
        let mut constants = self.constants.borrow_mut();
        let mut whole = |text: String| {
            let radix = astro_float::Radix::Dec;
            BigFloat::parse(&text, radix, PRECISION, NEAREST, &mut constants)
        };
        let numerator = whole(exact.numer().to_string());
        let denominator = whole(exact.denom().to_string());
        numerator.div(&denominator, PRECISION, NEAREST)
    }

    fn unary(&self, function: Unary, a: &BigFloat) -> BigFloat {
        let c = &mut *self.constants.borrow_mut();
        match function {
            Unary::Negative => a.neg(),
            Unary::SquareRoot => a.sqrt(PRECISION, NEAREST),
            Unary::Absolute => a.abs(),
            Unary::Exponential => a.exp(PRECISION, NEAREST, c),
            Unary::Logarithm => a.ln(PRECISION, NEAREST, c),
            Unary::Sine => a.sin(PRECISION, NEAREST, c),
            Unary::Cosine => a.cos(PRECISION, NEAREST, c),
            Unary::Tangent => a.tan(PRECISION, NEAREST, c),
            Unary::ArcSine => a.asin(PRECISION, NEAREST, c),
            Unary::ArcCosine => a.acos(PRECISION, NEAREST, c),
            Unary::ArcTangent => a.atan(PRECISION, NEAREST, c),
            Unary::HyperbolicSine => a.sinh(PRECISION, NEAREST, c),
            Unary::HyperbolicCosine => a.cosh(PRECISION, NEAREST, c),
            Unary::HyperbolicTangent => a.tanh(PRECISION, NEAREST, c),
        }
    }

    /// Angles and powers do not occur in these fields.
    fn binary(&self, function: Binary, a: &BigFloat, b: &BigFloat) -> BigFloat {
        match function {
            Binary::Sum => a.add(b, PRECISION, NEAREST),
            Binary::Difference => a.sub(b, PRECISION, NEAREST),
            Binary::Product => a.mul(b, PRECISION, NEAREST),
            Binary::Quotient => a.div(b, PRECISION, NEAREST),
            Binary::Minimum => if a < b { a } else { b }.clone(),
            Binary::Maximum => if a > b { a } else { b }.clone(),
            Binary::ArcTangent2 | Binary::Power => astro_float::NAN,
        }
    }

    fn whole_power(&self, a: &BigFloat, n: i32) -> BigFloat {
        let power = a.powi(n.unsigned_abs() as usize, PRECISION, NEAREST);
        if n < 0 {
            BigFloat::from_f64(1.0, PRECISION).div(&power, PRECISION, NEAREST)
        } else {
            power
        }
    }
}

/// How many rays of a field were found, absent, undecided and, among all of them, wrong.
type Count = [u64; 4];

/// Checks `count` rays of each field; whether none is wrong.
pub fn check(count: u64, seed: u64) -> bool {
    let mut good = true;
    for (text, half, lipschitz) in FIELDS {
        let Ok(expression) = parse(text, &[]) else {
            println!("{text}: cannot be read");
            return false;
        };
        let case = Case {
            tape: &expression.tape,
            field: EnclosedField::new(&expression.tape),
            inside: [DVec3::splat(-half), DVec3::splat(half)],
            lipschitz,
        };
        let rays = rays(count, half, seed);
        let start = Instant::now();
        let Some(outcomes) = case.outcomes(&rays) else {
            return false;
        };
        let time = start.elapsed().as_nanos() as f64 / count as f64;
        let total = rays
            .par_iter()
            .zip(&outcomes)
            .map(|(ray, outcome)| case.judged(ray, outcome))
            .reduce(Count::default, |a, b| std::array::from_fn(|i| a[i] + b[i]));
        let [found, absent, undecided, wrong] = total;
        println!(
            "{text}: {found} found, {absent} absent, {undecided} undecided, {wrong} wrong; \
             {time:.0} ns a ray"
        );
        good &= wrong == 0;
    }
    good
}

struct Case<'a> {
    tape: &'a Tape,
    field: EnclosedField,
    inside: [DVec3; 2],
    lipschitz: f64,
}

impl Case<'_> {
    fn outcomes(&self, rays: &[Ray]) -> Option<Vec<Outcome>> {
        let ladder = Ladder::new(&Affine::IDENTITY).ok()?;
        let search = Searching::default();
        let outcome = |ray: &Ray| {
            let scaled = ScaledRay::new(ray);
            let local = ladder.double_double.local(&scaled);
            let limits = [0.0, f64::MAX];
            let found = self.field.first_hit(&local, &self.inside, limits, &search);
            found.outcome
        };
        Some(rays.iter().map(outcome).collect())
    }

    fn judged(&self, ray: &Ray, outcome: &Outcome) -> Count {
        let Ok(constants) = Consts::new() else {
            return [0, 0, 0, 1];
        };
        let constants = RefCell::new(constants);
        // t is in units of the scaled direction.
        let unit = 2f64.powi(ScaledRay::new(ray).exponent);
        let direction = ray.direction / unit;
        let value = |t: f64| self.value(ray.origin, direction, t, &constants);
        let [near, far] = self.stretch(ray.origin, direction);
        let (kind, good) = match outcome {
            Outcome::Undecided => ([0, 0, 1], true),
            Outcome::Absent => {
                let clear = near >= far || self.is_clear(&value, near, far, direction.length());
                ([0, 1, 0], clear)
            }
            Outcome::Found(root) => {
                let [low, high] = root.enclosure;
                let zero = BigFloat::from_f64(0.0, PRECISION);
                let signs = [low, high].map(|t| value(t).partial_cmp(&zero));
                let crosses = signs[0] != signs[1] && !signs.contains(&None);
                let before = low - 1e-6 * (far - near);
                let clear = self.is_clear(&value, near, before, direction.length());
                ([1, 0, 0], crosses && clear)
            }
        };
        let [found, absent, undecided] = kind;
        [found, absent, undecided, u64::from(!good)]
    }

    /// Steps of |f|/L; whether they pass `to` without a change of sign. Where they hardly move, a
    /// zero may touch or nearly touch the ray: only a change of sign then counts as one.
    fn is_clear(&self, value: &dyn Fn(f64) -> BigFloat, from: f64, to: f64, speed: f64) -> bool {
        let zero = BigFloat::from_f64(0.0, PRECISION);
        let mut t = from;
        let mut sign: Option<Ordering> = None;
        while t < to {
            let v = value(t);
            let here = v.partial_cmp(&zero);
            if sign.is_some() && here != sign {
                return false;
            }
            sign = here;
            let size: f64 = v.abs().to_string().parse().unwrap_or(0.0);
            t += (size / (self.lipschitz * speed) * (1.0 - 1e-9)).max(1e-7 * (to - from));
        }
        true
    }

    fn value(
        &self,
        origin: DVec3,
        direction: DVec3,
        t: f64,
        constants: &RefCell<Consts>,
    ) -> BigFloat {
        let big = |x: f64| BigFloat::from_f64(x, PRECISION);
        let point = [0, 1, 2].map(|i| {
            let moved = big(direction[i]).mul(&big(t), PRECISION, NEAREST);
            big(origin[i]).add(&moved, PRECISION, NEAREST)
        });
        let numbers = Big { point, constants };
        let value = self.tape.evaluate(&numbers, &mut Vec::new());
        value.unwrap_or(astro_float::NAN)
    }

    /// The clip in f64, drawn in by what rounding may move it.
    fn stretch(&self, origin: DVec3, direction: DVec3) -> [f64; 2] {
        let a = (self.inside[0] - origin) / direction;
        let b = (self.inside[1] - origin) / direction;
        let near = a.min(b).max_element().max(0.0);
        let far = a.max(b).min_element();
        [near + 1e-12, far - 1e-12]
    }
}

/// Rays from a sphere around the cube to points in it.
fn rays(count: u64, half: f64, seed: u64) -> Vec<Ray> {
    let mut source = Source::new(seed);
    let mut point = || DVec3::from_array([0; 3].map(|_| 2.0 * source.unit() - 1.0));
    (0..count)
        .map(|_| {
            let origin = point().normalize() * 3.0 * half;
            let direction = (point() * half - origin).normalize();
            Ray { origin, direction }
        })
        .collect()
}
