//! Many tests that together raise a false alarm with a stated probability.

/// The level of each of `count` independent tests when the whole family may raise a false alarm
/// with probability `level` (Z. Šidák, JASA 62, 1967): 1 − (1 − level)^(1/count).
#[must_use]
pub fn sidak(level: f64, count: usize) -> f64 {
    -libm::expm1(libm::log1p(-level) / count as f64)
}

/// Which hypotheses S. Holm's step-down procedure (Scandinavian Journal of Statistics 6, 1979)
/// rejects, by index and in the order of their p-values; whatever depends on what, the probability
/// of rejecting any true one is at most `level`.
#[must_use]
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
