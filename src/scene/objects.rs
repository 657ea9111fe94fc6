//! Reading objects and their shapes.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::fields::{Fields, Item, every, one_of};
use super::implicit::{self, DefaultFinder};
use super::transform;
use super::tree::Value;
use super::{Named, Object, Shape};
use crate::math::affine::Affine;
use crate::shape::{Length, ShapeKind};

/// Names of all shapes.
pub(super) const SHAPES: &[&str] = &{
    let mut names = ["implicit"; ShapeKind::ALL.len() + 1];
    let mut i = 0;
    while i < ShapeKind::ALL.len() {
        names[i] = ShapeKind::ALL[i].name();
        i += 1;
    }
    names
};

const KEYS: &[&str] = &["name", "shape", "material", "transform"];

/// A shape as written: canonical form, its size, and where its centre is.
struct Sized {
    shape: Shape,
    size: DVec3,
    center: DVec3,
}

/// Reads `[[object]]`. With `hidden`, the materials could not be read and are not looked up.
pub(super) fn read(
    item: Option<Item<'_>>,
    materials: &[String],
    hidden: bool,
    finder: &DefaultFinder,
) -> Option<Vec<Named<Object>>> {
    let Some(item) = item else {
        return Some(Vec::new());
    };
    let nodes = item.nodes("[[object]] tables")?;
    let indices: HashMap<&str, usize> = materials
        .iter()
        .enumerate()
        .map(|(i, name)| (name.as_str(), i))
        .collect();
    let find = |item: Item<'_>| {
        let name = item.text()?;
        if hidden {
            return Some(0);
        }
        indices.get(name).copied().or_else(|| {
            let names: Vec<&str> = materials.iter().map(String::as_str).collect();
            let message = format!("the material \"{name}\" is not defined");
            item.unknown(message, name, &names)
        })
    };
    let mut used = HashSet::new();
    let nodes = nodes.iter().enumerate();
    every(nodes.map(|(index, node)| {
        let item = Item {
            node,
            ..item.clone()
        };
        object(item, index, finder, &find, &mut used)
    }))
}

fn object(
    item: Item<'_>,
    index: usize,
    finder: &DefaultFinder,
    find: &impl Fn(Item<'_>) -> Option<usize>,
    used: &mut HashSet<String>,
) -> Option<Named<Object>> {
    let fields = Fields::open(item, KEYS)?;
    let name = fields.maybe("name", |item| {
        let name = item.text()?.to_owned();
        if used.insert(name.clone()) {
            return Some(name);
        }
        let message = format!("the object name \"{name}\" is used twice");
        item.fail(message, "a name of its own")
    });
    let sized = fields.required("shape", &one_of(SHAPES), |item| shape(item, finder));
    let material = fields.required("material", "the name of a material", find);
    let to_world = fields.maybe("transform", |item| transform::read(&item));
    let sized = sized?;
    let to_world = place(to_world?, &sized);
    let written = fields.get("transform").or(fields.get("shape"));
    let written = written.map_or(fields.place, |node| node.place);
    transform::check(fields.report, written, &to_world)?;
    let name = name?.unwrap_or_else(|| format!("{} #{index}", sized.shape.name()));
    Some(Named {
        name,
        value: Object {
            shape: sized.shape,
            material: material?,
            size: sized.size,
            to_world,
        },
    })
}

/// Transform after centre after size. Where one of them is the identity it is left out, because
/// multiplying by it could still change the sign of a zero.
fn place(transform: Option<Affine>, sized: &Sized) -> Affine {
    let steps = [
        (sized.size != DVec3::ONE).then(|| Affine::scale(sized.size)),
        (sized.center != DVec3::ZERO).then(|| Affine::translate(sized.center)),
        transform,
    ];
    steps
        .into_iter()
        .flatten()
        .reduce(|first, then| then.after(&first))
        .unwrap_or(Affine::IDENTITY)
}

fn shape(item: Item<'_>, finder: &DefaultFinder) -> Option<Sized> {
    match &item.node.value {
        Value::Text(_) => {
            let kind = item.choice(ShapeKind::ALL, ShapeKind::name)?;
            Some(plain(Shape::Canonical(kind)))
        }
        Value::Table(table) if table.get("implicit").is_some() => {
            Some(plain(Shape::Implicit(implicit::read(item, finder)?)))
        }
        Value::Table(_) => {
            let (name, item) = Fields::open(item, SHAPES)?.exactly_one(SHAPES)?;
            let kind = ShapeKind::ALL.iter().find(|kind| kind.name() == name)?;
            sized(*kind, item)
        }
        _ => {
            let shapes = one_of(SHAPES);
            item.wrong_type(format!("the name of a shape or a table with {shapes}"))
        }
    }
}

fn plain(shape: Shape) -> Sized {
    Sized {
        shape,
        size: DVec3::ONE,
        center: DVec3::ZERO,
    }
}

/// A canonical shape with the sizes that it declares.
fn sized(kind: ShapeKind, item: Item<'_>) -> Option<Sized> {
    let lengths = kind.lengths();
    let center = kind.is_centered().then_some("center");
    let keys: Vec<&str> = lengths.iter().map(|own| own.key).chain(center).collect();
    let fields = Fields::open(item, &keys)?;
    for (i, one) in lengths.iter().enumerate() {
        for other in &lengths[i + 1..] {
            if one.axes.iter().any(|axis| other.axes.contains(axis)) {
                fields.at_most_one(&[one.key, other.key])?;
            }
        }
    }
    let mut size = DVec3::ONE;
    for own in lengths {
        let usual = own.default.map(|default| own.share * default);
        for &axis in own.axes {
            size[axis] = usual.unwrap_or(size[axis]);
        }
    }
    let read = lengths
        .iter()
        .filter_map(|own| Some((own, fields.item(own.key)?)));
    let read = every(read.map(|(own, item)| stretch(&item, own, &mut size)));
    let center = fields.optional("center", DVec3::ZERO, |item| item.vector());
    read?;
    Some(Sized {
        shape: Shape::Canonical(kind),
        size,
        center: center?,
    })
}

/// Reads a length and stretches the axes that it is about.
fn stretch(item: &Item<'_>, own: &Length, size: &mut DVec3) -> Option<()> {
    let numbers = match (own.each, own.axes.len()) {
        (false, count) => vec![item.positive()?; count],
        (true, 2) => lengths::<2>(item)?.to_vec(),
        (true, _) => lengths::<3>(item)?.to_vec(),
    };
    for (&axis, number) in own.axes.iter().zip(numbers) {
        size[axis] = own.share * number;
    }
    Some(())
}

/// `N` numbers above zero.
fn lengths<const N: usize>(item: &Item<'_>) -> Option<[f64; N]> {
    let numbers = item.numbers()?;
    for entry in item.list("")? {
        entry.positive()?;
    }
    Some(numbers)
}
