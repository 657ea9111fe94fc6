//! Where rays enter and leave shapes.

use etalon_lanes::math::instructions::{Instructions, Job, Precision};
use etalon_lanes::math::lanes::{Lanes, Mask, Scalar};
use etalon_lanes::math::number::Number;
use etalon_lanes::math::vec3::Vec3;
use etalon_lanes::shape::implicit::certified::Certified;
use etalon_lanes::shape::ladder::{Question, ScaledRay};
use etalon_lanes::shape::lanes::implicit::{LaneImplicit, StartSign};
use etalon_lanes::shape::lanes::{Enclosure, LaneRay, LaneShape};
use etalon_lanes::shape::line::{LocalRay, Span};
use etalon_lanes::shape::{Hit, Placed, Ray, ShapeKind};

use crate::columns::{jobs, load_rays, vector};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RaySpan {
    /// The ray as it was rounded.
    pub ray: Ray,
    /// Bounds of the entry and of the exit.
    pub near: [f64; 2],
    pub far: [f64; 2],
    /// Whether the shape is surely met.
    pub hit: bool,
    /// Whether it is surely missed.
    pub miss: bool,
}

jobs! {
    /// Spans of rays, each with its shape.
    spans<'a>(l: L, cases: &'a [(&'a Placed, Ray)]) -> Vec<RaySpan> {
        let mut spans = Vec::with_capacity(cases.len());
        for (placed, ray) in cases {
            let (kind, inverse) = (Some(placed.kind), placed.ladder.inverse());
            let reach = ray.origin.abs().max_element();
            let shape = LaneShape::new(kind, &placed.to_world, &inverse, reach);
            let (origin, direction) = (Vec3::splat(l, ray.origin), Vec3::splat(l, ray.direction));
            let ray = LaneRay::<L>::new(l, origin, direction);
            let span = shape.span(l, &ray, l.mask(true), l.real(f64::INFINITY));
            let ends = |e: Enclosure<L>| [e.low, e.high].map(|x| l.lane(x, 0).to_f64());
            spans.push(RaySpan {
                ray: Ray {
                    origin: vector(l, origin, 0),
                    direction: vector(l, direction, 0),
                },
                near: ends(span.near),
                far: ends(span.far),
                hit: span.hit.any(),
                miss: span.miss.any(),
            });
        }
        spans
    }
}

/// How many rays meet a sign change of an implicit surface's field.
pub fn sign_changes(set: Instructions, surface: &LaneImplicit<f64>, rays: &[Ray]) -> u32 {
    set.run(SignChanges { surface, rays })
}

struct SignChanges<'a> {
    surface: &'a LaneImplicit<f64>,
    rays: &'a [Ray],
}

impl Job<f64> for SignChanges<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes<Scalar = f64>>(self, l: L) -> u32 {
        let start = StartSign::<L> {
            on: l.mask(false),
            inward: l.mask(false),
        };
        let mut found = 0;
        for rays in self.rays.chunks(L::COUNT) {
            let ray = load_rays(l, rays.iter().copied());
            let active = l.mask_from_bits(u32::MAX >> (u32::BITS as usize - rays.len()));
            let (_, hit) = self.surface.first_change(l, &ray, start, active);
            found += hit.bits().count_ones();
        }
        found
    }
}

/// The question where the whole line enters and leaves a shape.
pub struct Through(pub ShapeKind);

impl Question for Through {
    type Answer = Option<Span>;

    fn ask<N: Number>(&self, ray: &LocalRay<N>) -> Option<Option<Span>> {
        self.0.span(ray)
    }
}

/// Both crossings of the whole line, at whatever t; the same one twice for flat shapes.
pub fn crossings(placed: &Placed, ray: &Ray) -> Option<[Hit; 2]> {
    if !ray.is_valid() {
        return None;
    }
    let ray = ScaledRay::new(ray);
    let (span, tier) = placed.ladder.climb(&ray, &Through(placed.kind))?;
    let Span { near, far } = span?;
    Some([
        placed.hit(&near, &ray, tier)?,
        placed.hit(&far, &ray, tier)?,
    ])
}

/// A finder with the bounds of rounding errors left out: to show that they are needed.
pub fn without_bounds(mut finder: Certified) -> Certified {
    for factor in &mut finder.factors {
        factor.accounted = 0.0;
        for bounds in &mut factor.bounds {
            (bounds.error, bounds.change) = (0.0, 0.0);
        }
    }
    finder
}
