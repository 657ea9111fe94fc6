//! A line in an object's homogeneous coordinates, its crossings with planes and quadrics, and
//! their order along the line.

use std::cmp::Ordering;

use crate::math::number::{Number, dot};

/// The line (origin + t direction) / scale in canonical coordinates, with scale > 0: the adjugate
/// of the placing matrix takes the place of its inverse, and its determinant is `scale`.
#[derive(Debug, Clone)]
pub struct LocalRay<N> {
    /// Adjugate · (world origin − translation).
    pub origin: [N; 3],
    /// Adjugate · world direction.
    pub direction: [N; 3],
    pub scale: N,
}

#[derive(Debug, Clone)]
pub struct Fraction<N> {
    pub numerator: N,
    /// The denominator d, positive.
    pub denominator: N,
}

impl<N: Number> Fraction<N> {
    pub fn whole(x: N) -> Self {
        Self {
            numerator: x,
            denominator: N::of(1.0),
        }
    }

    /// self ⋚ other, by the sign of n₁d₂ − n₂d₁.
    pub fn compare(&self, other: &Self) -> Option<Ordering> {
        self.numerator
            .times(&other.denominator)
            .minus(&other.numerator.times(&self.denominator))
            .sign()
    }
}

/// The part of a surface that a line crosses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// x² + y² + z² = 1 for 3 dimensions, x² + y² = 1 for 2.
    Round {
        /// Number of coordinates in the sum.
        dimensions: usize,
    },
    /// The coordinate `axis` is +1 (`positive`) or −1.
    Face {
        axis: usize,
        /// The sign of the coordinate, and of the outward normal.
        positive: bool,
    },
    /// z = 0 with +z as its outward side.
    Flat,
}

/// Which crossing of the line with a surface; what it needs to be computed at any precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crossing {
    pub feature: Feature,
    /// Whether the line goes along the outward normal here: the larger root of a quadric.
    pub leaving: bool,
}

/// Where a line enters and leaves a convex shape; the same crossing twice for flat ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    pub near: Crossing,
    pub far: Crossing,
}

/// a t² + 2 b t + c, the radial form of a quadric along the line, with disc = b² − a c.
#[derive(Debug, Clone)]
pub struct Quadratic<N> {
    /// Square of the direction.
    pub a: N,
    /// Origin · direction.
    pub b: N,
    /// Square of the origin − scale².
    pub c: N,
    pub discriminant: N,
}

impl<N: Number> LocalRay<N> {
    /// b² − a c = a scale² − |origin × direction|² (Lagrange's identity): its error grows with the
    /// distance of the origin only linearly, where b² − a c has the square of it (Haines, Günther,
    /// Akenine-Möller 2019, Ray Tracing Gems, ch. 7, for the reason).
    pub fn discriminant(&self, dimensions: usize, a: &N) -> N {
        let (o, d) = (&self.origin, &self.direction);
        let minor = |i: usize, j: usize| o[i].times(&d[j]).minus(&o[j].times(&d[i])).squared();
        let mut moment = minor(0, 1);
        if dimensions == 3 {
            moment = moment.plus(&minor(1, 2)).plus(&minor(2, 0));
        }
        a.times(&self.scale.squared()).minus(&moment)
    }

    /// The coefficients of the quadric |x|² − scale² over the first `dimensions` coordinates.
    pub fn quadratic(&self, dimensions: usize) -> Quadratic<N> {
        let (o, d) = (&self.origin[..dimensions], &self.direction[..dimensions]);
        let a = dot(d, d);
        Quadratic {
            b: dot(o, d),
            c: dot(o, o).minus(&self.scale.squared()),
            discriminant: self.discriminant(dimensions, &a),
            a,
        }
    }

    /// Coordinate `axis` of the point at t, times scale · t.denominator.
    pub fn coordinate(&self, axis: usize, t: &Fraction<N>) -> N {
        self.origin[axis]
            .times(&t.denominator)
            .plus(&self.direction[axis].times(&t.numerator))
    }

    /// The radial form at t, and half its derivative, both with a positive factor.
    pub fn radial(&self, dimensions: usize, t: &Fraction<N>) -> (N, N) {
        let reach = self.scale.times(&t.denominator).squared();
        let x = [0, 1, 2].map(|axis| self.coordinate(axis, t));
        let x = &x[..dimensions];
        (
            dot(x, x).minus(&reach),
            dot(x, &self.direction[..dimensions]),
        )
    }

    /// |coordinate `axis` at t| ≤ 1?
    pub fn within(&self, axis: usize, t: &Fraction<N>) -> Option<bool> {
        let x = self.coordinate(axis, t);
        let reach = self.scale.times(&t.denominator);
        let above = reach.minus(&x).sign();
        let below = reach.plus(&x).sign();
        if above == Some(Ordering::Less) || below == Some(Ordering::Less) {
            return Some(false);
        }
        above.and(below).map(|_| true)
    }

    /// t where the line crosses the plane of a face or the plane z = 0.
    pub fn plane(&self, axis: usize, offset: Option<bool>, upward: bool) -> Fraction<N> {
        let distance = match offset {
            Some(positive) => self.scale.negated_if(!positive).minus(&self.origin[axis]),
            None => self.origin[axis].negated(),
        };
        Fraction {
            numerator: distance.negated_if(!upward),
            denominator: self.direction[axis].negated_if(!upward),
        }
    }
}

impl Crossing {
    /// The crossing with a face of outward normal ±`axis`.
    pub fn face(axis: usize, positive: bool, leaving: bool) -> Self {
        Self {
            feature: Feature::Face { axis, positive },
            leaving,
        }
    }

    /// The crossing with the first `dimensions` coordinates' unit quadric.
    pub fn round(dimensions: usize, leaving: bool) -> Self {
        Self {
            feature: Feature::Round { dimensions },
            leaving,
        }
    }

    /// t as a fraction, for planes; for quadrics, the number of coordinates in their sum.
    pub fn fraction<N: Number>(&self, ray: &LocalRay<N>) -> Result<Fraction<N>, usize> {
        match self.feature {
            Feature::Round { dimensions } => Err(dimensions),
            // The direction goes up the axis where it leaves by a positive face or enters by a
            // negative one.
            Feature::Face { axis, positive } => {
                Ok(ray.plane(axis, Some(positive), positive == self.leaving))
            }
            Feature::Flat => Ok(ray.plane(2, None, self.leaving)),
        }
    }

    /// Whether this crossing comes before, at or after t. A quadric's is known to exist.
    pub fn compare<N: Number>(&self, ray: &LocalRay<N>, t: &Fraction<N>) -> Option<Ordering> {
        match self.fraction(ray) {
            Ok(own) => own.compare(t),
            Err(dimensions) => {
                let (form, slope) = ray.radial(dimensions, t);
                root_against(form.sign(), slope.sign(), self.leaving)
            }
        }
    }
}

/// Where the smaller (larger, if `leaving`) root of a convex quadratic lies, seen from an argument
/// at which its value and slope have these signs: `Less` means before the argument.
fn root_against(
    form: Option<Ordering>,
    slope: Option<Ordering>,
    leaving: bool,
) -> Option<Ordering> {
    use Ordering::{Equal, Greater, Less};
    match (form, slope, leaving) {
        // Past the vertex the smaller root lies behind, before it the larger one ahead.
        (_, Some(Greater), false) => Some(Less),
        (_, Some(Less), true) => Some(Greater),
        (Some(Less), _, false) => Some(Less),
        (Some(Less), _, true) => Some(Greater),
        (Some(Equal), Some(_), _) => Some(Equal),
        (Some(Greater), Some(Less), false) => Some(Greater),
        (Some(Greater), Some(Greater), true) => Some(Less),
        // At the vertex with a positive value there are no roots: not asked.
        _ => None,
    }
}
