//! A render: tiles over threads, passes over the whole image, and when to stop.

pub mod bins;
pub mod blocks;
pub mod goal;
pub mod memory;
pub mod pass;
pub mod replay;
pub mod session;
pub mod target;
pub mod tile;

pub use crate::math::instructions::Instructions;
pub use replay::replay;
pub use session::{Progress, Rendered, Request, Unwatched, render, render_binned};
