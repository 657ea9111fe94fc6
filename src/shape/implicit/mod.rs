//! Implicit surfaces f(x, y, z) = 0.

pub mod along;
pub mod baseline;
pub mod certified;
pub mod clip;
pub mod enclosed;
pub mod enclosed_packet;
pub mod placed;
