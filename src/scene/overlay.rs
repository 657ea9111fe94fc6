//! Laying panels and settings over the file.

use super::fields::Report;
use super::tree::{self, Entry, Node, Place, Table, Value};
use super::{ProjectionKind, materials};

/// Keys that exclude each other. When something laid over brings one of them, the others give
/// way, so that a panel can turn a diffuse wall into a mirror without a contradiction.
const RIVALS: &[&[&str]] = &[
    ProjectionKind::KEYS,
    &[
        "table",
        "csv",
        "blackbody",
        "rgb",
        "name",
        "constant",
        "radiance",
    ],
    &["ior", "cauchy", "sellmeier"],
    super::objects::SHAPES,
];

/// Keys that mean nothing without a rival that has given way.
const COMPANIONS: &[(&str, &str)] = &[
    ("table", "scale"),
    ("csv", "scale"),
    ("blackbody", "scale"),
    ("rgb", "scale"),
    ("name", "scale"),
    ("constant", "scale"),
    ("implicit", "inside"),
    ("implicit", "parameters"),
    ("implicit", "closed"),
    ("implicit", "finder"),
    ("implicit", "steps"),
];

/// Deepest path of a setting.
const DEPTH: usize = 32;

/// Lays `over` over `base`: tables are merged key by key, anything else is replaced.
pub(super) fn merge(base: &mut Table, over: &Table) {
    for entry in &over.entries {
        give_way(base, &entry.key);
        match base.entries.iter_mut().find(|e| e.key == entry.key) {
            Some(Entry {
                node:
                    Node {
                        value: Value::Table(old),
                        ..
                    },
                ..
            }) if matches!(entry.node.value, Value::Table(_)) => {
                if let Value::Table(new) = &entry.node.value {
                    merge(old, new);
                }
            }
            Some(existing) => *existing = entry.clone(),
            None => base.entries.push(entry.clone()),
        }
    }
}

/// Removes the rivals of `key` (and what belongs to them) from a table it is laid over.
fn give_way(base: &mut Table, key: &str) {
    let materials = materials::rivals();
    let groups = RIVALS.iter().copied();
    let groups = groups.chain(materials.iter().map(Vec::as_slice));
    let companions = [COMPANIONS, &materials::companions()].concat();
    for group in groups.filter(|group| group.contains(&key)) {
        for rival in group.iter().filter(|rival| **rival != key) {
            if base.get(rival).is_none() {
                continue;
            }
            base.entries.retain(|e| e.key != *rival);
            for (_, companion) in companions.iter().filter(|(owner, _)| owner == rival) {
                base.entries.retain(|e| e.key != *companion);
            }
        }
    }
}

/// Has all implicit surfaces found by one finder: the image's, instead of their own.
pub(super) fn use_finder(root: &mut Table, place: Place, name: &str) {
    if let Some(objects) = root.entries.iter_mut().find(|e| e.key == "object")
        && let Value::List(objects) = &mut objects.node.value
    {
        for object in objects {
            if let Value::Table(object) = &mut object.value
                && let Some(shape) = object.entries.iter_mut().find(|e| e.key == "shape")
                && let Value::Table(shape) = &mut shape.node.value
            {
                shape.entries.retain(|e| e.key != "finder");
            }
        }
    }
    if let Some(image) = root.entries.iter_mut().find(|e| e.key == "image")
        && let Value::Table(image) = &mut image.node.value
    {
        image.entries.retain(|e| e.key != "finder");
        image.entries.push(Entry {
            key: "finder".to_owned(),
            key_place: place,
            node: Node::new(place, Value::Text(name.to_owned())),
        });
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
        if keys.len() > DEPTH {
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
        if let Some((last, way)) = self.path.split_last() {
            self.descend(report, root, way, last, 0);
        }
    }

    fn descend(
        &self,
        report: &Report,
        table: &mut Table,
        way: &[String],
        last: &str,
        depth: usize,
    ) {
        let Some((key, way)) = way.split_first() else {
            give_way(table, last);
            self.put(table, last);
            return;
        };
        give_way(table, key);
        if table.get(key).is_none() {
            table.entries.push(Entry {
                key: key.clone(),
                key_place: self.key_place,
                node: Node::new(self.key_place, Value::Table(Table::default())),
            });
        }
        if let Some(entry) = table.entries.iter_mut().find(|e| e.key == *key) {
            self.enter(report, &mut entry.node, way, last, depth + 1);
        }
    }

    fn put(&self, table: &mut Table, key: &str) {
        let entry = Entry {
            key: key.to_owned(),
            key_place: self.key_place,
            node: self.node.clone(),
        };
        match table.entries.iter_mut().find(|e| e.key == key) {
            Some(existing) => *existing = entry,
            None => table.entries.push(entry),
        }
    }

    fn enter(&self, report: &Report, node: &mut Node, way: &[String], last: &str, depth: usize) {
        let done = self.path[..depth].join(".");
        let kind = node.kind();
        match &mut node.value {
            Value::Table(table) => self.descend(report, table, way, last, depth),
            Value::List(nodes) => {
                let (key, rest) = way
                    .split_first()
                    .map_or((last, None), |(key, rest)| (key.as_str(), Some(rest)));
                let count = nodes.len();
                let found = key.parse::<usize>().ok().and_then(|i| nodes.get_mut(i));
                match (found, rest) {
                    (Some(node), Some(rest)) => self.enter(report, node, rest, last, depth + 1),
                    (Some(node), None) => *node = self.node.clone(),
                    (None, _) => {
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
