//! etalon: a physically based spectral renderer, and the instrument that proves its pictures
//! right.

pub mod camera;
pub mod field;
pub mod film;
pub mod integrate;
pub mod light;
pub mod material;
pub mod math;
pub mod plan;
pub mod render;
pub mod root;
pub mod sample;
pub mod scene;
pub mod shape;
pub mod spectrum;
pub mod stats;
pub mod study;
