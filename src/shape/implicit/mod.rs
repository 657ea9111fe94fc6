//! Implicit surfaces f(x, y, z) = 0.

pub mod baseline;
pub mod bounded;
pub mod certified;
pub mod differentiate;
pub mod evaluate;
pub mod expression;
pub mod named;
pub mod normal;
pub mod placed;
pub mod polynomial;
pub mod program;
pub mod rational;
pub mod structure;
pub mod tape;
