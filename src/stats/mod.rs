//! Statistics over slices of numbers: no knowledge of pictures' files or of scenes.
//!
//! [`metrics`] says how far numbers are from a reference; an [`Estimate`] is a number with its
//! standard error and the degrees of freedom of that; [`slope`] is the power law that errors follow;
//! [`family`] shares a level among many tests; [`uniformity`] asks whether many p-values together
//! look like those of correct error bars; [`blocks`] cuts a picture into places that are judged one
//! by one.

pub mod blocks;
pub mod estimate;
pub mod family;
pub mod metrics;
pub mod slope;
pub mod student;
pub mod uniformity;

pub use estimate::Estimate;
