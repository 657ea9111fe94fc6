//! etalon: a physically based spectral renderer, and the instrument that proves its pictures
//! right.

#[cfg(feature = "study")]
pub mod chart;
pub mod compare;
pub mod film;
pub mod plan;
pub mod render;
pub mod scene;
pub mod stats;
#[cfg(feature = "study")]
pub mod study;

#[cfg(feature = "planted")]
pub use etalon_lanes::planted;
pub use etalon_lanes::{
    camera, declare, field, integrate, light, material, math, root, sample, shape, spectrum,
};
