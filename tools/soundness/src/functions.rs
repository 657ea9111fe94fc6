//! Elementary functions of random intervals, against a high-precision reference.

use astro_float::{BigFloat, Consts, RoundingMode};
use etalon::Instructions;
use etalon_doors::intervals::{self, Bounds, Function, same_bits};

use super::arithmetic::Report;
use super::random::Source;

/// Bits of the reference: arguments of size 2¹⁰²⁴ keep them all after reduction by π.
const PRECISION: usize = 192;
const NEAREST: RoundingMode = RoundingMode::ToEven;

/// A finite number, exactly. astro-float 0.9 misreads subnormal ones, so they are scaled.
fn big(x: f64) -> BigFloat {
    if x.abs() >= f64::MIN_POSITIVE {
        return BigFloat::from_f64(x, PRECISION);
    }
    let scale = 2f64.powi(100);
    let scaled = BigFloat::from_f64(x * scale, PRECISION);
    scaled.div(&BigFloat::from_f64(scale, PRECISION), PRECISION, NEAREST)
}

/// The reference, with its store of constants.
pub struct Reference(Consts);

impl Reference {
    /// `None` where the store cannot be made.
    pub fn new() -> Option<Self> {
        Consts::new().ok().map(Self)
    }

    /// The function at a point; `None` where it is undefined there.
    pub fn value(&mut self, function: Function, x: f64, y: f64) -> Option<BigFloat> {
        let constants = &mut self.0;
        let p = PRECISION;
        let a = big(x);
        let value = match function {
            Function::Exponential => a.exp(p, NEAREST, constants),
            Function::Logarithm if x <= 0.0 => return None,
            Function::Logarithm => a.ln(p, NEAREST, constants),
            Function::Sine | Function::SineThin => a.sin(p, NEAREST, constants),
            Function::Cosine | Function::CosineThin => a.cos(p, NEAREST, constants),
            Function::Tangent => a.tan(p, NEAREST, constants),
            Function::ArcSine | Function::ArcCosine if x.abs() > 1.0 => return None,
            Function::ArcSine => a.asin(p, NEAREST, constants),
            Function::ArcCosine => a.acos(p, NEAREST, constants),
            Function::ArcTangent => a.atan(p, NEAREST, constants),
            Function::ArcTangent2 => return angle(constants, x, y),
            Function::HyperbolicSine => a.sinh(p, NEAREST, constants),
            Function::HyperbolicCosine => a.cosh(p, NEAREST, constants),
            Function::HyperbolicTangent => a.tanh(p, NEAREST, constants),
            Function::Power if x <= 0.0 => return None,
            Function::Power => {
                // As e^(y ln x), with the bits that a large exponent eats.
                let wide = 4 * p;
                let logarithm = a.ln(wide, NEAREST, constants);
                let product = logarithm.mul(&big(y), wide, NEAREST);
                product.exp(p, NEAREST, constants)
            }
            Function::Seventh => a.powi(7, p, NEAREST),
            Function::MinusFourth if x == 0.0 => return None,
            Function::MinusFourth => big(1.0).div(&a.powi(4, p, NEAREST), p, NEAREST),
        };
        (!value.is_nan()).then_some(value)
    }
}

/// The angle of the point (x, y) = (second, first).
fn angle(constants: &mut Consts, y: f64, x: f64) -> Option<BigFloat> {
    if x == 0.0 && y == 0.0 {
        return None;
    }
    let p = PRECISION;
    let pi = constants.pi(p, NEAREST);
    let half = pi.div(&big(2.0), p, NEAREST);
    if y.abs() > x.abs() {
        let quotient = big(x).div(&big(y), p, NEAREST);
        let rest = quotient.atan(p, NEAREST, constants);
        let upright = if y > 0.0 { half } else { half.neg() };
        return Some(upright.sub(&rest, p, NEAREST));
    }
    let rest = big(y).div(&big(x), p, NEAREST).atan(p, NEAREST, constants);
    Some(match x > 0.0 {
        true => rest,
        false if y >= 0.0 => rest.add(&pi, p, NEAREST),
        false => rest.sub(&pi, p, NEAREST),
    })
}

/// Whether a value lies within bounds. The reference's last bit, 2⁻¹⁹², is of no account: no value
/// of these functions at doubles comes that near to a double without being one.
fn holds(value: &BigFloat, [low, high]: [f64; 2]) -> bool {
    let above = low == f64::NEG_INFINITY || *value >= big(low);
    let below = high == f64::INFINITY || *value <= big(high);
    above && below
}

/// Operands where the function is interesting.
fn operands(function: Function, source: &mut Source) -> [[f64; 2]; 2] {
    let mut around = |scale: f64| {
        let a = match source.below(8) {
            0 => source.number(),
            1 => scale * (2.0 * source.unit() - 1.0) * 1e-6,
            _ => scale * (2.0 * source.unit() - 1.0),
        };
        let b = match source.below(4) {
            0 => a,
            1 => source.near(a),
            2 => a + scale * source.unit() * 2f64.powi(-(source.below(40) as i32)),
            _ => scale * (2.0 * source.unit() - 1.0),
        };
        if a < b { [a, b] } else { [b, a] }
    };
    let a = match function {
        Function::Exponential | Function::HyperbolicSine | Function::HyperbolicCosine => {
            around(800.0)
        }
        Function::Logarithm | Function::Power => around(4.0).map(f64::abs),
        Function::ArcSine | Function::ArcCosine => around(1.01),
        Function::HyperbolicTangent | Function::Seventh | Function::MinusFourth => around(30.0),
        _ => around(20.0),
    };
    let b = around(20.0);
    let sorted = |[a, b]: [f64; 2]| if a <= b { [a, b] } else { [b, a] };
    use Function::{Cosine, CosineThin, Sine, SineThin, Tangent};
    let trigonometric = matches!(function, Sine | Cosine | SineThin | CosineThin | Tangent);
    if trigonometric && source.below(4) == 0 {
        // Near a multiple of π/2, up to the largest angle that is reduced and a little more.
        let bits = source.below(21);
        let multiple = source.below(1 << bits) as f64;
        let near = source.near(multiple * std::f64::consts::FRAC_PI_2);
        return [sorted([near, source.near(near)]), b];
    }
    [sorted(a), sorted(b)]
}

/// Points of an interval: its ends and one inside.
fn points([low, high]: [f64; 2], source: &mut Source) -> [f64; 3] {
    let inside = low + (high - low) * source.unit();
    [low, high, inside.clamp(low, high)]
}

/// Checks `count` (a multiple of eight) random intervals on each instruction set; `narrowed` makes
/// every result a little too narrow, to see that this is noticed.
pub fn check(function: Function, seed: u64, count: usize, narrowed: bool) -> Option<Report> {
    let mut reference = Reference::new()?;
    let mut source = Source::new(seed);
    let pairs = (0..count).map(|_| <(Bounds, Bounds)>::from(operands(function, &mut source)));
    let (a, b): (Vec<_>, Vec<_>) = pairs.unzip();
    let results = Instructions::all().into_iter();
    let results = results.map(|set| intervals::function(set, function, [&a, &b]));
    let ((first, broken), mut report) =
        Report::of(results, |a, b| same_bits(&a.0, &b.0) && a.1 == b.1);
    for (((a, b), bounds), broken) in a.into_iter().zip(b).zip(first).zip(broken) {
        let bounds = if narrowed { narrower(bounds) } else { bounds };
        let seconds = points(b, &mut source);
        for (x, y) in points(a, &mut source).into_iter().zip(seconds) {
            let good = match reference.value(function, x, y) {
                Some(value) => holds(&value, bounds),
                // The whole line and a note are all that a point outside the domain asks for.
                None => broken || !notes(function),
            };
            report.note(good, || {
                format!("{function:?} at {x:e}, {y:e} is not in {bounds:?}")
            });
        }
    }
    report.checked = count as u64;
    Some(report)
}

/// Whether the function says where it may be undefined; a power of zero is noted by its caller.
fn notes(function: Function) -> bool {
    function != Function::MinusFourth
}

/// Sixteen steps narrower on each side: more than the kernels' own allowance.
fn narrower(bounds: [f64; 2]) -> [f64; 2] {
    (0..16).fold(bounds, |[low, high], _| [low.next_up(), high.next_down()])
}
