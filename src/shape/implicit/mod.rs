//! Implicit surfaces f(x, y, z) = 0.

pub mod baseline;
pub mod certified;
pub mod expression;
pub mod named;
pub mod polynomial;
pub mod program;
pub mod rational;
pub mod structure;
pub mod tape;
