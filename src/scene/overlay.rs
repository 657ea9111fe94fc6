//! Laying panels and settings over the file.

use std::sync::LazyLock;

use super::fields::Report;
use super::tree::{self, Entry, Node, Place, Table, Value};
use super::{ProjectionKind, implicit, index, materials, objects, spectra};

/// Deepest path of a setting.
const DEPTH: usize = 32;

/// Keys that exclude each other. When something laid over brings one of them, the others give
/// way, so that a panel can turn a diffuse wall into a mirror without a contradiction.
static RIVALS: LazyLock<Vec<Vec<&str>>> = LazyLock::new(|| {
    let mut rivals = materials::rivals();
    rivals.push([spectra::KINDS, &["radiance"]].concat());
    rivals.extend([ProjectionKind::KEYS, index::GLASS_KEYS, objects::SHAPES].map(<[_]>::to_vec));
    rivals
});

/// Pairs of a key and one that means nothing without it.
static COMPANIONS: LazyLock<Vec<(&str, &str)>> = LazyLock::new(|| {
    let mut companions = materials::companions();
    companions.extend(spectra::KINDS.iter().map(|kind| (*kind, "scale")));
    companions.extend(implicit::KEYS.map(|key| ("implicit", key)));
    companions
});

/// Lays `over` over `base`: tables are merged key by key, anything else is replaced.
pub(super) fn merge(base: &mut Table, over: &Table) {
    for entry in &over.entries {
        give_way(base, &entry.key);
        let old = base.get_mut(&entry.key).and_then(Node::table_mut);
        match (old, &entry.node.value) {
            (Some(old), Value::Table(new)) => merge(old, new),
            _ => base.put(entry.clone()),
        }
    }
}

/// Removes the rivals of `key` (and what belongs to them) from a table it is laid over.
fn give_way(base: &mut Table, key: &str) {
    let groups = RIVALS.iter().filter(|group| group.contains(&key));
    for rival in groups.flatten().filter(|rival| **rival != key) {
        if base.remove(rival).is_some() {
            for (_, companion) in COMPANIONS.iter().filter(|(owner, _)| owner == rival) {
                base.remove(companion);
            }
        }
    }
}

/// Has all implicit surfaces found by one finder: the image's, instead of their own.
pub(super) fn use_finder(root: &mut Table, place: Place, name: &str) {
    if let Some(objects) = root.get_mut("object")
        && let Value::List(objects) = &mut objects.value
    {
        for object in objects.iter_mut().filter_map(Node::table_mut) {
            if let Some(shape) = object.get_mut("shape").and_then(Node::table_mut) {
                shape.remove("finder");
            }
        }
    }
    if let Some(image) = root.get_mut("image").and_then(Node::table_mut) {
        let node = Node::new(place, Value::Text(name.to_owned()));
        image.put(Entry::new("finder", place, node));
    }
}

/// One setting: a path and a value.
#[derive(Debug, Clone)]
pub(super) struct Setting {
    path: Vec<String>,
    key_place: Place,
    node: Node,
}

impl Setting {
    /// Reads `key` and `value`; the argument's text is `key=value`, its origin `origin`.
    pub fn parse(report: &Report, origin: usize, key: &str, value: &str) -> Option<Self> {
        let key_place = Place::new(origin, 0..key.len());
        let Ok(keys) = toml_edit::Key::parse(key) else {
            let expected = "dotted keys, such as camera.lens.radius=0.3";
            return report.fail(key_place, format!("\"{key}\" is not a path"), expected);
        };
        if !(1..=DEPTH).contains(&keys.len()) {
            let message = format!("path of {} keys", keys.len());
            return report.fail(key_place, message, format!("at most {DEPTH} keys"));
        }
        Some(Self {
            path: keys.iter().map(|key| key.get().to_owned()).collect(),
            key_place,
            node: parse_value(report, key_place, value)?,
        })
    }

    /// Whether it changes a panel rather than the file's own scene.
    pub fn is_for_panels(&self) -> bool {
        self.path.first().is_some_and(|key| key == "panel")
    }

    /// Lays the value over the document; tables on the way are made where there are none.
    pub fn apply(&self, report: &Report, root: &mut Table) {
        self.descend(report, root, 0);
    }

    /// Goes on in a table, by the key at this depth of the path.
    fn descend(&self, report: &Report, table: &mut Table, depth: usize) {
        let key = &self.path[depth];
        give_way(table, key);
        let entry = |node| Entry::new(key, self.key_place, node);
        if self.is_last(depth) {
            return table.put(entry(self.node.clone()));
        }
        if table.get(key).is_none() {
            let empty = Value::Table(Table::default());
            table.put(entry(Node::new(self.key_place, empty)));
        }
        if let Some(node) = table.get_mut(key) {
            self.enter(report, node, depth + 1);
        }
    }

    fn is_last(&self, depth: usize) -> bool {
        depth + 1 == self.path.len()
    }

    /// Goes on in a value that is not the last of the path.
    fn enter(&self, report: &Report, node: &mut Node, depth: usize) {
        let done = self.path[..depth].join(".");
        let kind = node.kind();
        match &mut node.value {
            Value::Table(table) => self.descend(report, table, depth),
            Value::List(nodes) => {
                let key = &self.path[depth];
                let count = nodes.len();
                match key.parse::<usize>().ok().and_then(|i| nodes.get_mut(i)) {
                    Some(node) if self.is_last(depth) => *node = self.node.clone(),
                    Some(node) => self.enter(report, node, depth + 1),
                    None => {
                        let message = format!("{done} has no entry \"{key}\"");
                        let expected = match count {
                            0 => "nothing, as the array is empty".to_owned(),
                            _ => format!("an index from 0 to {}", count - 1),
                        };
                        report.fail::<()>(self.key_place, message, expected);
                    }
                }
            }
            _ => {
                let message = format!("{done} is {kind} and has no keys");
                let expected = "the path of a value, or of a table or array that holds it";
                report.fail::<()>(self.key_place, message, expected);
            }
        }
    }
}

/// A TOML value, or a bare word as a string.
fn parse_value(report: &Report, key_place: Place, value: &str) -> Option<Node> {
    const BEFORE: &str = "v = ";
    let origin = key_place.origin;
    let begin = key_place.end + 1;
    let place = Place::new(origin, begin..begin + value.len());
    // Positions are shifted so that they count from the start of the argument: first the words
    // put before the value are taken off, then the key is added.
    let mut padded = " ".repeat(begin);
    padded.push_str(BEFORE);
    padded.push_str(value);
    match tree::parse(&padded, origin, BEFORE.len()) {
        Ok(table) if table.entries.len() == 1 => {
            table.entries.into_iter().next().map(|entry| entry.node)
        }
        Ok(_) => report.fail(place, "the argument holds more than one value", "one value"),
        Err(_) if is_bare_word(value) => Some(Node {
            place,
            value: Value::Text(value.to_owned()),
            written: Some(value.into()),
        }),
        Err(error) => report.fail(
            place,
            format!("not a value: {}", error.message().trim()),
            "a TOML value, or a word",
        ),
    }
}

/// Words that need no quotes: names such as N-SF11, f32, data/lamp.csv.
fn is_bare_word(value: &str) -> bool {
    value.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && !value.contains(|c: char| c.is_control() || "\"'[]{}=,#".contains(c))
}
