//! A render: tiles over threads, passes over the whole image, when to stop, and the picture that
//! comes of it.
//!
//! [`Render`] is the way in: it holds a scene and its plan, chooses samples for a wanted error,
//! renders, and makes a [`Picture`](crate::film::Picture) with its layers, its standard errors and
//! all that it takes to make it again. [`trace`] follows single rays, exactly.

pub mod bins;
pub mod builder;
pub mod goal;
pub mod layers;
pub mod memory;
mod picture;
pub mod replay;
pub mod seeds;
pub mod session;
pub mod tile;
pub mod trace;

pub use crate::math::instructions::Instructions;
pub use builder::Render;
pub use replay::replay;
pub use session::{Progress, Rendered, Request, Unwatched, render};
