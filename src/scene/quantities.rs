//! Reading the values of declared parameters.

use super::fields::{Complaint, Fields};
use super::index;
use super::spectra::Spectra;
use super::tree::{Node, Value as Written};
use crate::declare::{Parameter, Quantity, Value};
use crate::spectrum::Spectrum;
use crate::spectrum::ior::RefractiveIndex;

/// How a value is written, as messages show it.
pub(super) fn form(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::True => "true",
        Quantity::Number { .. } => "number",
        Quantity::Spectrum(_) => "spectrum",
        Quantity::TwoSpectra(_) => "[spectrum, spectrum]",
        Quantity::Metal => "metal",
        Quantity::Glass => "glass",
    }
}

/// The keys of a value that is a table; those of spectra and glasses are their readers' own.
pub(super) fn keys(quantity: Quantity) -> &'static [&'static str] {
    match quantity {
        Quantity::Metal => &index::METAL_KEYS,
        Quantity::True
        | Quantity::Number { .. }
        | Quantity::Spectrum(_)
        | Quantity::TwoSpectra(_)
        | Quantity::Glass => &[],
    }
}

/// Reads a value. `others` are what its key may hold in its place: a table with one of these.
pub(super) fn read(
    spectra: &Spectra<'_>,
    path: &str,
    node: &Node,
    quantity: Quantity,
    others: &[Parameter],
) -> Option<Vec<Value>> {
    let report = spectra.report;
    match quantity {
        Quantity::True => match node.value {
            Written::Bool(true) => Some(Vec::new()),
            _ => report
                .fail(Complaint::new(node.place, format!("{path} is not true")).expected("true")),
        },
        Quantity::Number { range, .. } => {
            let allowed = |number| range.contains(number);
            let number = report.number_that(path, node, &range.words(), allowed)?;
            Some(vec![Value::Number(number)])
        }
        Quantity::Spectrum(role) => {
            let spectrum = spectra.spectrum(path, node, role)?;
            Some(vec![Value::Spectrum(spectrum)])
        }
        Quantity::TwoSpectra(role) => {
            let expected = "an array of two spectra";
            let nodes = report.list(path, node, expected)?;
            let [first, second] = nodes else {
                let message = format!("{path} has {} entries", nodes.len());
                return report.fail(Complaint::new(node.place, message).expected(expected));
            };
            let first = spectra.spectrum(&format!("{path}[0]"), first, role);
            let second = spectra.spectrum(&format!("{path}[1]"), second, role);
            Some(vec![Value::Spectrum(first?), Value::Spectrum(second?)])
        }
        Quantity::Metal => Some(vec![Value::Index(metal(spectra, path, node, others)?)]),
        Quantity::Glass => Some(vec![Value::Index(index::glass(spectra, path, node)?)]),
    }
}

fn metal(
    spectra: &Spectra<'_>,
    path: &str,
    node: &Node,
    others: &[Parameter],
) -> Option<RefractiveIndex> {
    match &node.value {
        Written::Text(name) => index::metal(spectra, path, node, name),
        Written::Table(_) => {
            let keys = index::METAL_KEYS.into_iter();
            let keys: Vec<_> = keys.chain(others.iter().map(|own| own.key)).collect();
            let fields = Fields::open(spectra.report, path, node, &keys)?;
            index::complex(spectra, &fields)
        }
        _ => {
            let table = |own: &Parameter| format!("{{ {} = {} }}", own.key, form(own.quantity));
            let mut forms: Vec<String> = index::METAL.map(str::to_owned).into();
            forms.extend(others.iter().map(table));
            let last = forms.pop().unwrap_or_default();
            let expected = format!("{} or {last}", forms.join(", "));
            spectra.report.wrong_type(path, node, &expected)
        }
    }
}

/// Reads a parameter beside a kind's main one.
pub(super) fn beside(
    spectra: &Spectra<'_>,
    fields: &Fields<'_>,
    parameter: &Parameter,
) -> Option<Vec<Value>> {
    let Parameter {
        key,
        what,
        quantity,
        default,
    } = *parameter;
    let read = |path: &str, node: &Node| read(spectra, path, node, quantity, &[]);
    let Some(default) = default else {
        let unit = match quantity {
            Quantity::Number { unit, .. } if !unit.is_empty() => format!(", {unit}"),
            _ => String::new(),
        };
        return fields.required(key, &format!("{key} = {what}{unit}"), read);
    };
    let meant = match quantity {
        Quantity::Spectrum(_) => Value::Spectrum(Spectrum::Constant(default)),
        _ => Value::Number(default),
    };
    fields.optional(key, vec![meant], read)
}
