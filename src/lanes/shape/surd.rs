//! Exact order of quadratic surds (p ± √s) / q: which of two crossings comes first.

use std::cmp::Ordering;

use super::line::{Crossing, LocalRay};
use crate::math::exact::Exact;
use crate::math::number::Number;

/// (p ± √s) / q with q > 0 and s ≥ 0.
#[derive(Debug, Clone)]
pub struct Surd {
    p: Exact,
    q: Exact,
    s: Exact,
    minus: bool,
}

/// ±√`square`.
struct SignedRoot {
    square: Exact,
    minus: bool,
}

impl SignedRoot {
    fn sign(&self) -> Ordering {
        let sign = order(&self.square);
        if self.minus { sign.reverse() } else { sign }
    }
}

/// The sign; exact numbers always have one.
fn order(x: &Exact) -> Ordering {
    x.sign().unwrap_or(Ordering::Equal)
}

impl Surd {
    pub fn of(crossing: &Crossing, ray: &LocalRay<Exact>) -> Self {
        match crossing.fraction(ray) {
            Ok(t) => Self {
                p: t.numerator,
                q: t.denominator,
                s: Exact::of(0.0),
                minus: false,
            },
            Err(dimensions) => {
                let quadratic = ray.quadratic(dimensions);
                Self {
                    p: quadratic.b.negated(),
                    q: quadratic.a,
                    s: quadratic.discriminant,
                    minus: !crossing.leaving,
                }
            }
        }
    }

    /// self ⋚ other, by squaring twice.
    pub fn compare(&self, other: &Self) -> Ordering {
        let rational = self.p.times(&other.q).minus(&other.p.times(&self.q));
        let mine = SignedRoot {
            square: self.s.times(&other.q.squared()),
            minus: self.minus,
        };
        let theirs = SignedRoot {
            square: other.s.times(&self.q.squared()),
            minus: !other.minus,
        };
        sign_of_sum(&rational, &mine, &theirs)
    }
}

fn sign_of_roots(a: &SignedRoot, b: &SignedRoot) -> Ordering {
    match (a.sign(), b.sign()) {
        (Ordering::Equal, sign) | (sign, Ordering::Equal) => sign,
        (sign_a, sign_b) if sign_a == sign_b => sign_a,
        (Ordering::Greater, _) => order(&a.square.minus(&b.square)),
        _ => order(&b.square.minus(&a.square)),
    }
}

/// Sign of P + A + B: where P and A + B differ in sign, the larger square decides.
fn sign_of_sum(p: &Exact, a: &SignedRoot, b: &SignedRoot) -> Ordering {
    let sign_p = order(p);
    let sign_roots = sign_of_roots(a, b);
    match (sign_p, sign_roots) {
        (Ordering::Equal, sign) | (sign, Ordering::Equal) => return sign,
        (first, second) if first == second => return first,
        _ => {}
    }
    // P² − (A + B)² = (P² − A² − B²) − 2AB.
    let left = p.squared().minus(&a.square).minus(&b.square);
    let right = SignedRoot {
        square: a.square.times(&b.square).times(&Exact::of(4.0)),
        minus: a.minus != b.minus,
    };
    match order_against_root(&left, &right) {
        Ordering::Greater => sign_p,
        Ordering::Less => sign_roots,
        Ordering::Equal => Ordering::Equal,
    }
}

/// x ⋚ R.
fn order_against_root(x: &Exact, root: &SignedRoot) -> Ordering {
    let (sign_x, sign_root) = (order(x), root.sign());
    if sign_x != sign_root {
        return sign_x.cmp(&sign_root);
    }
    let by_squares = order(&x.squared().minus(&root.square));
    if sign_x == Ordering::Less {
        by_squares.reverse()
    } else {
        by_squares
    }
}
