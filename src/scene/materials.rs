//! Reading materials, as [`MaterialKind`]s declare themselves.

use std::sync::LazyLock;

use super::fields::{Fields, Item, every, one_of};
use super::quantities;
use super::spectra::Spectra;
use super::tree::{Node, Table, Value};
use super::{Emission, Material, Named, Sides, Surface};
use crate::declare::{self, Declaration, Parameter, Role};
use crate::material::MaterialKind;

/// The materials of a file.
#[derive(Default)]
pub(super) struct Materials {
    /// All names, also of materials that have been complained of.
    pub names: Vec<String>,
    /// The materials, if nothing is wrong with any.
    pub checked: Option<Vec<Named<Material>>>,
}

/// The keys that say what a material is, in the order in which messages list them.
static KINDS: LazyLock<Vec<&str>> = LazyLock::new(|| {
    let keys: Vec<&str> = declarations().map(|own| own.main.key).collect();
    distinct(&keys)
});
/// All keys of a material.
static KEYS: LazyLock<Vec<&str>> = LazyLock::new(|| {
    let beside = declarations().flat_map(|own| own.beside).map(|own| own.key);
    let keys: Vec<&str> = beside.chain(["emit", "sides"]).collect();
    distinct(&[KINDS.as_slice(), &keys].concat())
});

fn declarations() -> impl Iterator<Item = Declaration> {
    MaterialKind::ALL.iter().map(|kind| kind.declaration())
}

fn distinct(keys: &[&'static str]) -> Vec<&'static str> {
    let mut found = Vec::new();
    for key in keys {
        if !found.contains(key) {
            found.push(*key);
        }
    }
    found
}

/// Keys of materials that exclude each other.
pub(super) fn rivals() -> Vec<Vec<&'static str>> {
    let mut rivals = vec![KINDS.clone()];
    for own in declarations() {
        let Some(within) = own.within else { continue };
        let others = declarations().filter(|other| other.main.key == own.main.key);
        let keys = others.flat_map(|other| quantities::keys(other.main.quantity));
        rivals.extend(keys.map(|key| vec![within, *key]));
    }
    rivals
}

/// Pairs of a key of a material and one that means nothing without it.
pub(super) fn companions() -> Vec<(&'static str, &'static str)> {
    let pairs = |own: Declaration| {
        own.beside
            .iter()
            .map(move |other| (own.main.key, other.key))
    };
    declarations().flat_map(pairs).collect()
}

/// Reads `[materials]`; `None` if that is no table at all.
pub(super) fn read(spectra: &Spectra<'_>, item: Option<Item<'_>>) -> Option<Materials> {
    let empty = Table::default();
    let table = match item.as_ref().map(|item| (item, &item.node.value)) {
        None => &empty,
        Some((_, Value::Table(table))) => table,
        Some((item, _)) => return item.wrong_type("a table of named materials"),
    };
    let read = table.entries.iter().map(|entry| {
        let name = entry.key.clone();
        let item = Item {
            report: spectra.report,
            path: format!("materials.{name}"),
            node: &entry.node,
        };
        let fields = Fields::open(item, &KEYS)?;
        let surface = surface(spectra, &fields);
        let emission = emission(spectra, &fields);
        let (surface, emission) = (surface?, emission?);
        let value = Material { surface, emission };
        Some(Named { name, value })
    });
    Some(Materials {
        names: table
            .entries
            .iter()
            .map(|entry| entry.key.clone())
            .collect(),
        checked: every(read),
    })
}

fn surface(spectra: &Spectra<'_>, fields: &Fields<'_>) -> Option<Surface> {
    let found = fields.at_most_one(&KINDS)?;
    lonely(fields, found.as_ref().map(|(key, _)| *key))?;
    let Some((key, item)) = found else {
        return Some(Surface {
            kind: MaterialKind::Black,
            values: Vec::new(),
        });
    };
    let kind = kind(key, item.node)?;
    let main = main(spectra, item, kind);
    let beside = quantities::all(spectra, fields, kind.declaration().beside);
    let values = [main?, beside?].concat();
    Some(Surface { kind, values })
}

/// The kind that a key means with this value.
fn kind(key: &str, node: &Node) -> Option<MaterialKind> {
    let kinds = MaterialKind::ALL.iter().copied();
    let mut kinds = kinds.filter(|kind| kind.declaration().main.key == key);
    let within = |kind: &MaterialKind| match (kind.declaration().within, &node.value) {
        (Some(within), Value::Table(table)) => table.get(within).is_some(),
        _ => false,
    };
    let plain = |kind: &MaterialKind| kind.declaration().within.is_none();
    let named = kinds.clone().find(within);
    named
        .or_else(|| kinds.clone().find(plain))
        .or_else(|| kinds.next())
}

/// Reads the main value of a kind.
fn main(spectra: &Spectra<'_>, item: Item<'_>, kind: MaterialKind) -> Option<Vec<declare::Value>> {
    let own = kind.declaration();
    let others = declarations().filter(|other| other.main.key == own.main.key);
    let Some(within) = own.within else {
        let parameter = |other: Declaration| {
            let key = other.within?;
            Some(Parameter { key, ..other.main })
        };
        let others: Vec<_> = others.filter_map(parameter).collect();
        return quantities::read(spectra, item, own.main.quantity, &others);
    };
    let keys = others.flat_map(|other| {
        let keys = quantities::keys(other.main.quantity).iter().copied();
        keys.chain(other.within)
    });
    let keys: Vec<&str> = keys.collect();
    let fields = Fields::open(item, &keys)?;
    for key in keys.iter().filter(|key| **key != within) {
        fields.at_most_one(&[within, *key])?;
    }
    let quantity = own.main.quantity;
    let expected = format!("{within} = {}", quantities::form(quantity));
    fields.required(within, &expected, |item| {
        quantities::read(spectra, item, quantity, &[])
    })
}

/// Complains of a key that belongs to a kind other than that of the key `kind`.
fn lonely(fields: &Fields<'_>, kind: Option<&str>) -> Option<()> {
    for (owner, key) in companions() {
        let owned = companions().contains(&(kind.unwrap_or_default(), key));
        if let (false, Some(entry)) = (owned, fields.table.entry(key)) {
            let message = format!("{} without a {owner}", fields.path(key));
            let value = declarations().find(|own| own.main.key == owner);
            let value = value.map_or("", |own| quantities::form(own.main.quantity));
            return fields.report.fail(
                entry.key_place,
                message,
                format!("{owner} = {value} besides"),
            );
        }
    }
    Some(())
}

fn emission(spectra: &Spectra<'_>, fields: &Fields<'_>) -> Option<Option<Emission>> {
    let sides = fields.optional("sides", Sides::Front, |item| {
        item.choice(&Sides::ALL, Sides::name)
    });
    if let (None, Some(entry)) = (fields.get("emit"), fields.table.entry("sides")) {
        let message = format!("{} without emit", fields.path("sides"));
        let names = one_of(&Sides::ALL.map(Sides::name));
        let expected = format!("emit = spectrum besides sides = {names}");
        return spectra.report.fail(entry.key_place, message, expected);
    }
    let radiance = fields.maybe("emit", |item| spectra.spectrum(&item, Role::Emission));
    let (radiance, sides) = (radiance?, sides?);
    Some(radiance.map(|radiance| Emission { radiance, sides }))
}
