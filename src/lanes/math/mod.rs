//! Numbers: lanes, intervals, extended precision, transforms. Uses no other room.

pub mod affine;
pub mod double_double;
pub mod exact;
pub mod functions;
pub mod instructions;
pub mod interval;
pub mod interval_functions;
pub mod jet;
pub mod lanes;
pub mod lookup;
pub mod number;
pub mod packet;
pub mod ray;
pub mod scalar_lane;
pub mod twice;
pub mod vec3;
pub mod words;
