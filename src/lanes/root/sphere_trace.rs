//! Sphere tracing with a proved Lipschitz bound.
//!
//! Where |f(t)| = v and no slope exceeds L, no zero lies within v/L of t (Hart 1996, "Sphere
//! tracing"). Eight points ahead are tried at once; balls that touch or overlap the ones before
//! them move the end of what is clear to their own far end (Keinert et al. 2014, "Enhanced sphere
//! tracing", for steps longer than one ball). The values and the bound are enclosures, so that a
//! stretch called clear is clear.

use super::interval::{Enclosed, PIECES, Search, of, sign};
use super::{Outcome, Root};

/// The first zero in [from, to], after at most `bound` evaluations.
///
/// The Lipschitz bound is `lipschitz`, proved by the caller for the whole stretch, or that of the
/// enclosed slopes over each eighth of it, whichever is less (Galin et al. 2020, "Segment
/// tracing", for bounds along the ray).
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
    let [starts, ends] = pieces_of(from, to);
    if !starts.iter().zip(&ends).all(|(a, b)| a < b) {
        return Search::new(Outcome::Undecided, 0);
    }
    let pieces = function.over(&starts, &ends);
    let mut evaluations = 1;
    for i in 0..PIECES {
        let [low, high] = of(&pieces.slope, i);
        // A jump has no Lipschitz bound, whatever the slopes beside it.
        let known = if pieces.broken_at(i) {
            f64::INFINITY
        } else {
            lipschitz.min(high.max(-low)).max(0.0)
        };
        let left = bound.saturating_sub(evaluations);
        let piece = within(function, [starts[i], ends[i]], known, left);
        evaluations += piece.evaluations;
        if piece.outcome != Outcome::Absent {
            return Search::new(piece.outcome, evaluations);
        }
    }
    Search::new(Outcome::Absent, evaluations)
}

/// The first zero in a piece over which one Lipschitz bound holds.
fn within<F: Enclosed>(
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
    let mut step = to - from;
    let mut evaluations = 0;
    let usable = lipschitz.is_finite();
    while usable && evaluations < bound {
        if evaluations % RENEWAL == RENEWAL - 1 {
            evaluations += 1;
            march.renew(function, march.opposite.unwrap_or(to));
        }
        let end = march.opposite.unwrap_or(to);
        let before = march.clear;
        let points = ahead(before, step, end);
        evaluations += 1;
        march.advance(&points, function.at(&points));
        if march.opposite.is_none() && march.clear >= to && march.sign != 0 {
            return Search::new(Outcome::Absent, evaluations);
        }
        let gained = march.clear - before;
        let size = before.abs().max(end.abs());
        // Four units in the last place: smaller steps are rounding errors of t.
        let resolution = 4.0 * f64::EPSILON * size;
        let stuck = gained <= 0.0 && step <= resolution;
        match march.opposite {
            Some(end) if end - march.clear <= resolution => {
                return Search::new(march.found(end), evaluations);
            }
            Some(_) if stuck => {
                let outcome = march.narrowed(function, &mut evaluations, bound);
                return Search::new(outcome, evaluations);
            }
            None if stuck => return Search::new(Outcome::Undecided, evaluations),
            _ => {}
        }
        // Points reach twice as far as the last balls did.
        step = (gained * 2.0).max(step / 16.0).min(end - march.clear);
    }
    Search::new(Outcome::Undecided, evaluations)
}

/// Evaluations after which the bound is proved anew for what is left of the stretch: close to a
/// zero it then is the slope there, and steps no longer shrink in a fixed proportion.
const RENEWAL: u32 = 8;

/// Where equal pieces of a stretch begin and end.
fn pieces_of(from: f64, to: f64) -> [[f64; PIECES]; 2] {
    let width = (to - from) / PIECES as f64;
    let starts: [f64; PIECES] = std::array::from_fn(|i| from + width * i as f64);
    let ends = std::array::from_fn(|i| *starts.get(i + 1).unwrap_or(&to));
    [starts, ends]
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

struct March {
    lipschitz: f64,
    /// No zero lies before this.
    clear: f64,
    sign: i8,
    /// A point further on where the function has the other sign.
    opposite: Option<f64>,
}

impl March {
    fn renew<F: Enclosed>(&mut self, function: &mut F, end: f64) {
        let [starts, ends] = pieces_of(self.clear, end);
        if !starts.iter().zip(&ends).all(|(a, b)| a <= b) {
            return;
        }
        let pieces = function.over(&starts, &ends);
        let steepest = |i: usize| pieces.slope[1][i].max(-pieces.slope[0][i]);
        let steepest = (0..PIECES).map(steepest).fold(0.0, f64::max);
        if pieces.broken == 0 && steepest < self.lipschitz {
            self.lipschitz = steepest;
        }
    }

    fn advance(&mut self, points: &[f64; PIECES], values: [[f64; PIECES]; 2]) {
        for (i, &t) in points.iter().enumerate() {
            let [low, high] = of(&values, i);
            let sign = sign([low, high]);
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
            // differences are off by some 2⁻⁵³ of their operands.
            let value = if sign > 0 { low } else { -high };
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

    /// The end where balls have become too small to move on although a change of sign lies ahead:
    /// the first opposite sign that is certain, unless the old sign comes back in between.
    fn narrowed<F: Enclosed>(
        &mut self,
        function: &mut F,
        evaluations: &mut u32,
        bound: u32,
    ) -> Outcome {
        while let Some(end) = self.opposite
            && *evaluations < bound
        {
            let width = end - self.clear;
            let t = std::array::from_fn(|i| self.clear + width * (i as f64 + 1.0) / 9.0);
            let values = function.at(&t);
            *evaluations += 1;
            let sign = |i: usize| sign(of(&values, i));
            if (0..PIECES).any(|i| sign(i) == self.sign) {
                return Outcome::Undecided;
            }
            match (0..PIECES).find(|i| sign(*i) == -self.sign) {
                Some(i) if t[i] < end => self.opposite = Some(t[i]),
                _ => return self.found(end),
            }
        }
        Outcome::Undecided
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
