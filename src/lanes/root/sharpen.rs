//! The enclosure of a root narrowed beyond what f64 can hold.

use num_bigint::{BigInt, Sign};

use super::exact::{Point, SquareFree};
use crate::math::exact::Exact;
use crate::math::number::Number;

/// The first root in [low, high], within 2⁻ᵇ of the interval's width; twice the same where it is met
/// exactly, and `None` where there is none. The coefficients stand lowest power first.
pub fn sharpened(coefficients: &[BigInt], ends: [f64; 2], bits: u32) -> Option<[Exact; 2]> {
    let SquareFree { simple, chain, .. } = SquareFree::of(coefficients)?;
    let [mut low, mut high] = ends.map(Exact::of);
    if simple.sign_at(&Point::dyadic(&low)) == Sign::NoSign {
        return Some([low.clone(), low]);
    }
    let mut count = chain.count(&Point::dyadic(&low), &Point::dyadic(&high));
    let mut at_high = simple.sign_at(&Point::dyadic(&high));
    for _ in 0..bits {
        if count == 0 {
            return None;
        }
        let middle = low.plus(&high).shifted(-1);
        let point = Point::dyadic(&middle);
        let sign = simple.sign_at(&point);
        // The sign decides on which side a single root is, the chain where the first of several is.
        let before = if count > 1 {
            chain.count(&Point::dyadic(&low), &point)
        } else {
            usize::from(sign == at_high || sign == Sign::NoSign)
        };
        if before == 0 {
            low = middle;
            continue;
        }
        if before == 1 && sign == Sign::NoSign {
            return Some([middle.clone(), middle]);
        }
        (high, count, at_high) = (middle, before, sign);
    }
    Some([low, high])
}
