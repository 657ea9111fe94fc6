//! Implicit surfaces in f64, one ray at a time.

pub mod baseline;
pub mod certified;
pub mod program;
pub mod tape;
