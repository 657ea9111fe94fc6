//! Reading the values of declared parameters.

use super::fields::{Fields, Item, every};
use super::index;
use super::spectra::Spectra;
use super::tree::Value as Written;
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
    item: Item<'_>,
    quantity: Quantity,
    others: &[Parameter],
) -> Option<Vec<Value>> {
    let value = match quantity {
        Quantity::True => {
            return match item.node.value {
                Written::Bool(true) => Some(Vec::new()),
                _ => item.fail(format!("{} is not true", item.path), "true"),
            };
        }
        Quantity::Number { unit, range } => {
            let expected = match unit {
                "" => range.words(),
                unit => format!("{}, {unit}", range.words()),
            };
            let allowed = |number| range.contains(number);
            Value::Number(item.number_that(&expected, allowed)?)
        }
        Quantity::Spectrum(role) => Value::Spectrum(spectra.spectrum(&item, role)?),
        Quantity::TwoSpectra(role) => {
            let both = item.array::<2>("an array of two spectra")?;
            let [first, second] = both.map(|one| spectra.spectrum(&one, role));
            return Some(vec![Value::Spectrum(first?), Value::Spectrum(second?)]);
        }
        Quantity::Metal => Value::Index(metal(spectra, item, others)?),
        Quantity::Glass => Value::Index(index::glass(item)?),
        Quantity::Point => Value::Point(item.vector()?),
        Quantity::Direction => Value::Direction(item.direction()?),
        Quantity::Table(parameters) => {
            let keys: Vec<&str> = parameters.iter().map(|own| own.key).collect();
            return all(spectra, &Fields::open(item, &keys)?, parameters);
        }
    };
    Some(vec![value])
}

fn metal(spectra: &Spectra<'_>, item: Item<'_>, others: &[Parameter]) -> Option<RefractiveIndex> {
    match &item.node.value {
        Written::Text(name) => index::metal(&item, name),
        Written::Table(_) => {
            let keys = index::METAL_KEYS.into_iter();
            let keys: Vec<_> = keys.chain(others.iter().map(|own| own.key)).collect();
            index::complex(spectra, &Fields::open(item, &keys)?)
        }
        _ => {
            let table = |own: &Parameter| format!("{{ {} = {} }}", own.key, form(own.quantity));
            let mut forms: Vec<String> = index::METAL.map(str::to_owned).into();
            forms.extend(others.iter().map(table));
            let last = forms.pop().unwrap_or_default();
            item.wrong_type(format!("{} or {last}", forms.join(", ")))
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
        let read = |item| read(spectra, item, own.quantity, &[]);
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
