//! Sphere tracing with a proved Lipschitz bound.
//!
//! Where |f(t)| = v and no slope exceeds L, no zero lies within v/L of t (Hart 1996, "Sphere
//! tracing"). Eight points ahead are tried at once; balls that touch or overlap the ones before
//! them move the end of what is clear to their own far end (Keinert et al. 2014, "Enhanced sphere
//! tracing", for steps longer than one ball). The values and the bound are enclosures, so that a
//! stretch called clear is clear.

use super::interval::{Enclosed, PIECES, Search};
use super::{Outcome, Root};

/// The first zero in [from, to] for a function whose slopes are at most `lipschitz` in magnitude,
/// after at most `bound` evaluations.
///
/// Found proves that no zero lies before the enclosure and at least one in it. Steps shrink in
/// proportion to the distance from a zero: a zero without a change of sign is never reached and
/// ends as Undecided.
pub fn first_zero<F: Enclosed>(
    function: &mut F,
    [from, to]: [f64; 2],
    lipschitz: f64,
    bound: u32,
) -> Search {
    let mut march = March {
        lipschitz,
        clear: from,
        sign: 0,
        opposite: None,
    };
    let mut step = (to - from) / 64.0;
    let mut evaluations = 0;
    let usable = lipschitz.is_finite() && lipschitz >= 0.0 && from < to;
    while usable && evaluations < bound {
        let end = march.opposite.unwrap_or(to);
        let before = march.clear;
        let points = ahead(before, step, end);
        evaluations += 1;
        march.advance(&points, function.at(&points));
        if march.opposite.is_none() && march.clear >= to && march.sign != 0 {
            return done(Outcome::Absent, evaluations);
        }
        let gained = march.clear - before;
        if let Some(end) = march.opposite
            && (end - march.clear <= march.clear.abs().max(end.abs()) * 4.0 * f64::EPSILON
                || gained <= before.abs() * f64::EPSILON && step <= before.abs() * f64::EPSILON)
        {
            return done(march.found(end), evaluations);
        }
        if gained <= 0.0 && step <= before.abs() * f64::EPSILON {
            return done(Outcome::Undecided, evaluations);
        }
        // Points reach twice as far as the last balls did.
        step = (gained * 2.0).max(step / 64.0);
    }
    let outcome = match march.opposite {
        Some(end) if usable && march.sign != 0 => march.found(end),
        _ => Outcome::Undecided,
    };
    done(outcome, evaluations)
}

fn done(outcome: Outcome, evaluations: u32) -> Search {
    Search {
        outcome,
        evaluations,
    }
}

/// Points from `clear` on, at distances that double up to `step`, not beyond `end`.
fn ahead(clear: f64, step: f64, end: f64) -> [f64; PIECES] {
    let mut t = [clear; PIECES];
    let mut distance = step;
    for t in t[1..].iter_mut().rev() {
        *t = (clear + distance).min(end);
        distance *= 0.5;
    }
    t
}

/// What is known of the stretch so far.
struct March {
    lipschitz: f64,
    /// No zero lies before this.
    clear: f64,
    /// The sign up to there.
    sign: i8,
    /// A point further on where the function has the other sign.
    opposite: Option<f64>,
}

impl March {
    fn advance(&mut self, points: &[f64; PIECES], [low, high]: [[f64; PIECES]; 2]) {
        for i in 0..PIECES {
            let (t, sign) = (points[i], i8::from(low[i] > 0.0) - i8::from(high[i] < 0.0));
            if sign == 0 {
                continue;
            }
            if self.sign == 0 && t == self.clear {
                self.sign = sign;
            }
            if self.sign == 0 {
                return;
            }
            if sign != self.sign {
                self.opposite = Some(self.opposite.map_or(t, |o| o.min(t)));
                return;
            }
            // Lower bounds of the radius and upper ones of the gap: the quotient and the
            // differences are off by some 2⁻⁵³ of what they are made of.
            let value = if sign > 0 { low[i] } else { -high[i] };
            let radius = if self.lipschitz > 0.0 {
                value / self.lipschitz * (1.0 - 4.0 * f64::EPSILON)
            } else {
                f64::INFINITY
            };
            if (t - radius).next_up() <= self.clear {
                self.clear = self.clear.max((t + radius).next_down());
            }
        }
    }

    fn found(&self, end: f64) -> Outcome {
        if self.sign == 0 || self.clear >= end {
            return Outcome::Undecided;
        }
        Outcome::Found(Root {
            enclosure: [self.clear, end],
            multiplicity: None,
        })
    }
}
