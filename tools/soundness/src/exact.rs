//! Comparisons of exact sums and products with numbers, by error-free transformations.

use std::cmp::Ordering;

/// x + y ⋚ z for finite numbers, exactly.
///
/// x + y = s + e (Knuth 1969), and |e| is at most half a step of s: numbers apart from s are on
/// the same side of s and of s + e. Halving keeps sums near the largest number finite; what it
/// may cost subnormal numbers is avoided by not halving those.
pub fn compare_sum(x: f64, y: f64, z: f64) -> Ordering {
    let large = x.abs().max(y.abs()).max(z.abs()) > 1e300;
    let small = [x, y, z].iter().any(|v| *v != 0.0 && v.abs() < 1e-290);
    if large && small {
        // The small ones decide only where the others cancel exactly.
        return compare_mixed(x, y, z);
    }
    let scale = if large { 0.25 } else { 1.0 };
    let (x, y, z) = (x * scale, y * scale, z * scale);
    let s = x + y;
    let part = s - x;
    let e = (x - (s - part)) + (y - part);
    s.total_order(z).then(e.total_order(0.0))
}

/// The order of three numbers' sum x + y − z where large and small ones meet.
fn compare_mixed(x: f64, y: f64, z: f64) -> Ordering {
    let mut terms = [x, y, -z];
    terms.sort_by(|a, b| b.abs().total_cmp(&a.abs()));
    // The two largest: their sum is exactly zero or far from the third, or the third is large too.
    let (scaled, third) = (terms.map(|t| t * 0.25), terms[2]);
    if third.abs() < 1e-290 {
        let first = scaled[0] + scaled[1];
        return first.total_order(0.0).then(third.total_order(0.0));
    }
    compare_sum(scaled[0], scaled[1], -scaled[2])
}

/// x · y ⋚ z for finite numbers, exactly.
///
/// Significands in [1, 2) have a product p + e exactly, e by a fused multiply-add, and neither can
/// over- or underflow; exponents are compared as integers.
pub fn compare_product(x: f64, y: f64, z: f64) -> Ordering {
    let sign = x.signum() * y.signum();
    if x == 0.0 || y == 0.0 {
        return 0.0.total_order(z);
    }
    if z == 0.0 || sign != z.signum() {
        return sign.total_order(0.0);
    }
    let ((mx, ex), (my, ey), (mz, ez)) = (split(x), split(y), split(z));
    let p = mx * my;
    let e = mx.mul_add(my, -p);
    // |x y| = (p + e) 2^(ex + ey) with 1 ≤ p + e < 4, |z| = mz 2^ez.
    let shift = ez - ex - ey;
    let magnitude = if shift < -2 {
        Ordering::Greater
    } else if shift > 2 {
        Ordering::Less
    } else {
        let z = mz * 2f64.powi(shift);
        p.total_order(z).then(e.total_order(0.0))
    };
    match sign > 0.0 {
        true => magnitude,
        false => magnitude.reverse(),
    }
}

/// |x| = m · 2ᵉ with 1 ≤ m < 2, for x ≠ 0.
fn split(x: f64) -> (f64, i32) {
    let x = x.abs();
    if x < f64::MIN_POSITIVE {
        let (m, e) = split(x * 2f64.powi(64));
        return (m, e - 64);
    }
    let exponent = (x.to_bits() >> 52) as i32 - 1023;
    let significand = (x.to_bits() & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000;
    (f64::from_bits(significand), exponent)
}

/// The order of two numbers of which none is NaN; −0 equals +0.
trait Ordered {
    fn total_order(&self, other: f64) -> Ordering;
}

impl Ordered for f64 {
    fn total_order(&self, other: f64) -> Ordering {
        self.partial_cmp(&other).unwrap_or(Ordering::Equal)
    }
}
