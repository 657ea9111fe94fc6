//! Typed reading of tree nodes, and the collection of complaints.
//!
//! A reader that meets something wrong adds a complaint and returns `None`; reading goes on, so
//! that in the end the first complaint in the order of the file can be shown.

use std::cell::{Cell, RefCell};
use std::ops::RangeInclusive;

use glam::DVec3;

use super::names::{nearest, one_of};
use super::tree::{Node, Place, Table, Value};

/// Something wrong at a place.
#[derive(Debug, Clone)]
pub(super) struct Complaint {
    pub place: Place,
    pub message: String,
    pub expected: Option<String>,
    pub suggestion: Option<String>,
    /// Something that ought to be there is not (and a panel may yet bring it).
    pub missing: bool,
}

impl Complaint {
    pub fn new(place: Place, message: impl Into<String>) -> Self {
        Self {
            place,
            message: message.into(),
            expected: None,
            suggestion: None,
            missing: false,
        }
    }

    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    pub fn suggest(mut self, suggestion: Option<String>) -> Self {
        self.suggestion = suggestion;
        self
    }
}

/// All complaints so far.
#[derive(Debug, Default)]
pub(super) struct Report {
    complaints: RefCell<Vec<Complaint>>,
    searches: Cell<usize>,
}

/// A file with thousands of misspelt names among thousands of names should still be answered at
/// once, so only this many are looked up.
const SEARCHES: usize = 64;

impl Report {
    pub fn add(&self, complaint: Complaint) {
        self.complaints.borrow_mut().push(complaint);
    }

    /// Adds a complaint and returns `None`, which is what a reader then returns.
    pub fn fail<T>(&self, complaint: Complaint) -> Option<T> {
        self.add(complaint);
        None
    }

    /// The complaint whose place comes first.
    pub fn first(self) -> Option<Complaint> {
        let complaints = self.complaints.into_inner();
        complaints.into_iter().min_by_key(|c| c.place)
    }

    /// Takes over the complaints of another report that pass a filter.
    pub fn absorb(&self, other: Self, keep: impl Fn(&Complaint) -> bool) {
        let complaints = other.complaints.into_inner();
        self.complaints
            .borrow_mut()
            .extend(complaints.into_iter().filter(|c| keep(c)));
    }

    /// Complains that `name` is none of `names`.
    pub fn unknown<T>(
        &self,
        place: Place,
        message: String,
        name: &str,
        names: &[&str],
    ) -> Option<T> {
        let search = self.searches.get() < SEARCHES;
        self.searches.set(self.searches.get() + 1);
        let suggestion = if search { nearest(name, names) } else { None };
        self.fail(
            Complaint::new(place, message)
                .expected(one_of(names))
                .suggest(suggestion),
        )
    }

    pub fn wrong_type<T>(&self, what: &str, node: &Node, expected: &str) -> Option<T> {
        self.fail(
            Complaint::new(node.place, format!("{what} is {}", node.kind())).expected(expected),
        )
    }

    /// A finite number.
    pub fn number(&self, what: &str, node: &Node) -> Option<f64> {
        let expected = "a finite number";
        match &node.value {
            #[expect(
                clippy::cast_precision_loss,
                reason = "a number written without a point means the nearest f64"
            )]
            Value::Integer(number) => Some(*number as f64),
            Value::Float(number) if number.is_finite() => Some(*number),
            Value::Float(number) => {
                let name = if number.is_nan() { "NaN" } else { "infinite" };
                self.fail(
                    Complaint::new(node.place, format!("{what} is {name}")).expected(expected),
                )
            }
            _ => self.wrong_type(what, node, expected),
        }
    }

    /// A finite number that passes a test.
    pub fn number_that(
        &self,
        what: &str,
        node: &Node,
        expected: &str,
        test: impl Fn(f64) -> bool,
    ) -> Option<f64> {
        let number = self.number(what, node)?;
        if test(number) {
            return Some(number);
        }
        self.fail(Complaint::new(node.place, format!("{what} is {number}")).expected(expected))
    }

    /// A number above zero.
    pub fn positive(&self, what: &str, node: &Node) -> Option<f64> {
        self.number_that(what, node, "a number greater than 0", |x| x > 0.0)
    }

    /// An integer in a range.
    pub fn integer(&self, what: &str, node: &Node, range: RangeInclusive<i64>) -> Option<i64> {
        let expected = format!("an integer from {} to {}", range.start(), range.end());
        match &node.value {
            Value::Integer(number) if range.contains(number) => Some(*number),
            Value::Integer(number) => self
                .fail(Complaint::new(node.place, format!("{what} is {number}")).expected(expected)),
            Value::Float(number) => self.fail(
                Complaint::new(node.place, format!("{what} is {number:?}")).expected(expected),
            ),
            _ => self.wrong_type(what, node, &expected),
        }
    }

    /// An integer in a range that fits 32 bits.
    pub fn count(&self, what: &str, node: &Node, range: RangeInclusive<u32>) -> Option<u32> {
        let range = i64::from(*range.start())..=i64::from(*range.end());
        u32::try_from(self.integer(what, node, range)?).ok()
    }

    pub fn text<'a>(&self, what: &str, node: &'a Node) -> Option<&'a str> {
        match &node.value {
            Value::Text(text) => Some(text),
            _ => self.wrong_type(what, node, "a string"),
        }
    }

    pub fn list<'a>(&self, what: &str, node: &'a Node, expected: &str) -> Option<&'a [Node]> {
        match &node.value {
            Value::List(nodes) => Some(nodes),
            _ => self.wrong_type(what, node, expected),
        }
    }

    /// `N` finite numbers.
    pub fn numbers<const N: usize>(&self, what: &str, node: &Node) -> Option<[f64; N]> {
        let expected = format!("an array of {N} finite numbers");
        let nodes = self.list(what, node, &expected)?;
        if nodes.len() != N {
            let message = format!("{what} has {} entries", nodes.len());
            return self.fail(Complaint::new(node.place, message).expected(expected));
        }
        let mut numbers = [0.0; N];
        for (i, (number, node)) in numbers.iter_mut().zip(nodes).enumerate() {
            *number = self.number(&format!("{what}[{i}]"), node)?;
        }
        Some(numbers)
    }

    /// A point or vector `[x, y, z]`.
    pub fn vector(&self, what: &str, node: &Node) -> Option<DVec3> {
        self.numbers(what, node).map(DVec3::from_array)
    }

    /// A vector other than zero, scaled to length 1.
    pub fn direction(&self, what: &str, node: &Node) -> Option<DVec3> {
        let vector = self.vector(what, node)?;
        if vector == DVec3::ZERO {
            let message = format!("{what} is the zero vector");
            return self
                .fail(Complaint::new(node.place, message).expected("a vector with a direction"));
        }
        // Bringing the largest component to ±1 first keeps squares from under- and overflowing
        // and leaves multiples of the axes exact.
        let scaled = vector / vector.abs().max_element();
        Some(scaled / scaled.length())
    }

    /// One of several words.
    pub fn choice<T: Copy>(&self, what: &str, node: &Node, choices: &[(&str, T)]) -> Option<T> {
        let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        let Value::Text(text) = &node.value else {
            return self.wrong_type(what, node, &one_of(&names));
        };
        match choices.iter().find(|(name, _)| name == text) {
            Some((_, choice)) => Some(*choice),
            None => self.unknown(node.place, format!("{what} is \"{text}\""), text, &names),
        }
    }
}

/// A table whose keys are known.
pub(super) struct Fields<'a> {
    pub report: &'a Report,
    /// What the table is called in messages.
    pub what: String,
    pub place: Place,
    pub table: &'a Table,
    /// A misspelt key is likely the one that seems missing, and the better complaint.
    misspelt: bool,
}

impl<'a> Fields<'a> {
    /// Opens a table and complains of every key that is not in `keys`.
    pub fn open(
        report: &'a Report,
        what: impl Into<String>,
        node: &'a Node,
        keys: &[&str],
    ) -> Option<Self> {
        let what = what.into();
        match &node.value {
            Value::Table(table) => Some(Self::of(report, what, node.place, table, keys)),
            _ => report.wrong_type(&what, node, "a table"),
        }
    }

    /// The same for a table that has no node.
    pub fn of(
        report: &'a Report,
        what: String,
        place: Place,
        table: &'a Table,
        keys: &[&str],
    ) -> Self {
        let mut misspelt = false;
        for entry in &table.entries {
            if !keys.contains(&entry.key.as_str()) {
                misspelt = true;
                let message = if what.is_empty() {
                    format!("unknown key \"{}\"", entry.key)
                } else {
                    format!("unknown key \"{}\" in {what}", entry.key)
                };
                report.unknown::<()>(entry.key_place, message, &entry.key, keys);
            }
        }
        Self {
            report,
            what,
            place,
            table,
            misspelt,
        }
    }

    /// Whether some key was not understood.
    pub fn misspelt(&self) -> bool {
        self.misspelt
    }

    pub fn get(&self, key: &str) -> Option<&'a Node> {
        self.table.get(key)
    }

    /// What a value in here is called in messages.
    pub fn path(&self, key: &str) -> String {
        if self.what.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.what)
        }
    }

    /// Complains that something is missing here.
    pub fn missing<T>(&self, message: String, expected: &str) -> Option<T> {
        if !self.misspelt {
            let mut complaint = Complaint::new(self.place, message).expected(expected);
            complaint.missing = true;
            self.report.add(complaint);
        }
        None
    }

    /// A value that must be there.
    pub fn required<T>(
        &self,
        key: &str,
        expected: &str,
        read: impl FnOnce(&str, &'a Node) -> Option<T>,
    ) -> Option<T> {
        let path = self.path(key);
        match self.get(key) {
            Some(node) => read(&path, node),
            None => self.missing(format!("{path} is missing"), expected),
        }
    }

    /// A value with a default: `Some(default)` if absent, `None` if there and wrong.
    pub fn optional<T>(
        &self,
        key: &str,
        default: T,
        read: impl FnOnce(&str, &'a Node) -> Option<T>,
    ) -> Option<T> {
        match self.get(key) {
            Some(node) => read(&self.path(key), node),
            None => Some(default),
        }
    }

    /// The one key of `keys` that is there; complains when there are none or several.
    pub fn exactly_one(&self, keys: &[&'static str]) -> Option<(&'static str, &'a Node)> {
        match self.at_most_one(keys)? {
            Some(found) => Some(found),
            None => {
                let expected = one_of(keys);
                self.missing(format!("{} does not say what it is", self.what), &expected)
            }
        }
    }

    /// The key of `keys` that is there, if any; complains when there are several.
    pub fn at_most_one(&self, keys: &[&'static str]) -> Option<Option<(&'static str, &'a Node)>> {
        let mut found: Vec<_> = keys
            .iter()
            .filter_map(|key| self.table.entry(key).map(|entry| (*key, entry)))
            .collect();
        found.sort_by_key(|(_, entry)| entry.key_place);
        match found.as_slice() {
            [] => Some(None),
            [(key, entry)] => Some(Some((key, &entry.node))),
            [(first, _), (second, entry), ..] => {
                let message = format!("\"{second}\" contradicts \"{first}\" in {}", self.what);
                let expected = format!("only {}", one_of(keys));
                self.report
                    .fail(Complaint::new(entry.key_place, message).expected(expected))
            }
        }
    }
}
