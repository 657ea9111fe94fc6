//! The first root of a polynomial with integer coefficients, decided exactly.
//!
//! Sturm's theorem counts the distinct roots of the square-free part in an interval; the first one
//! is isolated by bisection at f64 points and enclosed by exact signs, beyond f64 where asked.

use std::cmp::Ordering;

use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_traits::{One, Signed, Zero};

use crate::math::exact::Exact;
use crate::math::number::Number;

#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    pub numerator: BigInt,
    /// The denominator, positive.
    pub denominator: BigInt,
}

impl Point {
    /// An f64, which must be finite.
    pub fn of(x: f64) -> Self {
        Self::dyadic(&Exact::of(x))
    }

    pub fn dyadic(x: &Exact) -> Self {
        let (mantissa, exponent) = x.parts();
        let shift = exponent.unsigned_abs();
        let (up, down) = if exponent >= 0 {
            (shift, 0)
        } else {
            (0, shift)
        };
        Self {
            numerator: mantissa << up,
            denominator: BigInt::one() << down,
        }
    }

    pub fn compare(&self, other: &Self) -> Ordering {
        (&self.numerator * &other.denominator).cmp(&(&other.numerator * &self.denominator))
    }

    /// The nearest f64 or a neighbour.
    fn near(&self) -> f64 {
        Exact::integer(self.numerator.clone())
            .divided_by(&Exact::integer(self.denominator.clone()))
            .to_f64()
    }

    /// The nearest f64 not above, for points within the range of f64.
    fn floor(&self) -> f64 {
        self.moved(Ordering::Greater, f64::next_down)
    }

    /// The nearest f64 not below, for points within the range of f64.
    fn ceil(&self) -> f64 {
        self.moved(Ordering::Less, f64::next_up)
    }

    /// A near f64, moved while it compares like this with the point and a finite one follows.
    fn moved(&self, wrong: Ordering, next: impl Fn(f64) -> f64) -> f64 {
        let mut x = self.near().clamp(-f64::MAX, f64::MAX);
        while Self::of(x).compare(self) == wrong && next(x).is_finite() {
            x = next(x);
        }
        x
    }
}

/// Where roots are looked for: between the ends, and at those ends that count.
#[derive(Debug, Clone)]
pub struct Stretch {
    pub low: Point,
    pub low_counts: bool,
    pub high: Point,
    pub high_counts: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactRoot {
    /// The nearest f64 or a neighbour.
    pub t: f64,
    /// f64 on both sides, as close as they get; once the same where the root is an f64.
    pub enclosure: [f64; 2],
    /// How many times it is a root, where that is known.
    pub multiplicity: Option<u32>,
}

/// A polynomial, lowest power first, without leading zeros.
#[derive(Debug, Clone, PartialEq)]
struct Polynomial(Vec<BigInt>);

impl Polynomial {
    fn new(mut coefficients: Vec<BigInt>) -> Self {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    /// Without the powers of two that its coefficients have in common.
    fn without_twos(mut self) -> Self {
        let twos = self.0.iter().filter_map(BigInt::trailing_zeros).min();
        for c in &mut self.0 {
            *c >>= twos.unwrap_or(0);
        }
        self
    }

    /// Without the common factor of its coefficients.
    fn primitive(self) -> Self {
        let mut content = BigInt::zero();
        for c in &self.0 {
            content = content.gcd(c);
            if content.is_one() {
                return self;
            }
        }
        if content.is_zero() {
            return self;
        }
        Self(self.0.into_iter().map(|c| c / &content).collect())
    }

    fn derivative(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Self::new(terms.map(|(i, c)| c * BigInt::from(i)).collect())
    }

    /// A positive multiple of the value.
    fn at(&self, point: &Point) -> BigInt {
        let mut sum = BigInt::zero();
        let mut power = BigInt::one();
        for c in self.0.iter().rev() {
            sum = sum * &point.numerator + c * &power;
            power *= &point.denominator;
        }
        sum
    }

    fn sign_at(&self, point: &Point) -> Sign {
        self.at(point).sign()
    }

    /// The leading coefficient; 0 for zero.
    fn leading(&self) -> BigInt {
        self.0.last().cloned().unwrap_or_default()
    }

    /// The remainder by a divisor other than zero, times the magnitude of its leading coefficient
    /// to the power of one more than the difference of degrees.
    fn remainder(&self, divisor: &Self) -> Self {
        let mut rest = self.0.clone();
        let leading = divisor.leading();
        let magnitude = leading.abs();
        while rest.len() >= divisor.0.len() {
            let shift = rest.len() - divisor.0.len();
            let top = rest.pop().unwrap_or_default();
            let top = if leading.is_negative() { -top } else { top };
            for c in &mut rest {
                *c *= &magnitude;
            }
            for (i, d) in divisor.0.iter().take(divisor.degree()).enumerate() {
                rest[i + shift] -= &top * d;
            }
        }
        Self::new(rest)
    }

    /// The quotient by a divisor, up to a constant factor of either sign.
    fn quotient(&self, divisor: &Self) -> Self {
        let mut rest = self.clone();
        let degree = self.degree() - divisor.degree();
        let mut quotient = vec![BigInt::zero(); degree + 1];
        let leading = divisor.0[divisor.degree()].clone();
        for k in (0..=degree).rev() {
            let top = rest.0[k + divisor.degree()].clone();
            for q in &mut quotient {
                *q *= &leading;
            }
            for c in &mut rest.0 {
                *c *= &leading;
            }
            for (i, d) in divisor.0.iter().enumerate() {
                rest.0[i + k] -= &top * d;
            }
            quotient[k] = top;
        }
        Self::new(quotient).primitive()
    }
}

struct Chain(Vec<Polynomial>);

impl Chain {
    /// Remainders with changed signs, divided by the common factor of subresultants, which is known
    /// beforehand (Collins 1967, Brown and Traub 1971): coefficients grow as slowly as they can.
    fn new(polynomial: &Polynomial) -> Self {
        let mut chain = vec![polynomial.clone(), polynomial.derivative()];
        let (mut g, mut h) = (BigInt::one(), BigInt::one());
        while let [.., a, b] = chain.as_slice() {
            if b.0.is_empty() {
                chain.pop();
                break;
            }
            let drop = (a.degree() - b.degree()) as u32;
            let common = -(&g * h.pow(drop));
            let rest = a.remainder(b);
            g = b.leading().abs();
            h = match drop {
                0 => h,
                1 => g.clone(),
                _ => g.pow(drop) / h.pow(drop - 1),
            };
            chain.push(Polynomial(
                rest.0.into_iter().map(|c| c / &common).collect(),
            ));
        }
        Self(chain)
    }

    /// The greatest common divisor of the first two.
    fn last(&self) -> &Polynomial {
        &self.0[self.0.len() - 1]
    }

    fn changes(&self, point: &Point) -> usize {
        let signs = self.0.iter().map(|polynomial| polynomial.sign_at(point));
        let mut signs: Vec<Sign> = signs.filter(|sign| *sign != Sign::NoSign).collect();
        signs.dedup();
        signs.len().saturating_sub(1)
    }

    /// Distinct roots in (low, high]; for a square-free polynomial.
    fn count(&self, low: &Point, high: &Point) -> usize {
        self.changes(low).saturating_sub(self.changes(high))
    }
}

/// A polynomial whose roots are all simple, and what was divided out.
struct SquareFree {
    simple: Polynomial,
    chain: Chain,
    /// The divisor: every root of the original as often as it was one, less one.
    common: Polynomial,
}

impl SquareFree {
    /// The square-free part of a polynomial; `None` where it is a constant.
    fn of(coefficients: &[BigInt]) -> Option<Self> {
        let whole = Polynomial::new(coefficients.to_vec()).without_twos();
        if whole.degree() == 0 {
            return None;
        }
        let mut chain = Chain::new(&whole);
        let mut common = chain.last().clone();
        let mut simple = whole;
        if common.degree() > 0 {
            common = common.primitive();
            simple = simple.quotient(&common);
            chain = Chain::new(&simple);
        }
        Some(Self {
            simple,
            chain,
            common,
        })
    }
}

/// The first root on the stretch, sought near the hint first; `None` for a constant, zero among them.
pub fn first_root(
    coefficients: &[BigInt],
    stretch: &Stretch,
    hint: Option<f64>,
) -> Option<ExactRoot> {
    let order = stretch.low.compare(&stretch.high);
    let point = order == Ordering::Equal && stretch.low_counts && stretch.high_counts;
    if order != Ordering::Less && !point {
        return None;
    }
    let SquareFree {
        simple,
        chain,
        common,
    } = SquareFree::of(coefficients)?;
    if stretch.low_counts && simple.sign_at(&stretch.low) == Sign::NoSign {
        let multiplicity = multiplicity(common, &stretch.low, &stretch.low);
        return Some(exactly(&stretch.low, multiplicity));
    }
    let mut count = chain.count(&stretch.low, &stretch.high);
    if !stretch.high_counts && simple.sign_at(&stretch.high) == Sign::NoSign {
        count = count.saturating_sub(1);
    }
    if count == 0 {
        return None;
    }
    let (low, high) = isolated(&simple, &chain, stretch, hint);
    let multiplicity = multiplicity(common, &low, &high);
    if low == high {
        return Some(exactly(&low, multiplicity));
    }
    let [a, b] = [low.floor(), high.ceil()];
    Some(ExactRoot {
        t: a + (b - a) / 2.0,
        enclosure: [a, b],
        multiplicity: Some(multiplicity),
    })
}

fn exactly(point: &Point, multiplicity: u32) -> ExactRoot {
    ExactRoot {
        t: point.near(),
        enclosure: [point.floor(), point.ceil()],
        multiplicity: Some(multiplicity),
    }
}

/// One more than how often the root in [low, high] is one of the common divisor.
fn multiplicity(mut common: Polynomial, low: &Point, high: &Point) -> u32 {
    let mut multiplicity = 1;
    while common.degree() > 0 {
        let chain = Chain::new(&common);
        let next = chain.last().clone();
        let simple = common.quotient(&next);
        let holds = simple.sign_at(low) == Sign::NoSign || Chain::new(&simple).count(low, high) > 0;
        if !holds {
            break;
        }
        multiplicity += 1;
        common = next;
    }
    multiplicity
}

/// Points around the first root with no f64 between, or closer than a 2⁻⁶⁴ of the stretch; the
/// root itself twice if it was met. There is a root in (low, high].
fn isolated(
    simple: &Polynomial,
    chain: &Chain,
    stretch: &Stretch,
    hint: Option<f64>,
) -> (Point, Point) {
    let (mut low, mut high) = (stretch.low.clone(), stretch.high.clone());
    let (mut a, mut b) = (low.floor(), high.ceil());
    let close = (b - a) / (1u128 << 64) as f64;
    let changes_at_low = chain.changes(&low);
    let mut count = changes_at_low.saturating_sub(chain.changes(&high));
    if let Some(hint) = hint {
        let near = (b - a) * NEAR;
        for x in [hint - near, hint + near] {
            let Some((point, x)) = between(&low, &high, x, false) else {
                continue;
            };
            let before = changes_at_low.saturating_sub(chain.changes(&point));
            if before > 0 {
                (high, b, count) = (point, x, before);
            } else {
                (low, a) = (point, x);
            }
        }
    }
    while count > 1 {
        let Some((middle, x)) = between(&low, &high, a + (b - a) / 2.0, b - a <= close) else {
            return (low, high);
        };
        let before = changes_at_low.saturating_sub(chain.changes(&middle));
        if before > 0 {
            (high, b, count) = (middle, x, before);
        } else {
            (low, a) = (middle, x);
        }
    }
    if simple.sign_at(&high) == Sign::NoSign {
        return (high.clone(), high);
    }
    narrowed(simple, [low, high], [a, b], close)
}

/// How near a hint is expected to be, relative to the stretch.
const NEAR: f64 = 1.0 / (1u64 << 28) as f64;

/// x as a point, if it is strictly between.
fn between(low: &Point, high: &Point, x: f64, close: bool) -> Option<(Point, f64)> {
    if close {
        return None;
    }
    let point = Point::of(x);
    let inside = low.compare(&point) == Ordering::Less && point.compare(high) == Ordering::Less;
    inside.then_some((point, x))
}

/// Closes in on the only root in (low, high), a simple one, by secants and halves.
fn narrowed(
    simple: &Polynomial,
    [mut low, mut high]: [Point; 2],
    [mut a, mut b]: [f64; 2],
    close: f64,
) -> (Point, Point) {
    let at_high = Value::new(simple, &high);
    let mut ends = [Value::new(simple, &low), at_high.clone()];
    for step in 0_u32.. {
        let middle = a + (b - a) / 2.0;
        let secant = b - (b - a) * Value::share(&ends[1], &ends[0]);
        let guess = match step % 3 {
            0 => secant,
            // Beside the last guess, to close in from the other side.
            1 if secant - a < b - secant => secant + 4.0 * (secant - a).max(f64::EPSILON * a.abs()),
            1 => secant - 4.0 * (b - secant).max(f64::EPSILON * b.abs()),
            _ => middle,
        };
        let guess = if guess > a && guess < b {
            guess
        } else {
            middle
        };
        let Some((point, x)) = between(&low, &high, guess, b - a <= close) else {
            break;
        };
        let value = Value::new(simple, &point);
        match value.sign {
            Sign::NoSign => return (point.clone(), point),
            sign if sign == at_high.sign => {
                (high, b) = (point, x);
                ends[1] = value;
            }
            _ => {
                (low, a) = (point, x);
                ends[0] = value;
            }
        }
    }
    (low, high)
}

/// A value and its magnitude as m · 2ᵉ, m in [½, 1), roughly.
#[derive(Clone)]
struct Value {
    sign: Sign,
    mantissa: f64,
    exponent: i64,
}

impl Value {
    fn new(polynomial: &Polynomial, point: &Point) -> Self {
        let numerator = polynomial.at(point);
        let (top, bits) = leading(&numerator);
        let (below, below_bits) = leading(&point.denominator);
        let degree = polynomial.degree() as i32;
        Self {
            sign: numerator.sign(),
            mantissa: top / libm::pow(below, f64::from(degree)),
            exponent: bits - below_bits * i64::from(degree),
        }
    }

    /// |a| / (|a| + |b|), roughly.
    fn share(a: &Self, b: &Self) -> f64 {
        let exponent = (b.exponent - a.exponent).clamp(-1000, 1000) as i32;
        1.0 / (1.0 + libm::ldexp(b.mantissa / a.mantissa, exponent))
    }
}

/// The leading digits of a magnitude, in [½, 1), and the power of two that goes with them.
fn leading(x: &BigInt) -> (f64, i64) {
    let bits = x.bits() as i64;
    let scaled = Exact::integer(x.abs()).shifted(-bits);
    (scaled.to_f64(), bits)
}

/// The first root in [low, high], within 2⁻ᵇ of the interval's width; twice the same where it is met
/// exactly, and `None` where there is none. The coefficients stand lowest power first.
pub fn sharpened(coefficients: &[BigInt], ends: [f64; 2], bits: u32) -> Option<[Exact; 2]> {
    let SquareFree { simple, chain, .. } = SquareFree::of(coefficients)?;
    let [mut low, mut high] = ends.map(Exact::of);
    if simple.sign_at(&Point::dyadic(&low)) == Sign::NoSign {
        return Some([low.clone(), low]);
    }
    let mut count = chain.count(&Point::dyadic(&low), &Point::dyadic(&high));
    let mut at_high = simple.sign_at(&Point::dyadic(&high));
    for _ in 0..bits {
        if count == 0 {
            return None;
        }
        let middle = low.plus(&high).shifted(-1);
        let point = Point::dyadic(&middle);
        let sign = simple.sign_at(&point);
        // The sign decides on which side a single root is, the chain where the first of several is.
        let before = if count > 1 {
            chain.count(&Point::dyadic(&low), &point)
        } else {
            usize::from(sign == at_high || sign == Sign::NoSign)
        };
        if before == 0 {
            low = middle;
            continue;
        }
        if before == 1 && sign == Sign::NoSign {
            return Some([middle.clone(), middle]);
        }
        (high, count, at_high) = (middle, before, sign);
    }
    Some([low, high])
}
