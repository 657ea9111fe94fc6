//! A shape placed in the world, and a ray's first hit with it.

use std::cmp::Ordering;

use super::ladder::{Ladder, ScaledRay};
use super::line::Crossing;
use super::list::{FirstCrossing, Limits};
use super::surd::Surd;
use super::value;
use super::{Hit, Query, Ray, ShapeKind, Start, Tally, Tier};
use crate::math::affine::Affine;
use crate::math::number::{Bounded, Number};

/// The matrix maps space onto a plane, a line or a point, or has entries that are not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the transform is not invertible")]
pub struct SingularMatrix;

/// A canonical shape under an invertible affine map; the map's f64 entries are exact by
/// definition, and its inverse is known to every precision.
#[derive(Debug, Clone)]
pub struct Placed {
    pub kind: ShapeKind,
    pub to_world: Affine,
    /// The map between world and object in each arithmetic.
    pub ladder: Ladder,
}

impl Placed {
    /// Places the shape; whether the matrix is singular is decided exactly.
    ///
    /// # Errors
    /// [`SingularMatrix`] where it is, or where an entry is not finite.
    pub fn new(kind: ShapeKind, to_world: &Affine) -> Result<Self, SingularMatrix> {
        Ok(Self {
            kind,
            to_world: *to_world,
            ladder: Ladder::new(to_world)?,
        })
    }

    /// The first crossing of the ray with the surface, entering or leaving, with t > `t_min`, or
    /// t ≥ 0 where `t_min` is 0. `None` also for a ray that is not valid and for a t beyond f64.
    ///
    /// A line that only touches a closed set hits it, except that flat shapes are missed by lines
    /// in their own plane.
    pub fn first_hit(&self, ray: &Ray, t_min: f64, start: Start, tally: &mut Tally) -> Option<Hit> {
        let query = Query {
            ray: *ray,
            t_min,
            t_max: f64::INFINITY,
        };
        let (ray, limits) = query.scaled()?;
        let (crossing, tier) = self.first_crossing(&ray, &limits, start, tally)?;
        self.hit(&crossing, &ray, tier)
    }

    pub(super) fn first_crossing(
        &self,
        ray: &ScaledRay,
        limits: &Limits,
        start: Start,
        tally: &mut Tally,
    ) -> Option<(Crossing, Tier)> {
        let met = match start {
            Start::Free => true,
            Start::OnSurfaceInward => !self.kind.is_flat(),
            Start::Excluded => false,
        };
        if !met {
            return None;
        }
        let question = FirstCrossing {
            kind: self.kind,
            ray,
            limits,
            start,
        };
        let (crossing, tier) = self.ladder.climb(ray, &question)?;
        tally.count(Some(tier));
        Some((crossing?, tier))
    }

    /// The hit at a decided crossing, in double-double, or exactly where that is not sharp enough.
    pub fn hit(&self, crossing: &Crossing, ray: &ScaledRay, tier: Tier) -> Option<Hit> {
        let hit = value::hit(crossing, &self.ladder.double_double, ray, tier)
            .or_else(|| value::hit(crossing, &self.ladder.exact, ray, tier))?;
        (hit.t.is_finite() && hit.point.is_finite()).then_some(hit)
    }

    /// An enclosure of the crossing's t in f64, in units of the scaled direction.
    pub(super) fn enclosure(&self, crossing: &Crossing, ray: &ScaledRay) -> Bounded {
        value::parameter(crossing, &self.ladder.double.local(ray))
    }

    /// Which of two crossings on the same ray comes first, by sharper numbers than f64.
    pub(super) fn order(crossings: [(&Self, &Crossing); 2], ray: &ScaledRay) -> (Ordering, Tier) {
        let [a, b] = crossings.map(|(object, crossing)| {
            value::parameter(crossing, &object.ladder.double_double.local(ray))
        });
        if let Some(order) = a.minus(&b).sign() {
            return (order, Tier::DoubleDouble);
        }
        let [a, b] =
            crossings.map(|(object, crossing)| Surd::of(crossing, &object.ladder.exact.local(ray)));
        (a.compare(&b), Tier::Exact)
    }
}
