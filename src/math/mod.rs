//! Numbers: transforms, extended precision, lanes. Knows nobody else.

pub mod affine;
pub mod double_double;
pub mod exact;
pub mod functions;
pub mod lanes;
pub mod lookup;
pub mod number;
pub mod twice;
pub mod vec3;
