//! Implicit surfaces in f64, one ray at a time.

pub mod along;
pub mod baseline;
pub mod program;
pub mod tape;
