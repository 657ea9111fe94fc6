//! Blocks of pixels of a render.

use super::session::Rendered;
use crate::stats::Estimate;
use crate::stats::blocks::{EDGE, members};

/// Mean luminance of each block of a render.
pub fn luminances(rendered: &Rendered) -> Vec<Estimate> {
    let window = rendered.window;
    let pixels = rendered.xyz();
    members(window.width() as usize, window.height() as usize, EDGE)
        .iter()
        .map(|block| rendered.mean_of(&pixels, block, 1))
        .collect()
}
