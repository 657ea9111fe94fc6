//! The first rung: every shape in lanes, answering hit, miss or undecided.
//!
//! A ray is taken to canonical coordinates by the rounded inverse matrix. With unit roundoff u,
//! row sums Rᵢ = Σⱼ|mᵢⱼ| and s = max|o|, component i of the computed local origin is within
//! Eᵢ = 6u (Rᵢ s + |bᵢ| + 1) and that of the local direction within Dᵢ = 6u Rᵢ of the exact one
//! (four rounded coefficients and three fused operations each; the 1 pays for the shape's own
//! constants). What follows from E and D is bounded shape by shape; a lane that a bound cannot
//! decide is left to the certified ladder.

mod cube;
mod cylinder;
mod flat;
mod sphere;

use crate::math::affine::Affine;
use crate::math::lanes::{Lanes, Real, Scalar};
use crate::math::vec3::{Rows, Vec3};
use crate::shape::ShapeKind;

pub mod balls;
pub mod implicit;
pub mod part;

/// Rays of a packet; directions are unit up to rounding.
#[derive(Clone, Copy)]
pub struct LaneRay<L: Lanes> {
    /// Origins, scene units about the camera.
    pub origin: Vec3<L::Real>,
    /// Directions.
    pub direction: Vec3<L::Real>,
    /// Largest magnitude of an origin's coordinates.
    pub extent: L::Real,
    /// 1/|direction|².
    pub inverse_square: L::Real,
}

impl<L: Lanes> LaneRay<L> {
    /// A ray with its extent.
    #[inline(always)]
    pub fn new(l: L, origin: Vec3<L::Real>, direction: Vec3<L::Real>) -> Self {
        Self {
            origin,
            direction,
            extent: origin.max_abs(),
            inverse_square: l.real(1.0) / direction.length_squared(),
        }
    }
}

/// An interval that holds a number.
#[derive(Clone, Copy)]
pub struct Enclosure<L: Lanes> {
    /// Lower end.
    pub low: L::Real,
    /// Upper end.
    pub high: L::Real,
}

impl<L: Lanes> Enclosure<L> {
    /// x within `error`.
    #[inline(always)]
    pub fn about(x: L::Real, error: L::Real) -> Self {
        Self {
            low: x - error,
            high: x + error,
        }
    }
}

/// Where a line enters and leaves a convex shape, with bounds.
#[derive(Clone, Copy)]
pub struct Span<L: Lanes> {
    /// Entry, where the line meets the shape.
    pub near: Enclosure<L>,
    /// Exit; that of flat shapes is the entry.
    pub far: Enclosure<L>,
    /// The line certainly meets the shape.
    pub hit: L::Mask,
    /// The line certainly misses it, or meets it only behind the origin or beyond the limit.
    pub miss: L::Mask,
    /// Which of the shape's parts it enters and leaves by, if it meets it.
    pub parts: [L::Int; 2],
}

/// A placed shape as lanes use it.
#[derive(Debug, Clone, Copy)]
pub struct LaneShape<T> {
    /// Which shape; implicit surfaces are intersected elsewhere and place nothing here.
    pub kind: Option<ShapeKind>,
    /// World (about the camera) → canonical coordinates.
    pub inverse: Rows<T>,
    /// Canonical coordinates → world.
    pub forward: Rows<T>,
    /// The planes of each canonical coordinate.
    planes: [Planes<T>; 3],
    /// 6u Rᵢ.
    pub direction_error: [T; 3],
    /// 6u (|bᵢ| + 1).
    pub offset_error: [T; 3],
    /// Bounds of a flat shape's plane test, see [`flat::margins`].
    margins: [T; 2],
    /// A sphere that is one in the world too.
    ball: Option<sphere::Ball<T>>,
}

impl<T: Scalar> LaneShape<T> {
    /// Rounds a placement whose inverse is given; `reach` is the largest magnitude of a coordinate
    /// among the points that rays usually start from.
    pub fn new(kind: Option<ShapeKind>, forward: &Affine, inverse: &Affine, reach: f64) -> Self {
        // One more half unit roundoff in the bounds pays for rounding the bounds themselves.
        let unit = 6.5 * T::ROUNDOFF;
        Self {
            kind,
            inverse: Rows::from_f64(&inverse.rows),
            forward: Rows::from_f64(&forward.rows),
            planes: inverse.rows.each_ref().map(Planes::new),
            direction_error: inverse
                .rows
                .map(|r| T::from_f64(unit * (r[0].abs() + r[1].abs() + r[2].abs()))),
            offset_error: inverse.rows.map(|r| T::from_f64(unit * (r[3].abs() + 1.0))),
            margins: flat::margins::<T>(inverse).map(T::from_f64),
            ball: sphere::Ball::new(forward, reach),
        }
    }

    /// Eᵢ for a packet of rays.
    #[inline(always)]
    fn origin_error<L: Lanes<Scalar = T>>(&self, l: L, ray: &LaneRay<L>, i: usize) -> L::Real {
        ray.extent.mul_add(
            l.splat(self.direction_error[i]),
            l.splat(self.offset_error[i]),
        )
    }

    /// The largest Eᵢ and Dᵢ of the first `count` components.
    #[inline(always)]
    fn largest_errors<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        ray: &LaneRay<L>,
        count: usize,
    ) -> (L::Real, L::Real) {
        let mut direction = self.direction_error[0];
        let mut offset = self.offset_error[0];
        for i in 1..count {
            direction = direction.larger(self.direction_error[i]);
            offset = offset.larger(self.offset_error[i]);
        }
        let direction = l.splat(direction);
        (ray.extent.mul_add(direction, l.splat(offset)), direction)
    }

    /// Where the lines of the lanes in `asked` meet the shape; what is said of others means nothing.
    /// A shape that lies beyond `limit` as a whole may be called missed.
    #[inline(always)]
    pub fn span<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        ray: &LaneRay<L>,
        asked: L::Mask,
        limit: L::Real,
    ) -> Span<L> {
        match self.kind {
            Some(ShapeKind::Sphere) => sphere::span(l, self, ray, asked, limit),
            Some(ShapeKind::Cube) => cube::span(l, self, ray, asked),
            Some(ShapeKind::Cylinder) => cylinder::span(l, self, ray, asked),
            Some(ShapeKind::Disk) => flat::span::<L, flat::Disk>(l, self, ray),
            Some(ShapeKind::Rectangle) => flat::span::<L, flat::Rectangle>(l, self, ray),
            Some(ShapeKind::Plane) => flat::span::<L, flat::Plane>(l, self, ray),
            None => Span {
                near: Enclosure::about(l.real(0.0), l.real(0.0)),
                far: Enclosure::about(l.real(0.0), l.real(0.0)),
                hit: l.mask(false),
                miss: l.mask(true),
                parts: [l.int(0); 2],
            },
        }
    }

    /// The ball that this shape is, if it is one.
    pub fn ball(&self) -> Option<&sphere::Ball<T>> {
        match self.kind {
            Some(ShapeKind::Sphere) => self.ball.as_ref(),
            _ => None,
        }
    }

    /// What a hit near the world point p looks like, for shapes whose part is
    /// [`part::PartKind::Other`].
    #[inline(always)]
    pub fn surface<L: Lanes<Scalar = T>>(&self, l: L, p: Vec3<L::Real>) -> LaneSurface<L> {
        match self.kind {
            Some(ShapeKind::Cylinder) => cylinder::surface(l, self, p),
            _ => sphere::surface(l, self, p),
        }
    }

    /// Canonical coordinates of a point on the surface: those that are constant on a face are
    /// exact, so that textures do not flicker between cells there.
    #[inline(always)]
    pub fn local<L: Lanes<Scalar = T>>(&self, l: L, point: Vec3<L::Real>) -> Vec3<L::Real> {
        let local = self.inverse.point(l, point);
        match self.kind {
            Some(ShapeKind::Disk | ShapeKind::Rectangle | ShapeKind::Plane) => {
                Vec3::new(local.x, local.y, l.real(0.0))
            }
            Some(ShapeKind::Cube) => cube::snapped(l, local),
            Some(ShapeKind::Cylinder) => cylinder::snapped(l, local),
            Some(ShapeKind::Sphere) | None => local,
        }
    }
}

/// A point moved onto a surface, and the unit outward normal there (+z of flat shapes).
#[derive(Clone, Copy)]
pub struct LaneSurface<L: Lanes> {
    /// The point, scene units about the camera.
    pub point: Vec3<L::Real>,
    /// The normal.
    pub normal: Vec3<L::Real>,
}

/// The parallel planes of one canonical coordinate: x = −1, 0, 1 are n · p = middle − half,
/// middle, middle + half.
#[derive(Debug, Clone, Copy)]
pub struct Planes<T> {
    normal: [T; 3],
    middle: T,
    half: T,
}

impl<T: Scalar> Planes<T> {
    /// From the row of the inverse that computes the coordinate.
    fn new(row: &[f64; 4]) -> Self {
        let [x, y, z, shift] = *row;
        let length = (x * x + y * y + z * z).sqrt();
        Self {
            normal: [x, y, z].map(|c| T::from_f64(c / length)),
            middle: T::from_f64(-shift / length),
            half: T::from_f64(1.0 / length),
        }
    }
}

/// Crossings of one slab |x| ≤ 1 of the local ray, with bounds.
#[derive(Clone, Copy)]
struct Slab<L: Lanes> {
    near: Enclosure<L>,
    far: Enclosure<L>,
    /// Lanes that may run along the slab, for which the bounds mean nothing.
    parallel: L::Mask,
}

/// Intersects the slab |o + t d| ≤ 1, where o is within `e` and d within `dd` of the exact values.
#[inline(always)]
fn slab<L: Lanes>(l: L, o: L::Real, d: L::Real, e: L::Real, dd: L::Real) -> Slab<L> {
    let one = l.real(1.0);
    let inverse = one / d;
    let t1 = (-one - o) * inverse;
    let t2 = (one - o) * inverse;
    let largest = t1.abs().max(t2.abs());
    // First order (e + |t| dd)/|d|, doubled for the rest while dd ≤ |d|/4; 5u for the arithmetic
    // up to the rounded ends.
    let error = (largest.mul_add(dd, e) * inverse.abs()).mul_add(
        l.real(2.0),
        largest * l.real(5.0 * <L::Scalar as Scalar>::ROUNDOFF),
    );
    Slab {
        near: Enclosure::about(t1.min(t2), error),
        far: Enclosure::about(t1.max(t2), error),
        parallel: !d.abs().gt(dd * l.real(4.0)),
    }
}

/// What position says of lines along a slab.
struct Along<L: Lanes> {
    /// Lanes for which it says nothing either.
    lost: L::Mask,
    /// The line runs outside of the slab.
    outside: L::Mask,
}

impl<L: Lanes> Slab<L> {
    /// Decides the parallel lanes by position, for all |t| ≤ `reach`, within which the line could hit
    /// anything else of the shape; inside, the slab is no limit to them.
    #[inline(always)]
    fn settle(
        &mut self,
        l: L,
        o: L::Real,
        d: L::Real,
        e: L::Real,
        dd: L::Real,
        reach: L::Real,
    ) -> Along<L> {
        let one = l.real(1.0);
        let drift = (d.abs() + dd).mul_add(reach, e) * l.real(1.0 + 1e-6);
        let inside = self.parallel & (o.abs() + drift).lt(one);
        let outside = self.parallel & (o.abs() - drift).gt(one);
        let far = l.real(f64::INFINITY);
        for end in [&mut self.near.low, &mut self.near.high] {
            *end = l.select(self.parallel, -far, *end);
        }
        for end in [&mut self.far.low, &mut self.far.high] {
            *end = l.select(self.parallel, far, *end);
        }
        Along {
            lost: self.parallel & !inside & !outside,
            outside,
        }
    }
}

/// Farthest |t| at which the line can be inside the canonical box: (|o|₁ + E + 1)/max(|dᵢ| − Dᵢ),
/// infinite where the direction could be zero for all that is known; 3 for 1 pays for rounding.
#[inline(always)]
fn reach<L: Lanes>(
    l: L,
    shape: &LaneShape<L::Scalar>,
    ray: &LaneRay<L>,
    o: Vec3<L::Real>,
    d: Vec3<L::Real>,
) -> L::Real {
    let (e, _) = shape.largest_errors(l, ray, 3);
    let sum = o.x.abs() + o.y.abs() + o.z.abs();
    let [dx, dy, dz] = shape.direction_error.map(
        #[inline(always)]
        |error| l.splat(error),
    );
    let slowest = (d.x.abs() - dx).max(d.y.abs() - dy).max(d.z.abs() - dz);
    (sum + (e + l.real(3.0))) / slowest.max(l.real(0.0))
}
