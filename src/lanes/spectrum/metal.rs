//! Measured n and k of named metals; sources stand at the head of each file.

use super::ior::RefractiveIndex;
use super::table::columns;
use super::{Spectrum, Table};

/// Silver, gold, copper: Johnson and Christy 1972. Aluminium: Rakić 1995.
const METALS: [(&str, &str); 4] = [
    ("Ag", include_str!("data/ag.csv")),
    ("Al", include_str!("data/al.csv")),
    ("Au", include_str!("data/au.csv")),
    ("Cu", include_str!("data/cu.csv")),
];

/// The complex refractive index of a named metal, any letter case; see [`metal_names`].
pub fn named_metal(name: &str) -> Option<RefractiveIndex> {
    let (_, text) = METALS
        .iter()
        .find(|(known, _)| known.eq_ignore_ascii_case(name))?;
    let ([nm, n, k], _) = columns::<3>(text).expect("the embedded tables are well formed");
    let spectrum = |values| {
        let table = Table::new(nm.clone(), values);
        Spectrum::Table(table.expect("the embedded tables increase"))
    };
    Some(RefractiveIndex::Complex {
        n: spectrum(n),
        k: spectrum(k),
    })
}

/// The names that [`named_metal`] knows.
pub fn metal_names() -> impl Iterator<Item = &'static str> {
    METALS.iter().map(|&(name, _)| name)
}
