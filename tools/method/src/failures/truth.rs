//! Exact verdicts: which crossing of a ray comes first, in arithmetic that does not round.
//!
//! Canonical shapes are solved here once more, by the schoolbook in numbers of any length (quotients and
//! roots to 1024 bits), so that the ladder is judged by something else than itself.

use std::cmp::Ordering;

use super::Subject;
use super::families::Body;
use etalon::inside::math::exact::Exact;
use etalon::inside::math::number::{Number, dot, power_of_two};
use etalon::inside::shape::ladder::{Ladder, ScaledRay};
use etalon::inside::shape::line::LocalRay;
use etalon::inside::shape::{Ray, ShapeKind};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct First {
    /// Where, in units of the direction.
    pub t: f64,
    pub body: usize,
    /// From it to the next crossing of any body; infinite where there is none.
    pub gap: f64,
    /// From it to the next crossing of another body.
    pub other: f64,
}

/// The first hit with t ≥ 0; `None` where there is none.
pub fn first(subject: Subject, bodies: &[Body], ray: &Ray) -> Option<First> {
    let mut all: Vec<(Exact, usize)> = Vec::new();
    for (index, body) in bodies.iter().enumerate() {
        let crossings = match subject {
            Subject::Canonical(kind) => canonical(kind, body, ray),
            Subject::Implicit(_) => implicit(body, ray),
        };
        all.extend(crossings.into_iter().map(|t| (t, index)));
    }
    all.retain(|(t, _)| t.sign() != Some(Ordering::Less));
    all.sort_by(|(a, _), (b, _)| order(a, b));
    let (t, body) = all.first()?;
    let after = |crossing: Option<&(Exact, usize)>| {
        crossing.map_or(f64::INFINITY, |(next, _)| next.minus(t).to_f64())
    };
    Some(First {
        t: t.to_f64(),
        body: *body,
        gap: after(all.get(1)),
        other: after(all.iter().find(|(_, other)| other != body)),
    })
}

fn order(a: &Exact, b: &Exact) -> Ordering {
    a.minus(b).sign().unwrap_or(Ordering::Equal)
}

/// The first two hits of an implicit surface, by integers.
fn implicit(body: &Body, ray: &Ray) -> Vec<Exact> {
    let Some(certified) = &body.certified else {
        return Vec::new();
    };
    let first = certified.exactly(ray, [0.0, f64::INFINITY]);
    let second = first.and_then(|root| {
        let after = root.enclosure[1].next_up();
        certified.exactly(ray, [after, f64::INFINITY])
    });
    let both = [first, second].into_iter().flatten();
    both.map(|root| Exact::of(root.t)).collect()
}

/// Where a ray enters and leaves a canonical shape, in units of its direction.
fn canonical(kind: ShapeKind, body: &Body, ray: &Ray) -> Vec<Exact> {
    let Ok(ladder) = Ladder::new(&body.to_world) else {
        return Vec::new();
    };
    let scaled = ScaledRay::new(ray);
    let line = ladder.exact.local(&scaled);
    let all = [0, 1, 2];
    let ends = match kind {
        ShapeKind::Sphere => round(&line, &all),
        ShapeKind::Cube => all
            .iter()
            .try_fold(None, |span, axis| {
                Some(Some(common(span, slab(&line, *axis)?)?))
            })
            .flatten(),
        ShapeKind::Cylinder => slab(&line, 2).and_then(|caps| {
            let side = round(&line, &all[..2])?;
            common(Some(side), caps)
        }),
        ShapeKind::Disk | ShapeKind::Rectangle | ShapeKind::Plane => flat(kind, &line),
    };
    let unit = Exact::of(power_of_two(scaled.exponent));
    let mut ends = ends.map_or_else(Vec::new, Vec::from);
    ends.dedup_by(|a, b| order(a, b) == Ordering::Equal);
    ends.into_iter().map(|t| t.divided_by(&unit)).collect()
}

/// The crossing with z = 0, twice, if it lies in the shape.
fn flat(kind: ShapeKind, line: &LocalRay<Exact>) -> Option<[Exact; 2]> {
    let dz = &line.direction[2];
    dz.magnitude()?;
    // x · dz and y · dz at the crossing, times the line's scale.
    let [x, y] = [0, 1].map(|i| {
        let (o, d) = (&line.origin[i], &line.direction[i]);
        o.times(dz).minus(&line.origin[2].times(d))
    });
    let edge = line.scale.times(dz);
    let square = |x: &Exact| x.times(x);
    let within = |x: &Exact| order(&square(x), &square(&edge)).is_le();
    let inside = match kind {
        ShapeKind::Disk => order(&square(&x).plus(&square(&y)), &square(&edge)).is_le(),
        ShapeKind::Rectangle => within(&x) && within(&y),
        _ => true,
    };
    let t = line.origin[2].negated().divided_by(dz);
    inside.then(|| [t.clone(), t])
}

/// Within |coordinate| ≤ 1: everywhere is from −10³⁰⁰ to 10³⁰⁰.
fn slab(line: &LocalRay<Exact>, axis: usize) -> Option<[Exact; 2]> {
    let (o, d) = (&line.origin[axis], &line.direction[axis]);
    if d.magnitude().is_none() {
        let beside = order(&o.times(o), &line.scale.times(&line.scale)) == Ordering::Greater;
        return (!beside).then(|| [-1e300, 1e300].map(Exact::of));
    }
    let face = |sign: f64| line.scale.times(&Exact::of(sign)).minus(o).divided_by(d);
    let (a, b) = (face(-1.0), face(1.0));
    Some(if order(&a, &b).is_gt() {
        [b, a]
    } else {
        [a, b]
    })
}

/// Within the unit sphere of some coordinates.
fn round(line: &LocalRay<Exact>, axes: &[usize]) -> Option<[Exact; 2]> {
    let part = |v: &[Exact; 3]| -> Vec<Exact> { axes.iter().map(|i| v[*i].clone()).collect() };
    let (o, d) = (part(&line.origin), part(&line.direction));
    let (a, b) = (dot(&d, &d), dot(&o, &d));
    let c = dot(&o, &o).minus(&line.scale.times(&line.scale));
    if a.magnitude().is_none() {
        return (c.sign() != Some(Ordering::Greater)).then(|| [-1e300, 1e300].map(Exact::of));
    }
    let discriminant = b.times(&b).minus(&a.times(&c));
    if discriminant.sign() == Some(Ordering::Less) {
        return None;
    }
    let root = discriminant.square_root();
    let ends = [b.negated().minus(&root), b.negated().plus(&root)];
    Some(ends.each_ref().map(|t| t.divided_by(&a)))
}

/// What two spans have in common.
fn common(span: Option<[Exact; 2]>, [low, high]: [Exact; 2]) -> Option<[Exact; 2]> {
    let Some([a, b]) = span else {
        return Some([low, high]);
    };
    let low = if order(&a, &low).is_lt() { low } else { a };
    let high = if order(&b, &high).is_gt() { high } else { b };
    (order(&low, &high).is_le()).then_some([low, high])
}
