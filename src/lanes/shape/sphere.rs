//! The sphere x² + y² + z² = 1.

use std::cmp::Ordering;

use glam::DVec3;

use super::kind::{Canonical, Emitter, LaneQuestion, Length};
use super::lanes::part::{Part, PartKind};
use super::lanes::{Enclosure, LaneRay, LaneShape, LaneSpan, LaneSurface};
use super::line::{Crossing, LocalRay, Span};
use crate::math::affine::Affine;
use crate::math::lanes::{Lanes, Mask, Real, Scalar};
use crate::math::number::{Number, dot};
use crate::math::vec3::Vec3;

/// x² + y² + z² = 1.
pub struct Sphere;

impl Canonical for Sphere {
    const NAME: &'static str = "sphere";
    const LENGTHS: &'static [Length] = &[Length::radius(&[0, 1, 2])];
    const CENTERED: bool = true;
    const EMITTER: Emitter = Emitter::Sphere;
    const ROUND: Option<usize> = Some(3);

    fn half_range(along: DVec3) -> f64 {
        along.length()
    }

    /// The line meets the sphere if the discriminant of its radial form is not negative.
    fn span<N: Number>(ray: &LocalRay<N>) -> Option<Option<Span>> {
        let a = dot(&ray.direction, &ray.direction);
        let meets = ray.discriminant(3, &a).sign()? != Ordering::Less;
        Some(meets.then(|| Span {
            near: Crossing::round(3, false),
            far: Crossing::round(3, true),
        }))
    }

    #[inline(always)]
    fn lane_span<L: Lanes>(l: L, question: &LaneQuestion<'_, L>) -> LaneSpan<L> {
        let LaneQuestion {
            shape,
            ray,
            asked,
            limit,
        } = *question;
        match &shape.ball {
            Some(ball) => {
                let value = inlined!(|x: &L::Scalar| l.splat(*x));
                ball_span(l, ball, value, ray, asked, limit)
            }
            None => ellipsoid_span(l, shape, ray),
        }
    }

    fn parts<T: Scalar>(shape: &LaneShape<T>) -> Vec<Part<T>> {
        vec![shape.ball().map_or_else(Part::other, |ball| Part {
            kind: PartKind::Ball,
            vector: ball.centre,
            level: ball.radius,
            half: T::default(),
        })]
    }

    /// The canonical point scaled to length 1, which is also the canonical normal.
    #[inline(always)]
    fn surface<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, p: Vec3<L::Real>) -> LaneSurface<L> {
        let local = shape.inverse.point(l, p).normalized(l);
        LaneSurface {
            point: shape.forward.point(l, local),
            normal: shape.inverse.transposed(l, local).normalized(l),
        }
    }
}

/// A sphere whose placement only scales it alike along all axes and moves it; or several, each number
/// a column with a place for each of them.
#[derive(Debug, Clone, Copy)]
pub struct Ball<T> {
    pub centre: [T; 3],
    pub radius: T,
    pub radius_squared: T,
    /// 6u (|c| + r): what the centre's rounding and the ray's cost beside 6u max|o|.
    pub offset_error: T,
    /// 8/r.
    pub curvature: T,
    /// Largest max|o| for which the two bounds below hold.
    pub reach: T,
    /// Squared distance from the centre beyond which a line surely passes.
    pub clear_squared: T,
    /// Distance along the ray from its foot beyond which it is surely not near.
    pub clear: T,
}

impl<T: Scalar> Ball<T> {
    /// The ball that the map makes of the unit sphere, if it does; `reach` is the largest magnitude of
    /// a coordinate among the points that rays usually start from.
    pub fn new(forward: &Affine, reach: f64) -> Option<Self> {
        let [x, y, z] = &forward.rows;
        let radius = x[0].abs();
        let straight = [x[1], x[2], y[0], y[2], z[0], z[1]]
            .iter()
            .all(|m| *m == 0.0);
        if !straight || y[1].abs() != radius || z[2].abs() != radius {
            return None;
        }
        let largest = x[3].abs().max(y[3].abs()).max(z[3].abs());
        let unit = 6.5 * T::ROUNDOFF;
        // The largest e of `ball_span`, with |t₀| ≤ |o − c|, and twice that for its evaluation.
        let e = 2.0 * unit * (3.0 * (reach + largest) + radius);
        let relative = 8.0 * e / radius + 10.0 * T::ROUNDOFF;
        // c < −c_error wherever |f|² (1 − relative) > r² + 16e².
        let clear_squared = if relative < 0.5 {
            (radius * radius + 16.0 * e * e) / (1.0 - relative)
        } else {
            f64::INFINITY
        };
        Some(Self {
            reach: T::from_f64(reach),
            // Eight unit roundoffs pay for this number's own rounding.
            clear_squared: T::from_f64(clear_squared * (1.0 + 8.0 * T::ROUNDOFF)),
            clear: T::from_f64(radius * (1.0 + 60.0 * T::ROUNDOFF) + 6.0 * e),
            centre: [x[3], y[3], z[3]].map(T::from_f64),
            radius: T::from_f64(radius),
            radius_squared: T::from_f64(radius * radius),
            offset_error: T::from_f64(unit * (largest + radius)),
            curvature: T::from_f64(8.0 / radius),
        })
    }
}

/// Where lines meet the unit sphere, or the unit circle seen along a cylinder's axis, by the
/// discriminant from the foot of the perpendicular (Haines, Günther and Akenine-Möller,
/// "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7, 2019), in
/// canonical coordinates: its parameter and squared distance, 1/|d|, and the errors E and D.
///
/// Let e = E + |t₀| D with t₀ the foot's parameter, and q = D/|d|, the relative error of the
/// direction, below ⅛. The foot f moves across the ray by δo + t₀ δd, at most √3 e; and along it,
/// because turning the ray moves the foot of a line that passes the centre at distance |f|, by at
/// most 4e + 3q|f| (√3/(1 − √3/8)² = 2.8), which enters |f|² only squared and, by f · δd, once
/// more times q: so |f|² is within (8e + 8u + 64q²) max(1, |f|²) + 16 e² of its exact value. Where
/// q ≥ ⅛ that is more than 1 and more than |f|², and nothing is decided.
#[inline(always)]
pub fn round_span<L: Lanes>(
    l: L,
    foot_t: L::Real,
    squared: L::Real,
    inverse_length: L::Real,
    (e0, dd): (L::Real, L::Real),
) -> LaneSpan<L> {
    let u = <L::Scalar as Scalar>::ROUNDOFF;
    let c = l.real(1.0) - squared;
    let e = foot_t.abs().mul_add(dd, e0);
    let q = dd * inverse_length;
    let relative = (q * q).mul_add(l.real(64.0), e.mul_add(l.real(8.0), l.real(8.0 * u)));
    let c_error = (e * e).mul_add(l.real(16.0), relative * squared.max(l.real(1.0)));
    let root = c.max(l.real(0.0)).sqrt();
    let half = root * inverse_length;
    // δt₀ ≤ (4e + 3q|f|)/|d|, δ√c ≤ δc/√c when c > δc, and 1/|d| is off by 3q of itself, where
    // |f| and √c are below 1; then rounding.
    let along = q.mul_add(l.real(6.0), e * l.real(4.0));
    let error =
        (c_error / root + along).mul_add(inverse_length, (foot_t.abs() + half) * l.real(9.0 * u));
    LaneSpan {
        near: Enclosure::about(foot_t - half, error),
        far: Enclosure::about(foot_t + half, error),
        hit: c.gt(c_error),
        miss: c.lt(-c_error),
        parts: [l.int(0); 2],
    }
}

#[inline(always)]
fn ellipsoid_span<L: Lanes>(l: L, shape: &LaneShape<L::Scalar>, ray: &LaneRay<L>) -> LaneSpan<L> {
    let o = shape.inverse.point(l, ray.origin);
    let d = shape.inverse.vector(l, ray.direction);
    let inverse_square = l.real(1.0) / d.length_squared();
    let foot_t = -(o.dot(d) * inverse_square);
    let squared = o.along(d, foot_t).length_squared();
    let errors = shape.largest_errors(l, ray, 3);
    round_span(l, foot_t, squared, inverse_square.sqrt(), errors)
}

/// The same about the centre in world units, for balls of which `value` takes each lane's number from
/// a column.
///
/// Packets that surely pass the ball, leave it behind or end before it are let go by bounds that
/// hold for all usual rays.
#[inline(always)]
pub fn ball_span<L: Lanes, C>(
    l: L,
    ball: &Ball<C>,
    value: impl Fn(&C) -> L::Real + Copy,
    ray: &LaneRay<L>,
    asked: L::Mask,
    limit: L::Real,
) -> LaneSpan<L> {
    let foot = Foot::new(ball, value, ray);
    let apart = foot.is_apart(ball, value, limit) & ray.extent.le(value(&ball.reach));
    if (asked & !apart).any() {
        let span = foot.span(l, ball, value, ray);
        return LaneSpan {
            miss: span.miss | apart,
            hit: span.hit & !apart,
            ..span
        };
    }
    let nowhere = Enclosure::about(foot.t, l.real(0.0));
    LaneSpan {
        near: nowhere,
        far: nowhere,
        hit: l.mask(false),
        miss: apart,
        parts: [l.int(0); 2],
    }
}

/// The point of a line that is closest to a ball's centre.
pub struct Foot<L: Lanes> {
    t: L::Real,
    squared: L::Real,
}

impl<L: Lanes> Foot<L> {
    #[inline(always)]
    pub fn new<C>(ball: &Ball<C>, value: impl Fn(&C) -> L::Real + Copy, ray: &LaneRay<L>) -> Self {
        let [x, y, z] = &ball.centre;
        let o = ray.origin - Vec3::new(value(x), value(y), value(z));
        let t = -(o.dot(ray.direction) * ray.inverse_square);
        let squared = o.along(ray.direction, t).length_squared();
        Self { t, squared }
    }

    /// Whether the ray surely passes the ball, leaves it behind or ends before it, if it starts
    /// within the ball's reach.
    #[inline(always)]
    fn is_apart<C>(
        &self,
        ball: &Ball<C>,
        value: impl Fn(&C) -> L::Real + Copy,
        limit: L::Real,
    ) -> L::Mask {
        let clear = value(&ball.clear);
        self.squared.gt(value(&ball.clear_squared)) | self.t.lt(-clear) | self.t.gt(limit + clear)
    }

    /// Where the line meets the ball. Canonical coordinates would be those about the centre over r,
    /// so that the bounds of `ellipsoid_span`, times r or r², hold with E r = 6u (max|o| + |c| + r),
    /// D r = 6u, and q = D r, where 64q² is less than u.
    #[inline(always)]
    pub fn span<C>(
        &self,
        l: L,
        ball: &Ball<C>,
        value: impl Fn(&C) -> L::Real + Copy,
        ray: &LaneRay<L>,
    ) -> LaneSpan<L> {
        let u = <L::Scalar as Scalar>::ROUNDOFF;
        let Self { t, squared } = *self;
        let radius_squared = value(&ball.radius_squared);
        let c = radius_squared - squared;
        let unit = l.real(6.5 * u);
        let e = (t.abs() + ray.extent).mul_add(unit, value(&ball.offset_error));
        let relative = e.mul_add(value(&ball.curvature), l.real(9.0 * u));
        let c_error = (e * e).mul_add(l.real(16.0), relative * squared.max(radius_squared));
        let half = (c.max(l.real(0.0)) * ray.inverse_square).sqrt();
        let along = value(&ball.radius).mul_add(l.real(40.0 * u), e * l.real(4.0));
        let error = (t.abs() + half).mul_add(l.real(9.0 * u), c_error / half + along);
        LaneSpan {
            near: Enclosure::about(t - half, error),
            far: Enclosure::about(t + half, error),
            hit: c.gt(c_error),
            miss: c.lt(-c_error),
            parts: [l.int(0); 2],
        }
    }
}
