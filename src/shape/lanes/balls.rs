//! Several balls, which one ray asks together: lanes are balls.

use super::sphere::{Asked, Ball, ball_span};
use super::{LaneRay, LaneShape, Span};
use crate::math::lanes::{Lanes, Scalar};
use crate::math::vec3::Vec3;

/// Most balls of a group.
pub const MOST: usize = 16;

/// The numbers of up to [`MOST`] balls by column.
#[derive(Debug, Clone)]
pub struct Balls<T> {
    centre: [[T; MOST]; 3],
    radius: [T; MOST],
    radius_squared: [T; MOST],
    offset_error: [T; MOST],
    curvature: [T; MOST],
    reach: [T; MOST],
    clear_squared: [T; MOST],
    clear: [T; MOST],
    /// Which objects they are; places without a ball repeat the last one.
    pub objects: [u32; MOST],
    /// How many there are.
    pub count: usize,
}

impl<T: Scalar> Balls<T> {
    /// The balls that the given objects are; `None` where one is something else, or where they are
    /// none or too many.
    pub fn new(objects: &[u32], shapes: &[LaneShape<T>]) -> Option<Self> {
        if objects.len() > MOST {
            return None;
        }
        let last = objects.len().checked_sub(1)?;
        let ball_of = |object: u32| shapes.get(object as usize)?.ball();
        let balls: Vec<&Ball<T>> = objects.iter().map(|&o| ball_of(o)).collect::<Option<_>>()?;
        let column = |value: &dyn Fn(&Ball<T>) -> T| -> [T; MOST] {
            std::array::from_fn(|i| value(balls[i.min(last)]))
        };
        Some(Self {
            centre: [0, 1, 2].map(|axis| column(&|b| b.centre[axis])),
            radius: column(&|b| b.radius),
            radius_squared: column(&|b| b.radius_squared),
            offset_error: column(&|b| b.offset_error),
            curvature: column(&|b| b.curvature),
            reach: column(&|b| b.reach),
            clear_squared: column(&|b| b.clear_squared),
            clear: column(&|b| b.clear),
            objects: std::array::from_fn(|i| objects[i.min(last)]),
            count: objects.len(),
        })
    }

    /// Which of the places from `from` on, one a lane of at most [`MOST`], hold a ball.
    #[inline(always)]
    pub fn present<L: Lanes<Scalar = T>>(&self, l: L, from: usize) -> L::Mask {
        let first = |count: usize| ((1u64 << count) - 1) as u32;
        l.mask_from_bits((first(self.count) >> from) & first(L::COUNT))
    }

    /// Where the ray, the same in all lanes, meets the balls from place `from` on, one a lane, as
    /// [`LaneShape::span`].
    #[inline(always)]
    pub fn span<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        from: usize,
        ray: &LaneRay<L>,
        asked: L::Mask,
        limit: L::Real,
    ) -> Span<L> {
        ball_span(l, &From { balls: self, from }, ray, asked, limit)
    }
}

/// Lane i asks ball `from` + i.
struct From<'a, T> {
    balls: &'a Balls<T>,
    from: usize,
}

macro_rules! numbers {
    ($($name:ident),*) => {
        $(
            #[inline(always)]
            fn $name(&self, l: L) -> L::Real {
                l.load(&self.balls.$name[self.from..])
            }
        )*
    };
}

impl<L: Lanes> Asked<L> for From<'_, L::Scalar> {
    #[inline(always)]
    fn centre(&self, l: L) -> Vec3<L::Real> {
        let [x, y, z] = &self.balls.centre;
        let from = self.from;
        Vec3::new(l.load(&x[from..]), l.load(&y[from..]), l.load(&z[from..]))
    }
    numbers!(
        radius,
        radius_squared,
        offset_error,
        curvature,
        reach,
        clear_squared,
        clear
    );
}
