//! Lists of names, as messages show them.

use std::sync::LazyLock;

use crate::spectrum::ior;

/// Names of glasses that need no formula.
pub(super) static GLASSES: LazyLock<Vec<&str>> = LazyLock::new(|| ior::glass_names().collect());
/// Names of metals that need no table.
pub(super) static METALS: LazyLock<Vec<&str>> = LazyLock::new(|| ior::metal_names().collect());

/// As many names as a message lists.
const LISTED: usize = 12;

/// The nearest of `names`, if it is close enough to be a slip of the pen: one edit in three
/// letters, at least one, whatever the case.
pub(super) fn nearest(name: &str, names: &[&str]) -> Option<String> {
    let lower = name.to_lowercase();
    let allowed = (lower.chars().count() / 3).max(1);
    names
        .iter()
        .map(|candidate| {
            let distance = strsim::osa_distance(&lower, &candidate.to_lowercase());
            (distance, *candidate)
        })
        .filter(|(distance, _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate.to_owned())
}

/// `one of "a", "b"`, shortened when there are many.
pub(super) fn one_of(names: &[&str]) -> String {
    if names.is_empty() {
        return "a name (but none is defined)".to_owned();
    }
    let listed: Vec<String> = names
        .iter()
        .take(LISTED)
        .map(|n| format!("\"{n}\""))
        .collect();
    let rest = names.len() - listed.len();
    let listed = listed.join(", ");
    match (names.len(), rest) {
        (1, _) => listed,
        (_, 0) => format!("one of {listed}"),
        _ => format!("one of {listed} … and {rest} more"),
    }
}
