//! The report's method in one arithmetic from the clip to the last bisection.

use std::cell::RefCell;

use super::Answer;
use etalon::inside::field::evaluate::Field;
use etalon::inside::field::tape::Tape;
use etalon::inside::math::lanes::{Lanes, Scalar};
use etalon::inside::math::vec3::Vec3;
use etalon::inside::root::sign_change::first_change;
use etalon::inside::shape::Ray;

pub struct March<T: Scalar> {
    field: Field<T>,
    half_width: T,
    steps: u32,
    results: RefCell<Vec<[<T::One as Lanes>::Real; 1]>>,
}

impl<T: Scalar> March<T> {
    pub fn new(tape: &Tape, half_width: f64, steps: u32) -> Self {
        Self {
            field: Field::new(tape),
            half_width: T::from_f64(half_width),
            steps,
            results: RefCell::default(),
        }
    }

    /// The first change of sign in the clip cube after `t_min`.
    pub fn first_hit(&self, ray: &Ray, t_min: f64) -> Answer {
        let origin = ray.origin.to_array().map(T::from_f64);
        let direction = ray.direction.to_array().map(T::from_f64);
        let Some([near, far]) = self.clip(origin, direction, T::from_f64(t_min)) else {
            return Answer::Miss;
        };
        let value = |t: T| {
            let l = T::ONE;
            let [x, y, z] = [0, 1, 2].map(|i| l.splat(origin[i] + direction[i] * t));
            let mut results = self.results.borrow_mut();
            let [value] = self.field.values(l, [Vec3::new(x, y, z)], &mut results);
            l.lane(value, 0)
        };
        let middle = |[low, high]: [T; 2]| low + (high - low) * T::from_f64(0.5);
        let t = first_change(value, [near, far], self.steps).map(middle);
        t.map_or(Answer::Miss, |t| Answer::Hit(t.to_f64()))
    }

    fn clip(&self, origin: [T; 3], direction: [T; 3], t_min: T) -> Option<[T; 2]> {
        let zero = T::default();
        let half = self.half_width;
        let (mut near, mut far) = (t_min, T::from_f64(f64::from(f32::MAX)));
        for (o, d) in origin.into_iter().zip(direction) {
            if d == zero {
                if o < zero - half || o > half {
                    return None;
                }
                continue;
            }
            let (a, b) = ((zero - half - o) / d, (half - o) / d);
            let (enter, leave) = if a < b { (a, b) } else { (b, a) };
            near = near.larger(enter);
            far = if leave < far { leave } else { far };
        }
        (near <= far).then_some([near, far])
    }
}
