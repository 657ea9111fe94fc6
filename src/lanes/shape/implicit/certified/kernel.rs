//! The first hits of a packet in one arithmetic.

use super::place::{Certified, FactorField, Inverse};
use super::{Answers, Ask, Packet, SHARP, WIDTH};
use crate::field::program::Step;
use crate::math::instructions::DoubleLanes;
use crate::math::lanes::{Mask, Real};
use crate::math::words::{Pair, Plain, Row, Word};
use crate::root::bernstein::{MOST, Question, Roots, first_roots};

struct Clipped<L: DoubleLanes> {
    near: L::Real,
    far: L::Real,
    /// Bound of the distance between rounded and exact local points on the clipped line.
    shift: L::Real,
    /// Distance by which the local start may be off, for rays that leave the surface, over their unit
    /// roundoff.
    start_shift: L::Real,
    meets: L::Mask,
    /// Lanes for which the bounds mean nothing.
    lost: L::Mask,
}

/// The first hits, as far as this arithmetic can tell.
#[inline(never)]
pub(super) fn first_hits<L: DoubleLanes, W: Solving<L>>(l: L, ask: Ask<'_>) -> Answers {
    l.vectorize(inlined!(|| {
        let Ask { placed, packet, .. } = ask;
        let rows = ask.rows;
        let mut answers = Answers::default();
        for at in (0..WIDTH).step_by(L::COUNT) {
            let asked = l.mask_from_bits(ask.asked >> at);
            if L::COUNT < WIDTH && !asked.any() {
                continue;
            }
            let inverse = &placed.inverse[W::ROWS - 1];
            let local = Local::<L, W>::new(l, inverse, packet, at);
            let clipped = local.clip(l, placed, inverse, packet, at);
            let mut all = Combined::new(l, asked, &clipped);
            if all.open.any() {
                let ends = local.ends(l, &clipped);
                for factor in &placed.factors {
                    expand::<L, W>(l, factor, &ends, rows);
                    all.join::<W>(l, factor, (packet, at), &clipped, rows);
                }
            }
            all.answer(l, placed, &local, &clipped, at, &mut answers);
        }
        answers
    }))
}

/// Rays in object coordinates.
struct Local<L: DoubleLanes, W: Word<L>> {
    origin: [W; 3],
    direction: [W; 3],
    /// Largest magnitude of a world coordinate of the origin, and of a component of the direction.
    extent: L::Real,
    length: L::Real,
}

impl<L: DoubleLanes, W: Word<L>> Local<L, W> {
    #[inline(always)]
    fn new(l: L, inverse: &Inverse, packet: &Packet, at: usize) -> Self {
        let (o, d) = (&packet.origin, &packet.direction);
        let o = [
            l.load(&o[0][at..]),
            l.load(&o[1][at..]),
            l.load(&o[2][at..]),
        ];
        let d = [
            l.load(&d[0][at..]),
            l.load(&d[1][at..]),
            l.load(&d[2][at..]),
        ];
        let mut local = Self {
            origin: o.map(inlined!(|x| W::real(l, x))),
            direction: d.map(inlined!(|x| W::real(l, x))),
            extent: o[0].abs().max(o[1].abs()).max(o[2].abs()),
            length: d[0].abs().max(d[1].abs()).max(d[2].abs()),
        };
        for i in 0..3 {
            let row = &inverse.rows[i];
            let mut origin = W::constant(l, row[3]);
            let mut direction = W::constant(l, [0.0; 2]);
            for j in (0..3).rev() {
                let entry = W::constant(l, row[j]);
                origin = entry.fused(W::real(l, o[j]), origin);
                direction = entry.fused(W::real(l, d[j]), direction);
            }
            local.origin[i] = origin;
            local.direction[i] = direction;
        }
        local
    }

    /// The part of the lines within the limits and the box, widened by a bound of rounding.
    #[inline(always)]
    fn clip(
        &self,
        l: L,
        placed: &Certified,
        inverse: &Inverse,
        packet: &Packet,
        at: usize,
    ) -> Clipped<L> {
        let zero = l.real(0.0);
        let tiny = l.real(f64::MIN_POSITIVE * 1e16);
        let o = self.origin.map(inlined!(|x: W| x.head()));
        let d = self.direction.map(inlined!(|x: W| x.head()));
        let face = l.real(placed.farthest);
        let reach = o[0].abs().max(o[1].abs()).max(o[2].abs()) + face;
        let fastest = d[0].abs().max(d[1].abs()).max(d[2].abs());
        // No point of the box is farther along the line; the factor 2 pays for the margin.
        let farthest = (reach + reach) / fastest;
        let moved = self.extent.mul_add(
            l.real(inverse.direction_error),
            l.real(inverse.offset_error),
        );
        let turned = self.length * l.real(inverse.direction_error);
        let map_error = farthest.mul_add(turned, moved);
        // Where a face is met, t is rounded three times (difference, reciprocal, product), which moves the
        // point by 3u (reach + margin); 4ε are 8u.
        let slack = reach.mul_add(l.real(4.0 * f64::EPSILON), map_error);
        let mut lost = !slack.lt(l.real(placed.margin * 0.5)) | !fastest.gt(tiny);
        let mut meets = l.mask(true);
        let (mut near, mut far) = (l.load(&packet.t_min[at..]), l.load(&packet.t_max[at..]));
        for i in 0..3 {
            let lower = l.real(placed.outer[0][i]) - slack;
            let upper = l.real(placed.outer[1][i]) + slack;
            let inverse = l.real(1.0) / d[i];
            let (t1, t2) = ((lower - o[i]) * inverse, (upper - o[i]) * inverse);
            let along = d[i].same(zero);
            // Beside the box, or along it for all t.
            let beside = along & (o[i].lt(lower) | o[i].gt(upper));
            meets = meets & !beside;
            lost = lost | (!along & !d[i].abs().gt(tiny));
            near = l.select(along, near, t1.min(t2).max(near));
            far = l.select(along, far, t1.max(t2).min(far));
        }
        // Rounding of the ends: in f64 a fused operation, off by u of a point of the box; in double-double
        // a product and a sum, 3 units with that of t, doubled for evaluating the bound.
        let rounding = reach.mul_add(l.real(3.0 * W::UNIT), map_error);
        let rounding = if W::ROWS == 1 {
            map_error + face * l.real(f64::EPSILON)
        } else {
            rounding + rounding
        };
        Clipped {
            near,
            far,
            shift: rounding,
            // 2³ roundings on the way to the point and as many back, as in `EnclosedPacket::first_hits`.
            start_shift: (self.extent + self.extent) * l.real(8.0 * inverse.largest_row),
            meets: meets & near.le(far),
            lost: lost | !(far - near).lt(l.real(f64::INFINITY)) & meets & near.le(far),
        }
    }

    #[inline(always)]
    fn ends(&self, l: L, clipped: &Clipped<L>) -> [[W; 2]; 3] {
        let (near, far) = (W::real(l, clipped.near), W::real(l, clipped.far));
        let mut ends = [[near; 2]; 3];
        #[expect(
            clippy::needless_range_loop,
            reason = "iterators over lanes are not always inlined"
        )]
        for i in 0..3 {
            let (o, d) = (self.origin[i], self.direction[i]);
            ends[i] = [d.fused(near, o), d.fused(far, o)];
        }
        ends
    }
}

/// Bernstein coefficients of a factor between the ends.
#[inline(always)]
fn expand<L: DoubleLanes, W: Word<L>>(
    l: L,
    factor: &FactorField,
    ends: &[[W; 2]; 3],
    rows: &mut [Row],
) {
    for step in &factor.program.steps {
        match step {
            Step::Coordinate { axis, to } => {
                ends[*axis][0].store(l, rows, to.at);
                ends[*axis][1].store(l, rows, to.at + 1);
            }
            Step::Product { a, b, to } => {
                let (known, result) = rows.split_at_mut(W::ROWS * to.at);
                if a == b {
                    square::<L, W>(l, known, a.at, a.degree, result);
                } else {
                    let (a, b) = if a.degree <= b.degree { (a, b) } else { (b, a) };
                    for k in 0..=to.degree {
                        let first = k.saturating_sub(b.degree);
                        let last = a.degree.min(k);
                        let mut sum = W::load(l, known, a.at + first).times(W::load(
                            l,
                            known,
                            b.at + k - first,
                        ));
                        for i in first + 1..=last {
                            let x = W::load(l, known, a.at + i);
                            sum = x.fused(W::load(l, known, b.at + k - i), sum);
                        }
                        sum.store(l, result, k);
                    }
                }
            }
            Step::Combination {
                terms,
                constant,
                to,
            } => {
                let (known, result) = rows.split_at_mut(W::ROWS * to.at);
                W::constant(l, constant.parts).store(l, result, 0);
                let mut degree = 0;
                for (factor, form) in terms {
                    while degree < form.degree {
                        elevate::<L, W>(l, result, degree);
                        degree += 1;
                    }
                    let factor = W::constant(l, factor.parts);
                    for i in 0..=degree {
                        let sum = W::load(l, result, i);
                        factor
                            .fused(W::load(l, known, form.at + i), sum)
                            .store(l, result, i);
                    }
                }
                while degree < to.degree {
                    elevate::<L, W>(l, result, degree);
                    degree += 1;
                }
            }
        }
    }
    let result = factor.program.result;
    for (i, &reciprocal) in factor.reciprocals.iter().enumerate() {
        let c = W::load(l, rows, result.at + i).times(W::constant(l, reciprocal));
        c.store(l, rows, result.at + i);
    }
}

/// Multiplies a form by (1 − s) + s.
#[inline(always)]
fn elevate<L: DoubleLanes, W: Word<L>>(l: L, form: &mut [Row], degree: usize) {
    let mut carried = W::load(l, form, 0);
    for i in 1..=degree {
        let next = W::load(l, form, i);
        carried.plus(next).store(l, form, i);
        carried = next;
    }
    carried.store(l, form, degree + 1);
}

/// The square of a form: products of unequal coefficients count twice.
#[inline(always)]
fn square<L: DoubleLanes, W: Word<L>>(
    l: L,
    known: &[Row],
    at: usize,
    degree: usize,
    result: &mut [Row],
) {
    for k in 0..=2 * degree {
        let first = k.saturating_sub(degree);
        let pairs = k.div_ceil(2);
        let half = k / 2;
        if first >= pairs {
            let x = W::load(l, known, at + half);
            x.times(x).store(l, result, k);
            continue;
        }
        let mut sum = W::load(l, known, at + first).times(W::load(l, known, at + k - first));
        for i in first + 1..pairs {
            let x = W::load(l, known, at + i);
            sum = x.fused(W::load(l, known, at + k - i), sum);
        }
        sum = sum.times_real(l.real(2.0));
        if k % 2 == 0 {
            let x = W::load(l, known, at + half);
            sum = x.fused(x, sum);
        }
        sum.store(l, result, k);
    }
}

/// The first roots, compiled for M coefficients, so that they can stay in registers, or for up to
/// [`MOST`].
#[inline(never)]
fn ask<L: DoubleLanes, W: Word<L>, const M: usize>(
    l: L,
    question: &Question<L>,
    rows: &[Row],
    count: usize,
) -> Roots<L> {
    l.vectorize(inlined!(|| {
        let count = if M == MOST { count } else { M };
        let mut coefficients = [W::constant(l, [0.0; 2]); M];
        for (i, c) in coefficients[..count].iter_mut().enumerate() {
            *c = W::load(l, rows, i);
        }
        first_roots(l, &coefficients, count, question)
    }))
}

pub(super) trait Solving<L: DoubleLanes>: Word<L> {
    fn solve(l: L, question: &Question<L>, rows: &[Row], count: usize) -> Roots<L>;
}

impl<L: DoubleLanes> Solving<L> for Plain<L> {
    #[inline(always)]
    fn solve(l: L, question: &Question<L>, rows: &[Row], count: usize) -> Roots<L> {
        match count {
            3 => ask::<_, Self, 3>(l, question, rows, count),
            5 => ask::<_, Self, 5>(l, question, rows, count),
            7 => ask::<_, Self, 7>(l, question, rows, count),
            9 => ask::<_, Self, 9>(l, question, rows, count),
            _ => ask::<_, Self, MOST>(l, question, rows, count),
        }
    }
}

/// One solver for all degrees, as few rays come here.
impl<L: DoubleLanes> Solving<L> for Pair<L> {
    #[inline(always)]
    fn solve(l: L, question: &Question<L>, rows: &[Row], count: usize) -> Roots<L> {
        ask::<_, Self, MOST>(l, question, rows, count)
    }
}

/// The first root over all factors.
struct Combined<L: DoubleLanes> {
    found: L::Mask,
    open: L::Mask,
    absent: L::Mask,
    undecided: L::Mask,
    t: L::Real,
    low: L::Real,
    high: L::Real,
    multiplicity: L::Real,
    doubt: L::Real,
}

impl<L: DoubleLanes> Combined<L> {
    #[inline(always)]
    fn new(l: L, asked: L::Mask, clipped: &Clipped<L>) -> Self {
        let infinite = l.real(f64::INFINITY);
        Self {
            found: l.mask(false),
            open: asked & clipped.meets & !clipped.lost,
            absent: asked & !clipped.meets & !clipped.lost,
            undecided: asked & clipped.lost,
            t: infinite,
            low: infinite,
            high: infinite,
            multiplicity: l.real(0.0),
            doubt: infinite,
        }
    }

    #[inline(always)]
    fn join<W: Solving<L>>(
        &mut self,
        l: L,
        factor: &FactorField,
        (packet, at): (&Packet, usize),
        clipped: &Clipped<L>,
        rows: &[Row],
    ) {
        let result = factor.program.result;
        let bounds = &factor.bounds[W::ROWS - 1];
        let error = clipped
            .shift
            .mul_add(l.real(bounds.change), l.real(bounds.error));
        // The start of a ray that leaves the surface is a root up to the error of the finder that found
        // it and up to the rounding of its world coordinates.
        let rounding = clipped.start_shift * l.real(packet.roundoff);
        let question = Question {
            error,
            start_error: rounding.mul_add(l.real(bounds.change), error + l.real(factor.root_error)),
            accounted: factor.accounted,
            roots_at_end: packet.roots_at_end,
            on_root: l.mask_from_bits(packet.leaving >> at),
            active: self.open & !self.undecided,
        };
        let rows = &rows[W::ROWS * result.at..];
        let roots = W::solve(l, &question, rows, result.degree + 1);
        let width = clipped.far - clipped.near;
        let largest = clipped.near.abs().max(clipped.far.abs());
        let slack = largest * l.real(2.0 * f64::EPSILON);
        let t = roots.root.mul_add(width, clipped.near);
        let low = roots.low.mul_add(width, clipped.near) - slack;
        let high = roots.high.mul_add(width, clipped.near) + slack;
        let first = roots.found & low.lt(self.low);
        let apart = high.lt(self.low) | self.high.lt(low);
        let power = l.real(f64::from(factor.power));
        let known = l.select(apart, power, l.real(0.0));
        let farther = roots.found & !first & !apart;
        self.multiplicity = l.select(first, known, self.multiplicity);
        self.multiplicity = l.select(farther, l.real(0.0), self.multiplicity);
        self.t = l.select(first, t, self.t);
        self.low = l.select(first, low, self.low);
        self.high = l.select(roots.found, high.min(self.high), self.high);
        self.found = self.found | roots.found;
        self.doubt = roots.doubt.mul_add(width, clipped.near);
        self.undecided = self.undecided | (question.active & !roots.found & !roots.absent);
    }

    #[inline(always)]
    fn answer<W: Word<L>>(
        self,
        l: L,
        placed: &Certified,
        local: &Local<L, W>,
        clipped: &Clipped<L>,
        at: usize,
        answers: &mut Answers,
    ) {
        let low = self.low.max(clipped.near);
        let high = self.high.min(clipped.far);
        let mut sure = self.found & !self.undecided;
        if placed.is_cut {
            // The share of the margin is wider than the rounding of these points.
            for i in 0..3 {
                let (o, d) = (local.origin[i].head(), local.direction[i].head());
                let (a, b) = (d.mul_add(low, o), d.mul_add(high, o));
                let slack = clipped.shift + l.real(placed.margin / 1024.0);
                let (least, most) = (a.min(b) - slack, a.max(b) + slack);
                sure =
                    sure & least.gt(l.real(placed.cut[0][i])) & most.lt(l.real(placed.cut[1][i]));
            }
        }
        let absent = self.absent | (self.open & !self.found & !self.undecided);
        let width = clipped.far - clipped.near;
        answers.found |= sure.bits() << at;
        answers.absent |= absent.bits() << at;
        answers.blurred |= (high - low).gt(width * l.real(SHARP)).bits() << at;
        l.store(self.t.max(low).min(high), &mut answers.t[at..]);
        l.store(low, &mut answers.low[at..]);
        l.store(self.doubt, &mut answers.doubt[at..]);
        l.store(width, &mut answers.stretch[at..]);
        l.store(high, &mut answers.high[at..]);
        let mut multiplicity = [0.0; WIDTH];
        l.store(self.multiplicity, &mut multiplicity[at..]);
        let to = answers.multiplicity[at..].iter_mut().take(L::COUNT);
        for (to, m) in to.zip(&multiplicity[at..]) {
            *to = *m as u32;
        }
    }
}
