//! Numbers: transforms, extended precision, lanes. Knows nobody else.

pub mod affine;
pub mod functions;
pub mod lanes;
pub mod vec3;
