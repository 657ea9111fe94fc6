//! A render: tiles over threads, passes over the whole image, and when to stop.

pub mod bins;
pub mod pass;
pub mod session;
pub mod tile;

pub use session::{Progress, Rendered, Request, render, render_binned};
