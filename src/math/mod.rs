//! Numbers: transforms, extended precision, lanes. Knows nobody else.

pub mod affine;
