//! Blocks of pixels of a render.

use super::session::Rendered;
use crate::stats::Estimate;
use crate::stats::blocks::{EDGE, members};

/// Mean luminance of each block of a render.
pub fn luminances(rendered: &Rendered) -> Vec<Estimate> {
    let window = rendered.window;
    let pixels = rendered.xyz();
    let freedom = f64::from(rendered.replicates()) - 1.0;
    members(window.width() as usize, window.height() as usize, EDGE)
        .iter()
        .map(|block| {
            let values: Vec<f64> = block.iter().map(|i| pixels[*i].mean[1]).collect();
            let errors = block.iter().map(|i| pixels[*i].standard_error[1]);
            let variances: Vec<f64> = errors.map(|e| e * e).collect();
            Estimate::mean_of(&values, &variances, freedom)
        })
        .collect()
}
