//! Implicit surfaces f(x, y, z) = 0.

pub mod along;
pub mod baseline;
pub mod clip;
pub mod enclosed;
pub mod expression;
pub mod interval_program;
pub mod named;
pub mod over_box;
pub mod polynomial;
pub mod rational;
pub mod structure;
pub mod tape;
