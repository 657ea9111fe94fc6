//! The ladder of precisions: a question is asked in f64, then in double-double, then exactly; the
//! first tier that can tell answers.

use std::cmp::Ordering;

use super::line::LocalRay;
use super::placed::SingularMatrix;
use super::{Ray, Tier};
use crate::math::affine::Affine;
use crate::math::double_double::DoubleDouble;
use crate::math::exact::Exact;
use crate::math::number::{Bounded, Number, binary_exponent, dot};

/// A question about a line in an object's coordinates, answered by signs of numbers.
pub trait Question {
    type Answer;
    /// The answer, or `None` where this kind of number cannot tell; exact numbers always can.
    fn ask<N: Number>(&self, ray: &LocalRay<N>) -> Option<Self::Answer>;
}

/// The world → object map of one kind of number: adjugate, translation and |determinant| of the
/// placing matrix, all with the sign that makes the determinant positive.
#[derive(Debug, Clone)]
pub struct Frame<N> {
    /// Adjugate of the linear part, times the determinant's sign and a common power of two.
    pub adjugate: [[N; 3]; 3],
    pub translation: [N; 3],
    /// |determinant|, times the same power of two.
    pub scale: N,
}

/// A world ray, its direction brought near length 1 by a power of two.
#[derive(Debug, Clone, Copy)]
pub struct ScaledRay {
    ray: Ray,
    /// The power of two by which the direction was divided.
    pub exponent: i32,
}

impl ScaledRay {
    pub fn new(ray: &Ray) -> Self {
        Self {
            ray: *ray,
            exponent: binary_exponent(ray.direction.abs().max_element()),
        }
    }

    /// Converts t to units of the scaled direction.
    pub fn scaled_t<N: Number>(&self, t: f64) -> N {
        N::scaled(t, self.exponent)
    }

    pub fn origin<N: Number>(&self) -> [N; 3] {
        self.ray.origin.to_array().map(N::of)
    }

    pub fn direction<N: Number>(&self) -> [N; 3] {
        let components = self.ray.direction.to_array();
        components.map(|x| N::scaled(x, -self.exponent))
    }
}

impl<N: Number> Frame<N> {
    fn enclosing(exact: &Frame<Exact>) -> Self {
        Self {
            adjugate: exact
                .adjugate
                .each_ref()
                .map(|row| row.each_ref().map(N::enclosing)),
            translation: exact.translation.each_ref().map(N::enclosing),
            scale: N::enclosing(&exact.scale),
        }
    }

    pub fn inverse(&self) -> [[N; 4]; 3] {
        self.adjugate.each_ref().map(|row| {
            let entry = |j: usize| row[j].divided_by(&self.scale);
            let shift = dot(row, &self.translation).negated();
            [entry(0), entry(1), entry(2), shift.divided_by(&self.scale)]
        })
    }

    /// The ray in the object's homogeneous coordinates.
    pub fn local(&self, ray: &ScaledRay) -> LocalRay<N> {
        let origin: [N; 3] = ray.origin();
        let direction: [N; 3] = ray.direction();
        let from = [0, 1, 2].map(|i| origin[i].minus(&self.translation[i]));
        LocalRay {
            origin: self.adjugate.each_ref().map(|row| dot(row, &from)),
            direction: self.adjugate.each_ref().map(|row| dot(row, &direction)),
            scale: self.scale.clone(),
        }
    }
}

impl Frame<Exact> {
    /// Adjugate and determinant by cofactors, exactly.
    fn of_matrix(matrix: &Affine) -> Result<Self, SingularMatrix> {
        if !matrix.rows.iter().flatten().all(|x| x.is_finite()) {
            return Err(SingularMatrix);
        }
        let m = matrix.rows.map(|row| row.map(Exact::of));
        // Cofactor (i, j) with cyclic indices needs no sign.
        let cofactor = |i: usize, j: usize| {
            let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            m[i1][j1]
                .times(&m[i2][j2])
                .minus(&m[i1][j2].times(&m[i2][j1]))
        };
        let adjugate = [0, 1, 2].map(|j| [0, 1, 2].map(|i| cofactor(i, j)));
        let column = [0, 1, 2].map(|i| m[i][0].clone());
        let determinant = dot(&adjugate[0], &column);
        let mirrored = match determinant.sign() {
            Some(Ordering::Equal) | None => return Err(SingularMatrix),
            Some(sign) => sign == Ordering::Less,
        };
        // The common factor keeps the rounded frames' numbers far from under- and overflow.
        let largest = adjugate.iter().flatten().filter_map(Exact::magnitude).max();
        let shift = -largest.unwrap_or(0);
        let placed = |x: &Exact| x.negated_if(mirrored).shifted(shift);
        Ok(Self {
            adjugate: adjugate.each_ref().map(|row| row.each_ref().map(placed)),
            translation: [0, 1, 2].map(|i| m[i][3].clone()),
            scale: placed(&determinant),
        })
    }
}

#[derive(Debug, Clone)]
pub struct Ladder {
    pub double: Frame<Bounded>,
    pub double_double: Frame<DoubleDouble>,
    pub exact: Frame<Exact>,
}

impl Ladder {
    pub fn new(matrix: &Affine) -> Result<Self, SingularMatrix> {
        let exact = Frame::of_matrix(matrix)?;
        Ok(Self {
            double: Frame::enclosing(&exact),
            double_double: Frame::enclosing(&exact),
            exact,
        })
    }

    /// World → canonical coordinates, every entry computed in double-double and rounded once.
    pub fn inverse(&self) -> Affine {
        let entries = self.double_double.inverse();
        Affine {
            rows: entries.map(|row| row.map(|entry| entry.to_f64())),
        }
    }

    /// The first answer on the way up, and the tier that gave it. Exact numbers always answer, so that
    /// it is never `None`; callers would read that as "no crossing".
    pub fn climb<Q: Question>(&self, ray: &ScaledRay, question: &Q) -> Option<(Q::Answer, Tier)> {
        if let Some(answer) = question.ask(&self.double.local(ray)) {
            return Some((answer, Tier::Double));
        }
        if let Some(answer) = question.ask(&self.double_double.local(ray)) {
            return Some((answer, Tier::DoubleDouble));
        }
        let answer = question.ask(&self.exact.local(ray))?;
        Some((answer, Tier::Exact))
    }
}
