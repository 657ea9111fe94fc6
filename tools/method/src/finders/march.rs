//! The report's method in one arithmetic from the clip to the last bisection.

use std::cell::RefCell;

use num_rational::BigRational;

use super::Answer;
use etalon::inside::field::evaluate::{binary, nearest, unary};
use etalon::inside::field::tape::{Algebra, Binary, Tape, Unary};
use etalon::inside::math::lanes::Scalar;
use etalon::inside::root::sign_change::first_change;
use etalon::inside::shape::Ray;

pub struct March<T> {
    tape: Tape,
    constants: Vec<T>,
    half_width: T,
    steps: u32,
    results: RefCell<Vec<T>>,
}

impl<T: Scalar> March<T> {
    /// Rounds what is constant.
    pub fn new(tape: &Tape, half_width: f64, steps: u32) -> Self {
        let constants = tape.constants().iter();
        Self {
            constants: constants.map(|c| T::from_f64(nearest(c))).collect(),
            tape: tape.clone(),
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
            let point = std::array::from_fn(|i| origin[i] + direction[i] * t);
            let numbers = Numbers {
                constants: &self.constants,
                point,
            };
            let mut results = self.results.borrow_mut();
            let value = self.tape.evaluate(&numbers, &mut results);
            value.unwrap_or_default()
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

/// Arithmetic at a point.
struct Numbers<'a, T> {
    constants: &'a [T],
    point: [T; 3],
}

impl<T: Scalar> Algebra for Numbers<'_, T> {
    type Value = T;

    fn coordinate(&self, axis: usize) -> T {
        self.point[axis]
    }

    fn constant(&self, index: usize, _: &BigRational) -> T {
        self.constants[index]
    }

    fn unary(&self, function: Unary, a: &T) -> T {
        match function {
            Unary::Negative => T::default() - *a,
            Unary::SquareRoot => a.root(),
            _ => T::from_f64(unary(function, a.to_f64())),
        }
    }

    fn binary(&self, function: Binary, a: &T, b: &T) -> T {
        match function {
            Binary::Sum => *a + *b,
            Binary::Difference => *a - *b,
            Binary::Product => *a * *b,
            Binary::Quotient => *a / *b,
            _ => T::from_f64(binary(function, a.to_f64(), b.to_f64())),
        }
    }

    fn whole_power(&self, a: &T, n: i32) -> T {
        let one = T::from_f64(1.0);
        let (mut power, mut square, mut left) = (one, *a, n.unsigned_abs());
        while left > 0 {
            if left % 2 == 1 {
                power = power * square;
            }
            square = square * square;
            left /= 2;
        }
        if n < 0 { one / power } else { power }
    }
}
