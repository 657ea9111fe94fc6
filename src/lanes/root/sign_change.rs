//! Equal steps, a change of sign, bisection: the report's own method, which proves nothing.
//!
//! Zeros at which the sign does not change are missed, and so are pairs of zeros within one step.
//! It stays as the yardstick for the finders that prove.

use crate::math::lanes::Scalar;

/// The first change of sign of a function in [near, far], in `steps` equal steps: its bracket,
/// halved until no number lies between its ends.
pub fn first_change<T: Scalar>(
    value: impl Fn(T) -> T,
    [near, far]: [T; 2],
    steps: u32,
) -> Option<[T; 2]> {
    let zero = T::default();
    let negative = value(near) < zero;
    let step = (far - near) / T::from_f64(steps.into());
    let mut low = near;
    for i in 1..=steps {
        let high = if i == steps {
            far
        } else {
            near + step * T::from_f64(i.into())
        };
        if (value(high) < zero) != negative {
            return Some(bisected(&value, low, high, negative));
        }
        low = high;
    }
    None
}

/// The sign is `negative` at `low` and not at `high`.
fn bisected<T: Scalar>(value: &impl Fn(T) -> T, mut low: T, mut high: T, negative: bool) -> [T; 2] {
    let half = T::from_f64(0.5);
    loop {
        let middle = low + (high - low) * half;
        if middle <= low || middle >= high {
            return [low, high];
        }
        if (value(middle) < T::default()) == negative {
            low = middle;
        } else {
            high = middle;
        }
    }
}
