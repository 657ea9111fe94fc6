//! The exposures under which a picture of high dynamic range is looked at.

use crate::spectrum::observer::luminance;

/// Numerator and denominator of the tone curve, from the highest power: K. Narkowicz's fit of ACES
/// with exposure 0.6 taken in.
const NUMERATOR: [f64; 3] = [0.36 * 2.51, 0.6 * 0.03, 0.0];
const DENOMINATOR: [f64; 3] = [0.36 * 2.43, 0.6 * 0.59, 0.14];
/// What the tone curve makes of the brightest pixel at the first exposure and of the median one at
/// the last.
const TARGET: f64 = 0.85;

/// Exposures in stops, at least two.
pub fn exposures(reference: &[[f64; 3]]) -> Vec<f64> {
    let positive = |p: &[f64; 3]| luminance(p.map(|x| x.max(0.0)));
    let mut luminances: Vec<f64> = reference.iter().map(positive).collect();
    luminances.sort_by(f64::total_cmp);
    let middle = luminances.len().saturating_sub(1) / 2;
    let (Some(&largest), Some(&median)) = (luminances.last(), luminances.get(middle)) else {
        return Vec::new();
    };
    if largest <= 0.0 {
        return vec![0.0];
    }
    // Where half of the picture is black, sixteen stops below its brightest pixel are enough.
    let median = median.max(largest / 65_536.0);
    let bright = brightest();
    let first = libm::log2(bright / largest);
    let last = libm::log2(bright / median);
    let count = (last - first).ceil().max(2.0);
    let step = (last - first) / (count - 1.0);
    (0..count as usize)
        .map(|i| first + i as f64 * step)
        .collect()
}

/// The x that the tone curve maps to [`TARGET`]: (n₀ − t d₀) x² + (n₁ − t d₁) x + (n₂ − t d₂) = 0.
fn brightest() -> f64 {
    let [a, b, c] = [0, 1, 2].map(|i| NUMERATOR[i] - TARGET * DENOMINATOR[i]);
    let half = -0.5 * b / a;
    half + (half * half - c / a).sqrt()
}

/// A pixel as it is shown: exposed, tone mapped, within [0, 1], still linear.
pub fn tone_mapped(rgb: [f64; 3], exposure: f64) -> [f64; 3] {
    let factor = libm::exp2(exposure);
    let value = |[a, b, c]: [f64; 3], x: f64| (a * x + b) * x + c;
    rgb.map(|component| {
        let x = (component * factor).max(0.0);
        (value(NUMERATOR, x) / value(DENOMINATOR, x)).clamp(0.0, 1.0)
    })
}
