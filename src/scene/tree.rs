//! The TOML document as a tree in which every key and value knows where it was written.
//!
//! Panels and settings lay parts of other origins over the file's own, so a place is a pair of
//! origin and byte range.

use std::ops::Range;

use toml_edit::{Document, Item, TableLike, TomlError};

use super::error::{Diagnostic, Origin};

/// Where something was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    /// Index into [`Origins`]; 0 is the file.
    pub origin: usize,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Place {
    pub fn new(origin: usize, bytes: Range<usize>) -> Self {
        Self {
            origin,
            start: bytes.start,
            end: bytes.end,
        }
    }
}

/// The texts that places refer to.
pub(super) struct Origins {
    pub texts: Vec<(Origin, String)>,
}

impl Origins {
    /// A diagnostic at a place.
    pub fn diagnostic(&self, place: Place, message: String) -> Diagnostic {
        let (origin, text) = &self.texts[place.origin];
        Diagnostic::at(origin.clone(), text, place.start, place.end, message)
    }
}

/// A value and its place.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub place: Place,
    pub value: Value,
    /// A number or string as it was written, quotes included.
    pub written: Option<Box<str>>,
}

/// The kinds of values TOML has.
#[derive(Debug, Clone)]
pub(super) enum Value {
    Integer(i64),
    Float(f64),
    Bool(bool),
    Text(String),
    Date,
    List(Vec<Node>),
    Table(Table),
}

/// Keys and values in the order of the file.
#[derive(Debug, Clone, Default)]
pub(super) struct Table {
    pub entries: Vec<Entry>,
}

/// A key with its value.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub key: String,
    pub key_place: Place,
    pub node: Node,
}

impl Node {
    pub fn new(place: Place, value: Value) -> Self {
        Self {
            place,
            value,
            written: None,
        }
    }

    pub fn table_mut(&mut self) -> Option<&mut Table> {
        match &mut self.value {
            Value::Table(table) => Some(table),
            _ => None,
        }
    }

    /// What the value is, for messages.
    pub fn kind(&self) -> &'static str {
        match &self.value {
            Value::Integer(_) => "an integer",
            Value::Float(_) => "a number",
            Value::Bool(_) => "a boolean",
            Value::Text(_) => "a string",
            Value::Date => "a date",
            Value::List(_) => "an array",
            Value::Table(_) => "a table",
        }
    }
}

impl Entry {
    pub fn new(key: &str, key_place: Place, node: Node) -> Self {
        Self {
            key: key.to_owned(),
            key_place,
            node,
        }
    }
}

impl Table {
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|entry| &entry.node)
    }

    pub fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    pub fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        let mut entries = self.entries.iter_mut();
        entries.find(|e| e.key == key).map(|entry| &mut entry.node)
    }

    /// Adds an entry, or replaces the one of its key.
    pub fn put(&mut self, entry: Entry) {
        match self.entries.iter_mut().find(|e| e.key == entry.key) {
            Some(existing) => *existing = entry,
            None => self.entries.push(entry),
        }
    }

    pub fn remove(&mut self, key: &str) -> Option<Node> {
        let index = self.entries.iter().position(|e| e.key == key)?;
        Some(self.entries.remove(index).node)
    }
}

/// Reads a whole document. `shift` is subtracted from every byte position (for a document that
/// was made from an argument by putting something before it).
pub(super) fn parse(text: &str, origin: usize, shift: usize) -> Result<Table, TomlError> {
    let document = Document::parse(text)?;
    let reader = Reader {
        text,
        origin,
        shift,
    };
    Ok(reader.table(document.as_table(), Place::new(origin, 0..0)))
}

struct Reader<'a> {
    text: &'a str,
    origin: usize,
    shift: usize,
}

impl Reader<'_> {
    fn place(&self, span: Option<Range<usize>>, otherwise: Place) -> Place {
        span.map_or(otherwise, |span| {
            let [start, end] = [span.start, span.end].map(|byte| byte.saturating_sub(self.shift));
            Place::new(self.origin, start..end)
        })
    }

    fn table(&self, table: &dyn TableLike, place: Place) -> Table {
        let mut entries = Vec::with_capacity(table.len());
        for (name, item) in table.iter() {
            let key_span = table.key(name).and_then(toml_edit::Key::span);
            let key_place = self.place(key_span, place);
            let node = self.item(item, key_place);
            entries.extend(node.map(|node| Entry::new(name, key_place, node)));
        }
        Table { entries }
    }

    fn item(&self, item: &Item, key_place: Place) -> Option<Node> {
        let place = self.place(item.span(), key_place);
        let value = match item {
            Item::None => return None,
            Item::Value(value) => return Some(self.value(value, key_place)),
            Item::Table(table) => Value::Table(self.table(table, place)),
            Item::ArrayOfTables(tables) => {
                let node = |table: &toml_edit::Table| {
                    let place = self.place(table.span(), place);
                    Node::new(place, Value::Table(self.table(table, place)))
                };
                Value::List(tables.iter().map(node).collect())
            }
        };
        Some(Node::new(place, value))
    }

    fn value(&self, value: &toml_edit::Value, key_place: Place) -> Node {
        let span = value.span();
        let place = self.place(span.clone(), key_place);
        let value = match value {
            toml_edit::Value::String(text) => Value::Text(text.value().clone()),
            toml_edit::Value::Integer(number) => Value::Integer(*number.value()),
            toml_edit::Value::Float(number) => Value::Float(*number.value()),
            toml_edit::Value::Boolean(truth) => Value::Bool(*truth.value()),
            toml_edit::Value::Datetime(_) => Value::Date,
            toml_edit::Value::Array(list) => {
                Value::List(list.iter().map(|v| self.value(v, place)).collect())
            }
            toml_edit::Value::InlineTable(table) => Value::Table(self.table(table, place)),
        };
        let scalar = matches!(value, Value::Integer(_) | Value::Float(_) | Value::Text(_));
        let text = |span| self.text.get(span).map(Box::from);
        let written = span.filter(|_| scalar).and_then(text);
        Node {
            place,
            value,
            written,
        }
    }
}
