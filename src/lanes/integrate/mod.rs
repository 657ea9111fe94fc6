//! The path loop and its stages.
//!
//! A chunk of samples goes through three stages, each over packets of lanes: **camera** fills free
//! places of the pool with rays, **bounce** advances every path in the pool by one segment, and
//! **develop** turns the radiance at each path's wavelengths into tristimulus values. Results are
//! kept by sample, so the order in which paths end cannot show.

pub mod bounce;
pub mod chunk;
pub mod develop;
pub mod direct;
pub mod dispatch;
pub mod intersect;
pub mod list;
mod many;
pub mod model;
pub mod needs;
pub mod parts;
pub mod pool;
pub mod replay;
pub mod scatter;
pub mod surface;
