//! Shapes.
pub mod lanes;
