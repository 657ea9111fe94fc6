//! Parallel projection.

use std::ops::Add;

use super::kind::Project;
use crate::declare::{Parameter, Quantity, Range};

/// By the height of the scene that the picture shows.
pub struct Orthographic;

impl Project for Orthographic {
    const PARAMETER: Parameter = Parameter::new(
        "orthographic",
        "height of the picture",
        Quantity::number("scene units", Range::POSITIVE),
    );
    const CENTRAL: bool = false;

    fn height(height: f64) -> f64 {
        height
    }

    #[inline(always)]
    fn ray<V: Add<Output = V>>(_zero: V, forward: V, at: V) -> (V, V) {
        (at, forward)
    }
}
