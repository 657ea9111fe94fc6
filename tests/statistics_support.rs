//! Tests of hypotheses with stated levels.

use etalon::Estimate;
use etalon::inside::stats::student;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// p-value of Pearson's χ² of counts against expected counts. Neighbouring bins are joined until
/// at least 10 are expected in each; what is expected nowhere but counted gives 0.
pub fn chi_square(counts: &[u64], expected: &[f64]) -> f64 {
    assert_eq!(counts.len(), expected.len());
    let total: f64 = expected.iter().sum();
    let drawn: u64 = counts.iter().sum();
    assert!(
        (total - drawn as f64).abs() <= 1e-6 * total,
        "{total} expected, {drawn} drawn"
    );
    let mut joined: Vec<(f64, f64)> = Vec::new();
    let (mut count, mut expect) = (0.0, 0.0);
    for (&c, &e) in counts.iter().zip(expected) {
        if c > 0 && e == 0.0 {
            return 0.0;
        }
        count += c as f64;
        expect += e;
        if expect >= 10.0 {
            joined.push((count, expect));
            (count, expect) = (0.0, 0.0);
        }
    }
    if let Some(last) = joined.last_mut() {
        last.0 += count;
        last.1 += expect;
    }
    assert!(joined.len() > 1, "too few samples for a test");
    let statistic: f64 = joined.iter().map(|(c, e)| (c - e) * (c - e) / e).sum();
    chi_square_tail((joined.len() - 1) as f64, statistic)
}

/// P(χ² > x).
pub fn chi_square_tail(freedom: f64, x: f64) -> f64 {
    ChiSquared::new(freedom).map_or(f64::NAN, |distribution| distribution.sf(x))
}

/// Two-sided p-value of a standard normal variable.
pub fn normal_p(z: f64) -> f64 {
    student::two_sided(z, f64::INFINITY)
}

/// Two-sided p-value of the mean of `values` against `truth`, Student's t.
pub fn t_test(values: &[f64], truth: f64) -> f64 {
    Estimate::mean(values).p_value(truth, 0.0)
}

/// Mean and unbiased variance.
pub fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (mean, squares / (n - 1.0))
}

/// Two-sided p-value of the hypothesis that independent `values` have this mean and variance. The
/// second moment about the known mean is compared with its own standard error from the fourth
/// moment about it, which needs no law of the values; `None` where the values are constant.
pub fn variance_p(values: &[f64], mean: f64, variance: f64) -> Option<f64> {
    let squares: Vec<f64> = values.iter().map(|v| (v - mean) * (v - mean)).collect();
    let (_, spread) = moments(&squares);
    (spread > 0.0).then(|| t_test(&squares, variance))
}

/// Which hypotheses S. Holm's step-down procedure (Scandinavian Journal of Statistics 6, 1979)
/// rejects, by index and in the order of their p-values; whatever depends on what, the probability
/// of rejecting any true one is at most `level`.
pub fn holm(p_values: &[f64], level: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let count = order.len();
    let rejected = order
        .into_iter()
        .enumerate()
        .take_while(|(rank, index)| p_values[*index] <= level / (count - rank) as f64);
    rejected.map(|(_, index)| index).collect()
}
