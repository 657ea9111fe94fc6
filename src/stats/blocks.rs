//! Blocks of pixels: places of a picture large enough to have a standard error of their own.

/// Edge of a block in pixels. Its 64 pixels are scrambled independently, so that even two
/// replicates leave its standard error 64 degrees of freedom.
pub const EDGE: usize = 8;

/// Pixels of each block of a picture, row by row; blocks at the right and lower edge may be
/// smaller.
pub fn members(width: usize, height: usize, edge: usize) -> Vec<Vec<usize>> {
    let mut blocks = Vec::new();
    for top in (0..height).step_by(edge) {
        for left in (0..width).step_by(edge) {
            let rows = top..(top + edge).min(height);
            let columns = left..(left + edge).min(width);
            let row = |y: usize| columns.clone().map(move |x| y * width + x);
            blocks.push(rows.flat_map(row).collect());
        }
    }
    blocks
}
