//! Whether numbers look drawn from the uniform distribution on [0, 1], as the values of the
//! cumulative distribution at z-scores with correct standard errors are.

/// p-value of the test of T. W. Anderson and D. A. Darling (JASA 49, 1954) that independent
/// numbers are uniform on [0, 1]; 1 without numbers. It gives more weight to both ends than the
/// test of Kolmogorov and Smirnov, and so sees error bars that are too small or too large.
#[must_use]
pub fn anderson_darling(numbers: &[f64]) -> f64 {
    if numbers.is_empty() {
        return 1.0;
    }
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len() as f64;
    // What is 0 or 1 after rounding counts as the nearest number that is not.
    let log = |x: f64| libm::log(x.max(f64::MIN_POSITIVE));
    let pairs = sorted.iter().zip(sorted.iter().rev()).enumerate();
    let sum: f64 = pairs
        .map(|(i, (low, high))| (2.0 * i as f64 + 1.0) * (log(*low) + log(1.0 - high)))
        .sum();
    tail(-count - sum / count)
}

/// Where the two forms of [`tail`] differ by 6 %, the next one being off by that and ever less.
const FAR: f64 = 5.0;

/// P(A² > z) for many numbers (eight are many: the statistic hardly depends on n).
///
/// G. and J. Marsaglia's approximation (Journal of Statistical Software 9(2), 2004), good to 2e-6;
/// far out, where it is not meant to be relative, the asymptote: A² is the sum of independent χ²₁
/// weighted with 1/(j (j + 1)), and the tail of such a sum is that of its first term times
/// Π (1 − wⱼ/w₁)^(−1/2) over the others (V. M. Zolotarev, Theory of Probability 6, 1961), which
/// telescopes to √3 erfc(√z).
fn tail(z: f64) -> f64 {
    if z > FAR {
        return 3.0f64.sqrt() * libm::erfc(z.sqrt());
    }
    if z <= 0.0 {
        return 1.0;
    }
    let polynomial =
        |coefficients: &[f64]| coefficients.iter().rev().fold(0.0, |sum, c| sum * z + c);
    if z < 2.0 {
        let factor = polynomial(&[
            2.000_12,
            0.247_105,
            -0.064_982_1,
            0.034_796_2,
            -0.011_672,
            0.001_686_91,
        ]);
        1.0 - libm::exp(-1.233_714_1 / z) / z.sqrt() * factor
    } else {
        let exponent = polynomial(&[
            1.0776,
            -2.306_95,
            0.434_24,
            -0.082_433,
            0.008_056,
            -0.000_314_6,
        ]);
        -libm::expm1(-libm::exp(exponent))
    }
}
