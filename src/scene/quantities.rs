//! Reading the values of declared parameters.

use super::fields::{Fields, every};
use super::index;
use super::spectra::Spectra;
use super::tree::{Node, Value as Written};
use crate::declare::{Parameter, Quantity, Usual, Value};
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
        Quantity::Point | Quantity::Direction => "[x, y, z]",
        Quantity::Table(_) => "table",
    }
}

/// The keys of a value that is a table; those of spectra and glasses are their readers' own.
pub(super) fn keys(quantity: Quantity) -> &'static [&'static str] {
    match quantity {
        Quantity::Metal => &index::METAL_KEYS,
        _ => &[],
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
            _ => report.fail(node.place, format!("{path} is not true"), "true"),
        },
        Quantity::Number { unit, range } => {
            let allowed = |number| range.contains(number);
            let expected = match unit {
                "" => range.words(),
                unit => format!("{}, {unit}", range.words()),
            };
            let number = report.number_that(path, node, &expected, allowed)?;
            Some(vec![Value::Number(number)])
        }
        Quantity::Spectrum(role) => {
            let spectrum = spectra.spectrum(path, node, role)?;
            Some(vec![Value::Spectrum(spectrum)])
        }
        Quantity::TwoSpectra(role) => {
            let expected = "an array of two spectra";
            let [first, second] = report.array(path, node, expected)?;
            let first = spectra.spectrum(&format!("{path}[0]"), first, role);
            let second = spectra.spectrum(&format!("{path}[1]"), second, role);
            Some(vec![Value::Spectrum(first?), Value::Spectrum(second?)])
        }
        Quantity::Metal => Some(vec![Value::Index(metal(spectra, path, node, others)?)]),
        Quantity::Glass => Some(vec![Value::Index(index::glass(spectra, path, node)?)]),
        Quantity::Point => Some(vec![Value::Point(report.vector(path, node)?)]),
        Quantity::Direction => Some(vec![Value::Direction(report.direction(path, node)?)]),
        Quantity::Table(parameters) => {
            let keys: Vec<&str> = parameters.iter().map(|own| own.key).collect();
            let fields = Fields::open(report, path, node, &keys)?;
            all(spectra, &fields, parameters)
        }
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

/// A parameter as it is written, as messages show it.
pub(super) fn assigned(parameter: &Parameter) -> String {
    let Parameter { key, what, .. } = parameter;
    match parameter.quantity {
        Quantity::Number { unit, .. } if !unit.is_empty() => format!("{key} = {what}, {unit}"),
        Quantity::Point | Quantity::Direction => format!("{key} = [x, y, z], {what}"),
        _ => format!("{key} = {what}"),
    }
}

/// Reads the values of parameters, in their order.
pub(super) fn all<'p>(
    spectra: &Spectra<'_>,
    fields: &Fields<'_>,
    parameters: impl IntoIterator<Item = &'p Parameter>,
) -> Option<Vec<Value>> {
    let values = parameters.into_iter().map(|own| {
        let read = |path: &str, node: &Node| read(spectra, path, node, own.quantity, &[]);
        match own.default {
            None => fields.required(own.key, &assigned(own), read),
            Some(usual) => fields.optional(own.key, meant(own.quantity, usual), read),
        }
    });
    Some(every(values)?.concat())
}

/// What is meant where the key of a quantity is left out.
fn meant(quantity: Quantity, usual: Usual) -> Vec<Value> {
    match usual {
        Usual::Nothing => Vec::new(),
        Usual::Direction(direction) => vec![Value::Direction(direction)],
        Usual::Number(number) => vec![match quantity {
            Quantity::Spectrum(_) => Value::Spectrum(Spectrum::Constant(number)),
            _ => Value::Number(number),
        }],
    }
}
