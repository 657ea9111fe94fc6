//! Implicit surfaces f(x, y, z) = 0.

pub mod along;
pub mod baseline;
pub mod bounded;
pub mod certified;
pub mod clip;
pub mod differentiate;
pub mod enclosed;
pub mod enclosed_packet;
pub mod evaluate;
pub mod expression;
pub mod interval_program;
pub mod named;
pub mod normal;
pub mod over_box;
pub mod placed;
pub mod polynomial;
pub mod program;
pub mod rational;
pub mod structure;
pub mod tape;
