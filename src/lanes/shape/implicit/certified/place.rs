//! A polynomial surface placed in the world, with every bound that does not depend on the ray.

use glam::DVec3;

use crate::field::outer::outer_box;
use crate::field::program::Program;
use crate::field::program::bounds::{Bound, PLAIN, Rounding, binomial, bounds};
use crate::field::tape::Tape;
use crate::math::double_double::DoubleDouble;
use crate::math::exact::Exact;
use crate::math::number::Number;
use crate::root::bernstein::{DEGREES, split_error};
use crate::shape::ladder::Ladder;

/// Double-double in lanes, see [`crate::math::words::Pair`].
const PAIR: Rounding = Rounding {
    unit: 2.0 * f64::EPSILON * f64::EPSILON,
    steps: 2.0,
    parts: 2,
};

#[derive(Debug, Clone)]
pub struct FactorField {
    pub program: Program,
    pub power: u32,
    /// 1 / C(n, i), each as a sum of two f64.
    pub reciprocals: Vec<[f64; 2]>,
    pub bounds: [Bound; 2],
    /// Bound of the value at a root as f64 finds it.
    pub root_error: f64,
    /// Share of the solver's rounding that its bounds include: 1, but for tests.
    pub accounted: f64,
}

/// The map from world to object in one arithmetic.
#[derive(Debug, Clone, Copy)]
pub(super) struct Inverse {
    /// Entries of the 3×4 matrix, each as a sum of two f64.
    pub rows: [[[f64; 2]; 4]; 3],
    /// Error of a local direction's component, for a direction whose largest component is 1; and of
    /// a local origin's, likewise …
    pub direction_error: f64,
    /// … but for the part of it that does not depend on the origin.
    pub offset_error: f64,
    /// Largest sum of a row's magnitudes: local length of a world vector of components 1.
    pub largest_row: f64,
}

#[derive(Debug, Clone)]
pub struct Certified {
    pub factors: Vec<FactorField>,
    pub(super) inverse: [Inverse; 2],
    pub(super) ladder: Ladder,
    /// Where hits count, object coordinates.
    pub(super) clip: [[f64; 3]; 2],
    /// Within it, where the surface is.
    pub(super) outer: [[f64; 3]; 2],
    /// Largest magnitude of a coordinate there.
    pub(super) farthest: f64,
    /// Faces of the clip box that cut the surface; infinite where the surface does not reach them.
    pub(super) cut: [[f64; 3]; 2],
    /// Whether there are such faces.
    pub(super) is_cut: bool,
    /// How far outside of the outer box the ends of a clipped ray may lie.
    pub(super) margin: f64,
}

/// [`Certified::margin`] over half the largest edge of the outer box.
const MARGIN: f64 = 1.0 / 1024.0;

impl Certified {
    /// Places the zeros of a field within a clip box; `None` where the field is no polynomial, or
    /// one that is too large.
    pub fn new(field: &Tape, clip: [DVec3; 2], ladder: &Ladder) -> Option<Self> {
        let factors = field.factors().factors;
        let programs = factors
            .iter()
            .map(|f| Some((Program::new(&f.tape, &DEGREES)?, f.multiplicity)));
        let mut programs = programs.collect::<Option<Vec<_>>>()?;
        let tapes: Vec<Tape> = factors.into_iter().map(|f| f.tape).collect();
        let whole = outer_box(&tapes, clip);
        if whole.is_none() {
            programs.clear();
        }
        let outer = whole.unwrap_or(clip);
        let margin = MARGIN * ((outer[1] - outer[0]) / 2.0).max_element().max(0.0);
        let farthest = outer[0].abs().max(outer[1].abs());
        let reach = (farthest + margin).to_array();
        let cut = [(0, f64::NEG_INFINITY), (1, f64::INFINITY)].map(|(i, free)| {
            let is_free = (outer[i] - clip[i]).abs().cmpgt(DVec3::splat(margin));
            DVec3::select(is_free, DVec3::splat(free), clip[i])
        });
        let is_cut = cut.iter().any(|corner| corner.is_finite_mask().any());
        let factors = programs
            .into_iter()
            .map(|(program, power)| FactorField::new(program, power, reach))
            .collect();
        Some(Self {
            factors,
            inverse: [
                // 6u, and half a unit for rounding the bounds: see [`crate::shape::lanes`].
                Inverse::new(ladder, 6.5 * f64::EPSILON / 2.0, |_| 0.0, 1),
                // Three products and three sums are each off by a unit, two more pay for evaluating the
                // bound; and the entries' own errors.
                Inverse::new(ladder, 8.0 * PAIR.unit, DoubleDouble::error, 2),
            ],
            ladder: ladder.clone(),
            clip: clip.map(|corner| corner.to_array()),
            outer: outer.map(|corner| corner.to_array()),
            farthest: farthest.max_element(),
            cut: cut.map(|corner| corner.to_array()),
            is_cut,
            margin,
        })
    }
}

impl FactorField {
    fn new(program: Program, power: u32, reach: [f64; 3]) -> Self {
        let degree = program.result.degree;
        let binomials: Vec<f64> = (0..=degree).map(|i| binomial(degree, i)).collect();
        let reciprocal = |b: &f64| {
            let high = 1.0 / b;
            [high, (-b).mul_add(high, 1.0) / b]
        };
        let by_tier = [PLAIN, PAIR].map(|rounding| bounds(&program, reach, rounding));
        // At a root that f64 finds, the value as computed is within the bound of 0, and the exact one
        // within the bound of that. Hardly any root takes as many splits as 16.
        let splits = 16.0 * split_error(degree, PLAIN.unit) * by_tier[0].size;
        Self {
            root_error: 2.0 * (by_tier[0].error + splits),
            accounted: 1.0,
            reciprocals: binomials.iter().map(reciprocal).collect(),
            bounds: by_tier,
            program,
            power,
        }
    }
}

impl Inverse {
    /// Whether products with these entries are exact, and nothing is added: one entry of a row is
    /// a power of two, the others are zero.
    fn is_exact(ladder: &Ladder, entries: &[[DoubleDouble; 4]; 3]) -> bool {
        let frame = &ladder.exact;
        entries.iter().zip(&frame.adjugate).all(|(row, exact)| {
            let linear = row[..3].iter().zip(exact).all(|(entry, adjugate)| {
                let rounded = Exact::of(entry.to_f64()).times(&frame.scale);
                let same = rounded.minus(adjugate).magnitude().is_none();
                let mantissa = entry.to_f64().to_bits() & ((1 << 52) - 1);
                same && mantissa == 0
            });
            let single = row[..3].iter().filter(|e| e.to_f64() != 0.0).count() == 1;
            linear && single && row[3].to_f64() == 0.0 && row[3].error() == 0.0
        })
    }

    fn new(ladder: &Ladder, unit: f64, own: impl Fn(&DoubleDouble) -> f64, parts: usize) -> Self {
        let entries = ladder.double_double.inverse();
        let rows = entries.each_ref().map(|row| {
            row.each_ref().map(|entry| {
                let [high, low] = entry.parts();
                if parts == 1 { [high, 0.0] } else { [high, low] }
            })
        });
        let row_sum = |row: &[DoubleDouble; 4]| row[..3].iter().map(|e| e.to_f64().abs()).sum();
        let largest_row = entries.iter().map(row_sum).fold(0.0, f64::max);
        if Self::is_exact(ladder, &entries) {
            return Self {
                rows,
                largest_row,
                direction_error: 0.0,
                offset_error: 0.0,
            };
        }
        let bound = |entries: &[DoubleDouble]| -> f64 {
            entries
                .iter()
                .map(|e| unit * e.to_f64().abs() + own(e))
                .sum()
        };
        let largest =
            |f: &dyn Fn(&[DoubleDouble; 4]) -> f64| entries.iter().map(f).fold(0.0, f64::max);
        Self {
            rows,
            largest_row,
            direction_error: largest(&|row| bound(&row[..3])),
            offset_error: largest(&|row| bound(&row[3..])),
        }
    }
}
