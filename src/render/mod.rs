//! Rendering: tiles over threads, passes over the whole image until it is done, and the picture made
//! of the sums.
//!
//! [`Render`] holds a scene and its plan, chooses samples for a wanted error, renders, and makes a
//! [`Picture`](crate::film::Picture) with its layers, its standard errors and everything needed to
//! render it again. [`trace`] intersects single rays exactly.

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
