//! Where the search for the next zero begins on a ray that leaves a surface.

use super::interval::{Enclosed, PIECES, of, sign};

/// The ray starts at a zero, whose place is known up to rounding.
///
/// `blurred` encloses the function for all starts that rounding may have put in the place of the true
/// one, `sharp` for the start as given. Up to the returned t the function is monotone, so that no start
/// has a zero besides its own, and at t it has the sign of the side that the ray leaves to. 0 where no
/// start is a zero of this function; `None` where neither can be proved, as for a ray along the
/// surface.
pub fn departure<B: Enclosed, S: Enclosed>(blurred: &mut B, sharp: &mut S, to: f64) -> Option<f64> {
    let mut width = to;
    // Two rounds reach down to 8⁻¹⁵ = 3e-14 of the stretch.
    for _ in 0..2 {
        let mut ends = [width; PIECES];
        for end in &mut ends {
            *end = width;
            width *= 0.125;
        }
        let pieces = blurred.over(&[0.0; PIECES], &ends);
        let values = sharp.at(&ends);
        for (i, &end) in ends.iter().enumerate() {
            if pieces.broken_at(i) {
                continue;
            }
            if sign(of(&pieces.value, i)) != 0 {
                return Some(0.0);
            }
            let direction = sign(of(&pieces.slope, i));
            if direction != 0 && sign(of(&values, i)) == direction {
                return Some(end);
            }
        }
    }
    None
}
