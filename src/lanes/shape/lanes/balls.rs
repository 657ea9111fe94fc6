//! Several balls: one ray asks them together, its lanes balls; or each lane's ray asks those that it
//! comes near.

use super::{LaneRay, LaneShape, LaneSpan};
use crate::math::lanes::{Int, Lanes, Mask, Real, Scalar};
use crate::math::lookup::SMALL;
use crate::shape::sphere::{Ball, Foot, ball_span};

/// Most balls of a group.
pub const MOST: usize = SMALL;

/// Bound of the error of the squared distance in [`Balls::near`], in units of u (max|o| + max|c|)²:
/// with s = |o| + |c| ≤ √3 (max|o| + max|c|), nine roundings of sums up to s² and 9u s of error in g/|d|,
/// squared, make 27u s², the rounding of the centre another 4u s²; 3 · 31 and a quarter more for
/// this number's own rounding.
const FOOT_ERROR: f64 = 116.0;

/// The numbers of up to [`MOST`] balls by column.
#[derive(Debug, Clone)]
pub struct Balls<T> {
    /// The least reach of all is that of each.
    columns: Ball<[T; MOST]>,
    /// −[`Ball::clear`].
    behind: [T; MOST],
    centre_squared: [T; MOST],
    /// Largest magnitude of a centre's coordinate.
    largest: T,
    /// Which objects they are; places without a ball repeat the last one.
    pub objects: [u32; MOST],
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
        let reach = balls.iter().fold(balls[last].reach, |least, b| {
            if b.reach < least { b.reach } else { least }
        });
        Some(Self {
            columns: Ball {
                centre: [0, 1, 2].map(|axis| column(&|b| b.centre[axis])),
                radius: column(&|b| b.radius),
                radius_squared: column(&|b| b.radius_squared),
                offset_error: column(&|b| b.offset_error),
                curvature: column(&|b| b.curvature),
                reach: [reach; MOST],
                clear_squared: column(&|b| b.clear_squared),
                clear: column(&|b| b.clear),
            },
            behind: column(&|b| T::from_f64(-b.clear.to_f64())),
            centre_squared: column(&|b| {
                T::from_f64(b.centre.iter().map(|x| x.to_f64() * x.to_f64()).sum())
            }),
            largest: balls
                .iter()
                .flat_map(|b| b.centre)
                .fold(T::default(), |largest, x| {
                    largest.larger(T::from_f64(x.to_f64().abs()))
                }),
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

    /// The places of balls that each lane's ray may meet before `limit`, place i as bit i: not those
    /// that it surely passes, leaves behind or does not reach, nor those of the objects `left_out`.
    ///
    /// As `Foot::is_apart`, in fewer operations and less sharply: with g = (o − c) · d, the foot is at
    /// −g/|d|² and its squared distance from the centre |o|² − 2 o · c + |c|² − g²/|d|².
    #[inline(always)]
    pub fn near<L: Lanes<Scalar = T>, const N: usize>(
        &self,
        l: L,
        ray: &LaneRay<L>,
        left_out: [L::Int; N],
        limit: L::Real,
    ) -> L::Int {
        let origin = ray.origin;
        let back = -ray.direction;
        let ahead = origin.dot(ray.direction);
        let against = -ray.inverse_square;
        let twice = origin.scale(l.real(-2.0));
        let widest = ray.extent + l.splat(self.largest);
        let error = widest * widest * l.real(FOOT_ERROR * <T as Scalar>::ROUNDOFF);
        let outside = origin.length_squared() - error;
        let columns = &self.columns;
        let [x, y, z] = &columns.centre;
        let mut near = l.int(0);
        for place in 0..self.count {
            let (x, y, z) = (l.splat(x[place]), l.splat(y[place]), l.splat(z[place]));
            let behind = z.mul_add(back.z, y.mul_add(back.y, x.mul_add(back.x, ahead)));
            let foot_t = behind * against;
            let squared = outside + l.splat(self.centre_squared[place]);
            let squared = z.mul_add(twice.z, y.mul_add(twice.y, x.mul_add(twice.x, squared)));
            let squared = behind.mul_add(foot_t, squared);
            let clear = l.splat(columns.clear[place]);
            let apart = squared.gt(l.splat(columns.clear_squared[place]))
                | foot_t.lt(l.splat(self.behind[place]))
                | foot_t.gt(limit + clear);
            near = l.select_int(apart, near, near | l.int(1 << place));
        }
        let unusual = ray.extent.gt(l.splat(columns.reach[0]));
        if unusual.any() {
            near = l.select_int(unusual, self.near_from_afar(l, ray, limit), near);
        }
        for place in 0..self.count {
            let object = l.int(self.objects[place]);
            let mut out = l.mask(false);
            for left_out in &left_out {
                out = out | left_out.same(object);
            }
            near = l.select_int(out, near & l.int(!(1 << place)), near);
        }
        near
    }

    /// The same for rays from farther away than the bounds of [`Foot::is_apart`] hold.
    #[inline(never)]
    fn near_from_afar<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        ray: &LaneRay<L>,
        limit: L::Real,
    ) -> L::Int {
        l.vectorize(inlined!(|| {
            let mut near = l.int(0);
            for place in 0..self.count {
                let value = inlined!(|column: &[T; MOST]| l.splat(column[place]));
                let ball = &self.columns;
                let span = Foot::new(ball, value, ray).span(l, ball, value, ray);
                let behind = span.far.high.lt(l.real(0.0));
                let apart = span.miss | behind | span.near.low.gt(limit);
                near = l.select_int(apart, near, near | l.int(1 << place));
            }
            near
        }))
    }

    /// Takes one place out of each lane's set of places, which must not be empty.
    #[inline(always)]
    pub fn take_place<L: Lanes>(l: L, places: &mut L::Int) -> L::Int {
        let lowest = *places & l.int(0).minus(*places);
        *places = *places ^ lowest;
        let (_, exponent) = l.split_exponent(l.to_real(lowest));
        l.truncate(exponent)
    }

    /// Where each lane's ray meets the ball at its place.
    #[inline(always)]
    pub fn span_of<L: Lanes<Scalar = T>>(
        &self,
        l: L,
        place: L::Int,
        ray: &LaneRay<L>,
    ) -> LaneSpan<L> {
        let value = inlined!(|column: &[T; MOST]| l.lookup(column, place));
        Foot::new(&self.columns, value, ray).span(l, &self.columns, value, ray)
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
    ) -> LaneSpan<L> {
        let value = inlined!(|column: &[T; MOST]| l.load(&column[from..]));
        ball_span(l, &self.columns, value, ray, asked, limit)
    }
}
