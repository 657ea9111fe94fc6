//! Central projection.

use std::ops::{Add, Bound};

use super::kind::Project;
use crate::declare::{Parameter, Quantity, Range};

/// By the full *vertical* opening angle.
pub struct Perspective;

impl Project for Perspective {
    const PARAMETER: Parameter = Parameter::new(
        "fov",
        "full vertical opening angle",
        Quantity::number(
            "degrees",
            Range {
                low: Bound::Excluded(0.0),
                high: Bound::Excluded(180.0),
            },
        ),
    );
    const CENTRAL: bool = true;

    fn height(fov: f64) -> f64 {
        let half = fov.to_radians() / 2.0;
        2.0 * libm::sin(half) / libm::cos(half)
    }

    #[inline(always)]
    fn ray<V: Add<Output = V>>(zero: V, forward: V, at: V) -> (V, V) {
        (zero, forward + at)
    }
}
