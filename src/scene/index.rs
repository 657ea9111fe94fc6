//! Reading refractive indices.

use super::fields::{Fields, Item, every, one_of};
use super::spectra::Spectra;
use super::tree::Value;
use crate::declare::Role;
use crate::spectrum::ior::{RefractiveIndex, glass_names, metal_names, named_glass, named_metal};
use crate::spectrum::{NM_MAX, NM_MIN};

/// Keys of a metal's table.
pub(super) const METAL_KEYS: [&str; 2] = ["n", "k"];
/// Keys of a glass's table: it has one of them.
pub(super) const GLASS_KEYS: &[&str] = &["ior", "cauchy", "sellmeier"];
/// What a metal may be.
pub(super) const METAL: [&str; 2] = ["the name of a metal", "{ n = spectrum, k = spectrum }"];

/// Reads n + ik of a metal by its name.
pub(super) fn metal(item: &Item<'_>, name: &str) -> Option<RefractiveIndex> {
    named_metal(name).or_else(|| {
        let message = format!("{} names the unknown metal \"{name}\"", item.path);
        item.unknown(message, name, &metal_names().collect::<Vec<_>>())
    })
}

/// Reads n + ik of a metal from a table.
pub(super) fn complex(spectra: &Spectra<'_>, fields: &Fields<'_>) -> Option<RefractiveIndex> {
    let n = fields.required("n", "n = spectrum", |n| spectra.spectrum(&n, Role::Index));
    let k = fields.required("k", "k = spectrum", |k| {
        spectra.spectrum(&k, Role::Extinction)
    });
    Some(RefractiveIndex::Complex { n: n?, k: k? })
}

/// Reads n of a glass.
pub(super) fn glass(item: Item<'_>) -> Option<RefractiveIndex> {
    match &item.node.value {
        Value::Text(name) => named_glass(name).or_else(|| {
            let message = format!("{} names the unknown glass \"{name}\"", item.path);
            item.unknown(message, name, &glass_names().collect::<Vec<_>>())
        }),
        Value::Table(_) => {
            let fields = Fields::open(item, GLASS_KEYS)?;
            let (kind, item) = fields.exactly_one(GLASS_KEYS)?;
            let index = match kind {
                "ior" => RefractiveIndex::Constant(item.number()?),
                "cauchy" => cauchy(&item)?,
                _ => sellmeier(item.clone())?,
            };
            check_index(&item, &index)?;
            Some(index)
        }
        _ => {
            let keys = one_of(GLASS_KEYS);
            item.wrong_type(format!("the name of a glass, or a table with {keys}"))
        }
    }
}

fn cauchy(item: &Item<'_>) -> Option<RefractiveIndex> {
    let expected = "[A, B] or [A, B, C] for wavelengths in µm";
    let entries = item.list(expected)?;
    if !(2..=3).contains(&entries.len()) {
        let message = format!("{} has {} entries", item.path, entries.len());
        return item.fail(message, expected);
    }
    every(entries.iter().map(Item::number)).map(RefractiveIndex::Cauchy)
}

fn sellmeier(item: Item<'_>) -> Option<RefractiveIndex> {
    let fields = Fields::open(item, &["b", "c"])?;
    let b = fields.required("b", "b = [B1, B2, B3]", |b| b.numbers());
    let c = fields.required("c", "c = [C1, C2, C3] in µm²", |c| c.numbers());
    Some(RefractiveIndex::sellmeier(b?, c?))
}

/// n must be finite and at least 1 wherever light is seen.
///
/// Between the resonances (λ² = C) each term of the formulas is monotonic in λ, so with no
/// resonance among the visible wavelengths every nanometre is close enough a look.
fn check_index(item: &Item<'_>, index: &RefractiveIndex) -> Option<()> {
    let expected = "a finite index of refraction of at least 1 at all visible wavelengths";
    let path = &item.path;
    if let RefractiveIndex::Constant(n) = index {
        return if *n >= 1.0 {
            Some(())
        } else {
            item.wrong(n, expected)
        };
    }
    if let RefractiveIndex::Sellmeier { b, c } = index {
        let micrometres = (NM_MIN / 1000.0)..=(NM_MAX / 1000.0);
        let resonance = b
            .iter()
            .zip(c)
            .find(|(b, c)| **b != 0.0 && micrometres.contains(&c.sqrt()));
        if let Some((_, c)) = resonance {
            let nm = c.sqrt() * 1000.0;
            return item.fail(format!("{path} has a resonance at {nm:.1} nm"), expected);
        }
    }
    for whole in NM_MIN as u32..=NM_MAX as u32 {
        let n = index.n(f64::from(whole));
        if !(n.is_finite() && n >= 1.0) {
            let value = if n.is_nan() {
                "no real value".to_owned()
            } else {
                format!("n = {n}")
            };
            return item.fail(format!("{path} has {value} at {whole} nm"), expected);
        }
    }
    Some(())
}
