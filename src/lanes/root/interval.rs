//! Interval subdivision for any function that can be enclosed: the first zero, proved.
//!
//! A stretch of t is cut into eight pieces, over which the function and its slope are enclosed at
//! once (Mitchell 1990, "Robust ray intersection with interval arithmetic"). A piece holds no zero
//! where the enclosure excludes it, where the function is monotone between ends of one sign, or
//! where cones of the enclosed slopes over both ends do not reach zero (the mean value form, from
//! both ends; Piyavskii 1972). A run of pieces with slopes of one sign between ends of different
//! signs holds exactly one zero. What is neither is cut again, leftmost first, until the sign of
//! the function is not certain at any of the cuts; such a *cluster* holds a zero if the
//! signs at its ends differ, and is undecided otherwise: a zero of even multiplicity, or none.

use super::{Outcome, Root};

/// Pieces that are enclosed at once.
pub const PIECES: usize = 8;

/// Enclosures of a function over pieces.
#[derive(Debug, Clone, Copy)]
pub struct Pieces {
    /// Lower and upper bounds of the values.
    pub value: [[f64; PIECES]; 2],
    pub slope: [[f64; PIECES]; 2],
    /// Bit i: piece i may hold points where the function jumps or is undefined.
    pub broken: u32,
    /// Bit i: the function is undefined all over piece i.
    pub void: u32,
}

/// A function of t that can be enclosed with its slope.
pub trait Enclosed {
    /// Over the pieces [from, to].
    fn over(&mut self, from: &[f64; PIECES], to: &[f64; PIECES]) -> Pieces;
    /// Lower and upper bounds of the values at points.
    fn at(&mut self, t: &[f64; PIECES]) -> [[f64; PIECES]; 2];
    /// Whether the function, which jumps in [from, to], is proved to have no zero on either side
    /// of its jumps.
    fn jumps_over_zero(&mut self, _from: f64, _to: f64) -> bool {
        false
    }
}

/// A finder's answer and its cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    pub outcome: Outcome,
    /// Evaluations of the function, each of eight enclosures.
    pub evaluations: u32,
}

impl Search {
    pub fn new(outcome: Outcome, evaluations: u32) -> Self {
        Self {
            outcome,
            evaluations,
        }
    }
}

/// Where a stretch is cut. Uneven, so that the zeros of symmetric surfaces seen along their axes
/// do not lie on the cuts; any increasing numbers between 0 and 1 are right.
const CUTS: [f64; PIECES - 1] = [0.1193, 0.2476, 0.3731, 0.4957, 0.6218, 0.7471, 0.8762];

#[derive(Debug, Clone, Copy)]
struct End {
    t: f64,
    value: [f64; 2],
}

impl End {
    fn sign(&self) -> i8 {
        sign(self.value)
    }
}

/// −1 or 1 where bounds of a value prove it, else 0.
pub(super) fn sign([low, high]: [f64; 2]) -> i8 {
    i8::from(low > 0.0) - i8::from(high < 0.0)
}

/// A part of the stretch, in the order of t.
#[derive(Debug, Clone, Copy)]
enum Part {
    /// No zero; the sign, 0 where the function is undefined.
    Clear(i8),
    /// Exactly one zero, where the function goes from one sign to the other.
    Crossing([End; 2]),
    Open([End; 2], bool),
}

/// A stretch that may or may not hold zeros.
#[derive(Debug, Clone, Copy)]
struct Cluster {
    from: f64,
    to: f64,
    /// Sign to the left; 0 where it is unknown.
    before: i8,
    broken: bool,
}

/// The first zero in [from, to], after at most `bound` evaluations.
///
/// Found proves that no zero lies in the stretch before the enclosure, and at least one in it, at
/// neither of its ends; with multiplicity 1 it is the only one there.
pub fn first_zero<F: Enclosed>(function: &mut F, [from, to]: [f64; 2], bound: u32) -> Search {
    let mut state = State {
        function,
        evaluations: 0,
        bound,
    };
    let outcome = if from < to {
        state.search(from, to)
    } else {
        Outcome::Undecided
    };
    Search::new(outcome, state.evaluations)
}

struct State<'a, F> {
    function: &'a mut F,
    evaluations: u32,
    bound: u32,
}

impl<F: Enclosed> State<'_, F> {
    fn ends(&mut self, t: &[f64; PIECES]) -> [End; PIECES] {
        self.evaluations += 1;
        let [low, high] = self.function.at(t);
        std::array::from_fn(|i| End {
            t: t[i],
            value: [low[i], high[i]],
        })
    }

    fn search(&mut self, from: f64, to: f64) -> Outcome {
        let mut ends = [from; PIECES];
        ends[1] = to;
        let ends = self.ends(&ends);
        let mut parts = vec![Part::Open([ends[0], ends[1]], true)];
        let mut cluster: Option<Cluster> = None;
        let mut before = 0;
        while let Some(part) = parts.pop() {
            match part {
                Part::Clear(sign) => {
                    if let Some(cluster) = cluster {
                        return concluded(&cluster, sign);
                    }
                    before = sign;
                }
                Part::Crossing(ends) => {
                    return match cluster {
                        Some(cluster) => concluded(&cluster, ends[0].sign()),
                        None => self.refined(ends),
                    };
                }
                Part::Open(ends, broken) => {
                    if self.evaluations >= self.bound {
                        return Outcome::Undecided;
                    }
                    let [a, b] = ends;
                    if broken && self.jumps_over_zero(a.t, b.t) {
                        if cluster.is_some() {
                            return Outcome::Undecided;
                        }
                        before = 0;
                        continue;
                    }
                    if self.cut(ends, &mut parts) {
                        continue;
                    }
                    let known = if a.sign() == 0 { before } else { a.sign() };
                    let cluster = cluster.get_or_insert(Cluster {
                        from: a.t,
                        to: b.t,
                        before: known,
                        broken: false,
                    });
                    cluster.to = b.t;
                    cluster.broken |= broken;
                    before = 0;
                    // A sign at the end of the cluster settles it at once.
                    if b.sign() != 0 {
                        return concluded(cluster, b.sign());
                    }
                }
            }
        }
        if cluster.is_some() {
            Outcome::Undecided
        } else {
            Outcome::Absent
        }
    }

    /// Not tried on the whole stretch, of which nothing is known yet.
    fn jumps_over_zero(&mut self, from: f64, to: f64) -> bool {
        if self.evaluations == 1 {
            return false;
        }
        self.evaluations += 1;
        self.function.jumps_over_zero(from, to)
    }

    /// Cuts a part and puts the pieces in its place; false where nothing new is learnt.
    fn cut(&mut self, [a, b]: [End; 2], parts: &mut Vec<Part>) -> bool {
        let mut t = [a.t; PIECES + 1];
        for (t, cut) in t[1..].iter_mut().zip(CUTS) {
            *t = a.t + (b.t - a.t) * cut;
        }
        t[PIECES] = b.t;
        if !t.windows(2).all(|t| t[0] < t[1]) {
            return false;
        }
        let from: [f64; PIECES] = std::array::from_fn(|i| t[i]);
        let to: [f64; PIECES] = std::array::from_fn(|i| t[i + 1]);
        self.evaluations += 1;
        let pieces = self.function.over(&from, &to);
        let excluded = (0..PIECES)
            .rev()
            .map(|i| pieces.excludes(i).map(Part::Clear));
        if let Some(clear) = excluded.collect::<Option<Vec<Part>>>() {
            parts.extend(clear);
            return true;
        }
        let inner = self.ends(&to);
        let end = |i: usize| match i {
            0 => a,
            PIECES => b,
            _ => inner[i - 1],
        };
        let ends: [End; PIECES + 1] = std::array::from_fn(end);
        let new = classified(&pieces, &ends);
        let told = ends[1..PIECES].iter().any(|end| end.sign() != 0)
            || new.iter().any(|part| !matches!(part, Part::Open(..)));
        if told {
            parts.extend(new.iter().rev());
        }
        told
    }

    /// Narrows the enclosure of the only zero between two ends of different signs.
    ///
    /// Regula falsi estimates the zero; the signs at eight points around it, at distances from an
    /// eighth of the width down to its 2⁻²⁶th, narrow the bracket. Where they do not halve it, eight
    /// points at equal distances follow. The end is where the signs near the zero are lost
    /// in rounding: the values at the ends are as uncertain as they are different.
    fn refined(&mut self, mut bracket: [End; 2]) -> Outcome {
        let mut guess = true;
        loop {
            let width = bracket[1].t - bracket[0].t;
            let t = if guess {
                around(between(&bracket), &bracket)
            } else {
                std::array::from_fn(|i| bracket[0].t + width * (i as f64 + 1.0) / 9.0)
            };
            let ends = self.ends(&t);
            narrow(&mut bracket, &ends);
            let halved = bracket[1].t - bracket[0].t <= 0.5 * width;
            let exhausted = self.evaluations >= self.bound || !(halved || guess);
            if exhausted || lost_in_rounding(&bracket) {
                return Outcome::Found(Root {
                    enclosure: bracket.map(|end| end.t),
                    multiplicity: Some(1),
                });
            }
            guess = halved;
        }
    }
}

/// Moves the ends of a bracket to points of the same sign further inside, in increasing order.
fn narrow([a, b]: &mut [End; 2], points: &[End]) {
    let (left, right) = (a.sign(), b.sign());
    for &point in points {
        if point.t <= a.t || point.t >= b.t {
            continue;
        }
        if point.sign() == left {
            *a = point;
        } else if point.sign() == right {
            *b = point;
            return;
        }
    }
}

/// Whether the values at the ends differ by less than twice their uncertainty.
fn lost_in_rounding([a, b]: &[End; 2]) -> bool {
    let unknown = (a.value[1] - a.value[0]) + (b.value[1] - b.value[0]);
    let difference = (a.value[0] + 0.5 * (a.value[1] - a.value[0]))
        - (b.value[0] + 0.5 * (b.value[1] - b.value[0]));
    // NaN, from unbounded values, is no reason to stop.
    difference.abs() <= 2.0 * unknown
}

/// Points on both sides of one in a bracket, in increasing order.
fn around(centre: f64, [a, b]: &[End; 2]) -> [f64; PIECES] {
    const SPREAD: [f64; PIECES / 2] = [1.0 / 8.0, 1.0 / 256.0, 1.0 / 32_768.0, 1.0 / 67_108_864.0];
    let mut t = [centre; PIECES];
    for (i, spread) in SPREAD.iter().enumerate() {
        let distance = (b.t - a.t) * spread;
        // At least the neighbouring numbers, within the bracket.
        t[i] = (centre - distance).min(centre.next_down()).max(a.t);
        t[PIECES - 1 - i] = (centre + distance).max(centre.next_up()).min(b.t);
    }
    t
}

/// Where the chord between two ends of different signs meets zero, strictly between them if a
/// number lies there.
fn between([a, b]: &[End; 2]) -> f64 {
    let middle = |[low, high]: [f64; 2]| 0.5 * low + 0.5 * high;
    let (fa, fb) = (middle(a.value), middle(b.value));
    let t = a.t + (b.t - a.t) * (fa / (fa - fb));
    if t > a.t && t < b.t {
        t
    } else {
        a.t + 0.5 * (b.t - a.t)
    }
}

fn concluded(cluster: &Cluster, after: i8) -> Outcome {
    if !cluster.broken && cluster.before * after == -1 {
        Outcome::Found(Root {
            enclosure: [cluster.from, cluster.to],
            multiplicity: None,
        })
    } else {
        Outcome::Undecided
    }
}

/// The bounds of one piece or point.
pub(super) fn of(bounds: &[[f64; PIECES]; 2], i: usize) -> [f64; 2] {
    [bounds[0][i], bounds[1][i]]
}

impl Pieces {
    pub(super) fn broken_at(&self, i: usize) -> bool {
        self.broken >> i & 1 == 1
    }

    /// The sign of the function where the enclosure alone excludes a zero.
    fn excludes(&self, i: usize) -> Option<i8> {
        if self.void >> i & 1 == 1 {
            return Some(0);
        }
        let sign = sign(of(&self.value, i));
        // Where it may jump, one sign is still the sign everywhere that it is defined.
        (sign != 0).then_some(sign)
    }

    /// 1 or −1 where the function rises or falls all over the piece.
    fn direction(&self, i: usize) -> i8 {
        if self.broken_at(i) {
            0
        } else {
            sign(of(&self.slope, i))
        }
    }

    /// Whether cones of the slopes over both ends, which have this sign, stay off zero.
    ///
    /// From a value v > 0 at the left end the function stays positive for v/(−s) if its slopes are
    /// at least s < 0, and for v/S to the left of the right end if they are at most S > 0. The
    /// quotients, their sum and the width are off by a few 2⁻⁵³, or by underflow.
    fn cones_clear(&self, i: usize, ends: &[End], sign: i8) -> bool {
        let [low, high] = of(&self.slope, i);
        let [a, b] = [&ends[i], &ends[i + 1]];
        let (va, vb, fall, rise) = if sign > 0 {
            (a.value[0], b.value[0], -low, high)
        } else {
            (-a.value[1], -b.value[1], high, -low)
        };
        let reach = |value: f64, speed: f64| {
            if speed > 0.0 {
                value / speed
            } else {
                f64::INFINITY
            }
        };
        let covered = reach(va, fall) + reach(vb, rise);
        covered * (1.0 - 8.0 * f64::EPSILON) - f64::MIN_POSITIVE > b.t - a.t
    }
}

/// The parts that pieces are, one for each run of pieces over which the function is monotone and has
/// its zero.
fn classified(pieces: &Pieces, ends: &[End; PIECES + 1]) -> Vec<Part> {
    let mut parts = Vec::with_capacity(PIECES);
    let mut i = 0;
    while i < PIECES {
        if let Some(sign) = pieces.excludes(i) {
            parts.push(Part::Clear(sign));
            i += 1;
            continue;
        }
        let direction = pieces.direction(i);
        let mut to = i + 1;
        while direction != 0 && to < PIECES && pieces.direction(to) == direction {
            to += 1;
        }
        let (before, after) = (ends[i].sign(), ends[to].sign());
        if direction != 0 && before == -direction && after == direction {
            parts.push(narrowest(&ends[i..=to], direction));
            i = to;
            continue;
        }
        parts.push(single(pieces, ends, i));
        i += 1;
    }
    parts
}

/// The crossing of a monotone run, between the last end before it and the first after it.
fn narrowest(ends: &[End], direction: i8) -> Part {
    let before = ends.iter().rfind(|end| end.sign() == -direction);
    let after = ends.iter().find(|end| end.sign() == direction);
    // The outermost ends have these signs: the caller has looked.
    let (first, last) = (&ends[0], &ends[ends.len() - 1]);
    Part::Crossing([*before.unwrap_or(first), *after.unwrap_or(last)])
}

/// The part that a piece is which belongs to no run with a crossing.
fn single(pieces: &Pieces, ends: &[End; PIECES + 1], i: usize) -> Part {
    let bracket = [ends[i], ends[i + 1]];
    let [before, after] = bracket.map(|end| end.sign());
    let broken = pieces.broken_at(i);
    let direction = pieces.direction(i);
    if direction != 0 && before == direction {
        return Part::Clear(before);
    }
    if direction != 0 && after == -direction {
        return Part::Clear(after);
    }
    if !broken && before != 0 && before == after && pieces.cones_clear(i, ends, before) {
        return Part::Clear(before);
    }
    Part::Open(bracket, broken)
}

/// Where the search for the next zero begins on a ray that leaves a surface: it starts at a zero whose
/// place is known up to rounding.
///
/// `blurred` encloses the function for all starts that rounding may have put in the place of the true
/// one, `sharp` for the start as given. Up to the returned t the function is monotone, so that no start
/// has a zero besides its own, and at t it has the sign of the side that the ray leaves to. 0 where no
/// start is a zero of this function; `None` where neither can be proved, as for a ray along the
/// surface.
pub fn departure<B: Enclosed, S: Enclosed>(blurred: &mut B, sharp: &mut S, to: f64) -> Option<f64> {
    let mut width = to;
    // Two rounds reach down to 8⁻¹⁵ = 3e-14 of the stretch.
    for _ in 0..2 {
        let mut ends = [width; PIECES];
        for end in &mut ends {
            *end = width;
            width *= 0.125;
        }
        let pieces = blurred.over(&[0.0; PIECES], &ends);
        let values = sharp.at(&ends);
        for (i, &end) in ends.iter().enumerate() {
            if pieces.broken_at(i) {
                continue;
            }
            if sign(of(&pieces.value, i)) != 0 {
                return Some(0.0);
            }
            let direction = sign(of(&pieces.slope, i));
            if direction != 0 && sign(of(&values, i)) == direction {
                return Some(end);
            }
        }
    }
    None
}
