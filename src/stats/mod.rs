//! Statistics over slices of numbers: no knowledge of images or scenes.

pub mod metrics;
