//! How surfaces scatter light.

pub mod fresnel;
