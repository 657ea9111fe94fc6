//! Reading objects and their shapes.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::fields::{Fields, Report, every, one_of};
use super::implicit::{self, DefaultFinder};
use super::transform;
use super::tree::{Node, Value};
use super::{Named, Object, Shape};
use crate::math::affine::Affine;
use crate::shape::{Length, ShapeKind};

/// Names of all shapes.
pub(super) const SHAPES: &[&str] = &{
    let mut names = ["implicit"; ShapeKind::NAMES.len() + 1];
    let mut i = 0;
    while i < ShapeKind::NAMES.len() {
        names[i] = ShapeKind::NAMES[i];
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
    report: &Report,
    node: Option<&Node>,
    materials: &[String],
    hidden: bool,
    finder: &DefaultFinder,
) -> Option<Vec<Named<Object>>> {
    let Some(node) = node else {
        return Some(Vec::new());
    };
    let nodes = report.list("object", node, "[[object]] tables")?;
    let indices: HashMap<&str, usize> = materials
        .iter()
        .enumerate()
        .map(|(i, name)| (name.as_str(), i))
        .collect();
    let find = |what: &str, node: &Node| {
        let name = report.text(what, node)?;
        if hidden {
            return Some(0);
        }
        indices.get(name).copied().or_else(|| {
            let names: Vec<&str> = materials.iter().map(String::as_str).collect();
            let message = format!("the material \"{name}\" is not defined");
            report.unknown(node.place, message, name, &names)
        })
    };
    let mut used = HashSet::new();
    let nodes = nodes.iter().enumerate();
    every(nodes.map(|(index, node)| object(report, node, index, finder, &find, &mut used)))
}

fn object(
    report: &Report,
    node: &Node,
    index: usize,
    finder: &DefaultFinder,
    find: &impl Fn(&str, &Node) -> Option<usize>,
    used: &mut HashSet<String>,
) -> Option<Named<Object>> {
    let fields = Fields::open(report, "object", node, KEYS)?;
    let name = fields.optional("name", None, |what, node| {
        let name = report.text(what, node)?.to_owned();
        if used.insert(name.clone()) {
            return Some(Some(name));
        }
        let message = format!("the object name \"{name}\" is used twice");
        report.fail(node.place, message, "a name of its own")
    });
    let sized = fields.required("shape", &one_of(SHAPES), |_, node| {
        shape(report, node, finder)
    });
    let material = fields.required("material", "the name of a material", find);
    let to_world = fields.optional("transform", None, |what, node| {
        transform::read(report, what, node).map(Some)
    });
    let sized = sized?;
    let to_world = place(to_world?, &sized);
    let written = fields
        .get("transform")
        .or(fields.get("shape"))
        .unwrap_or(node);
    transform::check(report, written.place, &to_world)?;
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

fn shape(report: &Report, node: &Node, finder: &DefaultFinder) -> Option<Sized> {
    match &node.value {
        Value::Text(_) => {
            let kind = report.choice("object.shape", node, ShapeKind::ALL, ShapeKind::name)?;
            Some(plain(Shape::Canonical(kind), DVec3::ONE))
        }
        Value::Table(table) if table.get("implicit").is_some() => {
            let implicit = implicit::read(report, node, finder)?;
            Some(plain(Shape::Implicit(implicit), DVec3::ONE))
        }
        Value::Table(_) => {
            let fields = Fields::open(report, "object.shape", node, SHAPES)?;
            let (name, inner) = fields.exactly_one(SHAPES)?;
            let kind = ShapeKind::ALL.iter().find(|kind| kind.name() == name)?;
            sized(report, *kind, inner)
        }
        _ => report.wrong_type(
            "object.shape",
            node,
            &format!("the name of a shape or a table with {}", one_of(SHAPES)),
        ),
    }
}

fn plain(shape: Shape, size: DVec3) -> Sized {
    Sized {
        shape,
        size,
        center: DVec3::ZERO,
    }
}

/// A canonical shape with the sizes that it declares.
fn sized(report: &Report, kind: ShapeKind, node: &Node) -> Option<Sized> {
    let lengths = kind.lengths();
    let center = kind.is_centered().then_some("center");
    let keys: Vec<&str> = lengths.iter().map(|own| own.key).chain(center).collect();
    let what = format!("object.shape.{}", kind.name());
    let fields = Fields::open(report, what, node, &keys)?;
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
    // All are read before any is missed, so that nothing that is wrong goes unsaid.
    let read: Vec<Option<()>> = lengths
        .iter()
        .filter_map(|own| Some((own, fields.get(own.key)?)))
        .map(|(own, node)| stretch(report, &fields.path(own.key), node, own, &mut size))
        .collect();
    let center = fields.optional("center", DVec3::ZERO, |what, node| {
        report.vector(what, node)
    });
    read.into_iter().collect::<Option<()>>()?;
    Some(Sized {
        shape: Shape::Canonical(kind),
        size,
        center: center?,
    })
}

/// Reads a length and stretches the axes that it is about.
fn stretch(report: &Report, what: &str, node: &Node, own: &Length, size: &mut DVec3) -> Option<()> {
    let numbers = match (own.each, own.axes.len()) {
        (false, count) => vec![report.positive(what, node)?; count],
        (true, 2) => lengths::<2>(report, what, node)?.to_vec(),
        (true, _) => lengths::<3>(report, what, node)?.to_vec(),
    };
    for (&axis, number) in own.axes.iter().zip(numbers) {
        size[axis] = own.share * number;
    }
    Some(())
}

/// `N` numbers above zero.
fn lengths<const N: usize>(report: &Report, what: &str, node: &Node) -> Option<[f64; N]> {
    let numbers = report.numbers(what, node)?;
    if let Value::List(nodes) = &node.value {
        for (i, node) in nodes.iter().enumerate() {
            report.positive(&format!("{what}[{i}]"), node)?;
        }
    }
    Some(numbers)
}
