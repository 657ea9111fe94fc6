//! Reading materials.

use super::fields::{Complaint, Fields};
use super::names::{GLASSES, METALS, one_of};
use super::spectra::{Role, Spectra};
use super::tree::{Node, Value};
use super::{Emission, Material, Named, Sides, Surface};
use crate::spectrum::ior::{RefractiveIndex, named_glass, named_metal};
use crate::spectrum::{NM_MAX, NM_MIN};

/// The materials of a file.
#[derive(Default)]
pub(super) struct Materials {
    /// All names, also of materials that have been complained of.
    pub names: Vec<String>,
    /// The materials, if nothing is wrong with any.
    pub checked: Option<Vec<Named<Material>>>,
}

const SCATTERING: &[&str] = &["diffuse", "mirror", "glass", "checkerboard", "black"];
const KEYS: &[&str] = &[
    "diffuse",
    "mirror",
    "glass",
    "checkerboard",
    "black",
    "cell",
    "emit",
    "sides",
];

/// Reads `[materials]`; `None` if that is no table at all.
pub(super) fn read(spectra: &Spectra<'_>, node: Option<&Node>) -> Option<Materials> {
    let Some(node) = node else {
        return Some(Materials {
            names: Vec::new(),
            checked: Some(Vec::new()),
        });
    };
    let Value::Table(table) = &node.value else {
        return spectra
            .report
            .wrong_type("materials", node, "a table of named materials");
    };
    let mut names = Vec::with_capacity(table.entries.len());
    let mut read = Vec::with_capacity(table.entries.len());
    for entry in &table.entries {
        names.push(entry.key.clone());
        read.push(
            material(spectra, &entry.key, &entry.node).map(|value| Named {
                name: entry.key.clone(),
                value,
            }),
        );
    }
    Some(Materials {
        names,
        checked: read.into_iter().collect(),
    })
}

fn material(spectra: &Spectra<'_>, name: &str, node: &Node) -> Option<Material> {
    let fields = Fields::open(spectra.report, format!("materials.{name}"), node, KEYS)?;
    let surface = surface(spectra, &fields);
    let emission = emission(spectra, &fields);
    Some(Material {
        surface: surface?,
        emission: emission?,
    })
}

fn surface(spectra: &Spectra<'_>, fields: &Fields<'_>) -> Option<Surface> {
    let found = fields.at_most_one(SCATTERING)?;
    let board = fields.table.entry("checkerboard");
    if let (None, Some(cell)) = (board, fields.table.entry("cell")) {
        let message = format!("{} without a checkerboard", fields.path("cell"));
        return spectra.report.fail(
            Complaint::new(cell.key_place, message)
                .expected("checkerboard = [spectrum, spectrum] besides"),
        );
    }
    let Some((kind, node)) = found else {
        return Some(Surface::Black);
    };
    let path = fields.path(kind);
    match kind {
        "diffuse" => spectra
            .spectrum(&path, node, Role::Reflectance)
            .map(Surface::Diffuse),
        "mirror" => mirror(spectra, &path, node),
        "glass" => glass(spectra, &path, node).map(Surface::Glass),
        "checkerboard" => checkerboard(spectra, fields, &path, node),
        _ => match node.value {
            Value::Bool(true) => Some(Surface::Black),
            _ => spectra
                .report
                .fail(Complaint::new(node.place, format!("{path} is not true")).expected("true")),
        },
    }
}

fn checkerboard(
    spectra: &Spectra<'_>,
    fields: &Fields<'_>,
    path: &str,
    node: &Node,
) -> Option<Surface> {
    let expected = "an array of two spectra";
    let nodes = spectra.report.list(path, node, expected)?;
    let [even, odd] = nodes else {
        let message = format!("{path} has {} entries", nodes.len());
        return spectra
            .report
            .fail(Complaint::new(node.place, message).expected(expected));
    };
    let even = spectra.spectrum(&format!("{path}[0]"), even, Role::Reflectance);
    let odd = spectra.spectrum(&format!("{path}[1]"), odd, Role::Reflectance);
    let cell = fields.required("cell", "cell = edge of a cell", |what, node| {
        spectra.report.positive(what, node)
    });
    Some(Surface::Checkerboard {
        albedo: [even?, odd?],
        cell: cell?,
    })
}

fn mirror(spectra: &Spectra<'_>, path: &str, node: &Node) -> Option<Surface> {
    let report = spectra.report;
    match &node.value {
        Value::Text(name) => match named_metal(name) {
            Some(index) => Some(Surface::Conductor(index)),
            None => {
                let message = format!("{path} names the unknown metal \"{name}\"");
                report.unknown(node.place, message, name, &METALS)
            }
        },
        Value::Table(_) => {
            let fields = Fields::open(report, path, node, &["n", "k", "ideal"])?;
            let Some(ideal) = fields.get("ideal") else {
                let n = fields.required("n", "n = spectrum", |what, node| {
                    spectra.spectrum(what, node, Role::Index)
                });
                let k = fields.required("k", "k = spectrum", |what, node| {
                    spectra.spectrum(what, node, Role::Extinction)
                });
                return Some(Surface::Conductor(RefractiveIndex::Complex {
                    n: n?,
                    k: k?,
                }));
            };
            fields.at_most_one(&["ideal", "n"])?;
            fields.at_most_one(&["ideal", "k"])?;
            spectra
                .spectrum(&fields.path("ideal"), ideal, Role::Reflectance)
                .map(Surface::IdealMirror)
        }
        _ => report.wrong_type(
            path,
            node,
            "the name of a metal, { n = spectrum, k = spectrum } or { ideal = spectrum }",
        ),
    }
}

fn glass(spectra: &Spectra<'_>, path: &str, node: &Node) -> Option<RefractiveIndex> {
    let report = spectra.report;
    match &node.value {
        Value::Text(name) => match named_glass(name) {
            Some(index) => Some(index),
            None => {
                let message = format!("{path} names the unknown glass \"{name}\"");
                report.unknown(node.place, message, name, &GLASSES)
            }
        },
        Value::Table(_) => {
            let kinds = &["ior", "cauchy", "sellmeier"];
            let fields = Fields::open(report, path, node, kinds)?;
            let (kind, inner) = fields.exactly_one(kinds)?;
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
            let kinds = "the name of a glass, or a table with one of ";
            let expected = format!("{kinds}\"ior\", \"cauchy\", \"sellmeier\"");
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
        return report.fail(Complaint::new(node.place, message).expected(expected));
    }
    let numbers: Option<Vec<f64>> = nodes
        .iter()
        .enumerate()
        .map(|(i, node)| report.number(&format!("{path}[{i}]"), node))
        .collect();
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
    let fail = |message: String| {
        spectra
            .report
            .fail(Complaint::new(node.place, message).expected(expected))
    };
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

fn emission(spectra: &Spectra<'_>, fields: &Fields<'_>) -> Option<Option<Emission>> {
    let choices = [
        ("front", Sides::Front),
        ("back", Sides::Back),
        ("both", Sides::Both),
    ];
    let sides = fields.optional("sides", Sides::Front, |what, node| {
        spectra.report.choice(what, node, &choices)
    });
    if let (None, Some(entry)) = (fields.get("emit"), fields.table.entry("sides")) {
        let message = format!("{} without emit", fields.path("sides"));
        let names = choices.map(|(name, _)| name);
        let expected = format!("emit = spectrum besides sides = {}", one_of(&names));
        return spectra
            .report
            .fail(Complaint::new(entry.key_place, message).expected(expected));
    }
    let radiance = fields.optional("emit", None, |what, node| {
        spectra.spectrum(what, node, Role::Emission).map(Some)
    });
    let (radiance, sides) = (radiance?, sides?);
    Some(radiance.map(|radiance| Emission { radiance, sides }))
}
