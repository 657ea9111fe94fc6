//! Reading refractive indices.

use super::fields::{Fields, every, one_of};
use super::spectra::Spectra;
use super::tree::{Node, Value};
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
pub(super) fn metal(
    spectra: &Spectra<'_>,
    path: &str,
    node: &Node,
    name: &str,
) -> Option<RefractiveIndex> {
    named_metal(name).or_else(|| {
        let message = format!("{path} names the unknown metal \"{name}\"");
        let names: Vec<&str> = metal_names().collect();
        spectra.report.unknown(node.place, message, name, &names)
    })
}

/// Reads n + ik of a metal from a table.
pub(super) fn complex(spectra: &Spectra<'_>, fields: &Fields<'_>) -> Option<RefractiveIndex> {
    let n = fields.required("n", "n = spectrum", |what, node| {
        spectra.spectrum(what, node, Role::Index)
    });
    let k = fields.required("k", "k = spectrum", |what, node| {
        spectra.spectrum(what, node, Role::Extinction)
    });
    Some(RefractiveIndex::Complex { n: n?, k: k? })
}

/// Reads n of a glass.
pub(super) fn glass(spectra: &Spectra<'_>, path: &str, node: &Node) -> Option<RefractiveIndex> {
    let report = spectra.report;
    match &node.value {
        Value::Text(name) => match named_glass(name) {
            Some(index) => Some(index),
            None => {
                let message = format!("{path} names the unknown glass \"{name}\"");
                report.unknown(
                    node.place,
                    message,
                    name,
                    &glass_names().collect::<Vec<_>>(),
                )
            }
        },
        Value::Table(_) => {
            let fields = Fields::open(report, path, node, GLASS_KEYS)?;
            let (kind, inner) = fields.exactly_one(GLASS_KEYS)?;
            let path = fields.path(kind);
            let index = match kind {
                "ior" => RefractiveIndex::Constant(report.number(&path, inner)?),
                "cauchy" => cauchy(spectra, &path, inner)?,
                _ => sellmeier(spectra, &path, inner)?,
            };
            check_index(spectra, &path, inner, &index)?;
            Some(index)
        }
        _ => {
            let keys = one_of(GLASS_KEYS);
            let expected = format!("the name of a glass, or a table with {keys}");
            report.wrong_type(path, node, &expected)
        }
    }
}

fn cauchy(spectra: &Spectra<'_>, path: &str, node: &Node) -> Option<RefractiveIndex> {
    let report = spectra.report;
    let expected = "[A, B] or [A, B, C] for wavelengths in µm";
    let nodes = report.list(path, node, expected)?;
    if !(2..=3).contains(&nodes.len()) {
        let message = format!("{path} has {} entries", nodes.len());
        return report.fail(node.place, message, expected);
    }
    let numbers = nodes.iter().enumerate();
    let numbers = every(numbers.map(|(i, node)| report.number(&format!("{path}[{i}]"), node)));
    numbers.map(RefractiveIndex::Cauchy)
}

fn sellmeier(spectra: &Spectra<'_>, path: &str, node: &Node) -> Option<RefractiveIndex> {
    let report = spectra.report;
    let fields = Fields::open(report, path, node, &["b", "c"])?;
    let b = fields.required("b", "b = [B1, B2, B3]", |what, node| {
        report.numbers(what, node)
    });
    let c = fields.required("c", "c = [C1, C2, C3] in µm²", |what, node| {
        report.numbers(what, node)
    });
    Some(RefractiveIndex::Sellmeier { b: b?, c: c? })
}

/// n must be finite and at least 1 wherever light is seen.
///
/// Between the resonances (λ² = C) each term of the formulas is monotonic in λ, so with no
/// resonance among the visible wavelengths every nanometre is close enough a look.
fn check_index(
    spectra: &Spectra<'_>,
    path: &str,
    node: &Node,
    index: &RefractiveIndex,
) -> Option<()> {
    let expected = "a finite index of refraction of at least 1 at all visible wavelengths";
    let fail = |message: String| spectra.report.fail(node.place, message, expected);
    if let RefractiveIndex::Constant(n) = index {
        return if *n >= 1.0 {
            Some(())
        } else {
            fail(format!("{path} is {n}"))
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
            return fail(format!("{path} has a resonance at {nm:.1} nm"));
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
            return fail(format!("{path} has {value} at {whole} nm"));
        }
    }
    Some(())
}
