//! Typed reading of tree nodes, and the collection of complaints.
//!
//! A reader that meets something wrong adds a complaint and returns `None`; reading goes on, so
//! that in the end the first complaint in the order of the file can be shown.

use std::cell::{Cell, RefCell};
use std::ops::RangeInclusive;

use glam::DVec3;

use super::FinderChoice;
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
    pub fn new(place: Place, message: impl Into<String>, expected: Option<String>) -> Self {
        Self {
            place,
            message: message.into(),
            expected,
            suggestion: None,
            missing: false,
        }
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
    fn add(&self, complaint: Complaint) {
        self.complaints.borrow_mut().push(complaint);
    }

    /// Complains and returns `None`, which is what a reader then returns.
    pub fn fail<T>(
        &self,
        place: Place,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> Option<T> {
        self.complain(place, message, Some(expected.into()))
    }

    /// The same where it may be unknown what would have been right.
    pub fn complain<T>(
        &self,
        place: Place,
        message: impl Into<String>,
        expected: Option<String>,
    ) -> Option<T> {
        self.add(Complaint::new(place, message, expected));
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
        let mut complaint = Complaint::new(place, message, Some(one_of(names)));
        complaint.suggestion = search.then(|| nearest(name, names)).flatten();
        self.add(complaint);
        None
    }

    pub fn wrong_type<T>(&self, what: &str, node: &Node, expected: &str) -> Option<T> {
        self.fail(node.place, format!("{what} is {}", node.kind()), expected)
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
                self.fail(node.place, format!("{what} is {name}"), expected)
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
        self.fail(node.place, format!("{what} is {number}"), expected)
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
            Value::Integer(number) => {
                self.fail(node.place, format!("{what} is {number}"), expected)
            }
            Value::Float(number) => {
                self.fail(node.place, format!("{what} is {number:?}"), expected)
            }
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

    /// An array of `N` entries.
    pub fn array<'a, const N: usize>(
        &self,
        what: &str,
        node: &'a Node,
        expected: &str,
    ) -> Option<&'a [Node; N]> {
        let nodes = self.list(what, node, expected)?;
        <&[Node; N]>::try_from(nodes).ok().or_else(|| {
            let message = format!("{what} has {} entries", nodes.len());
            self.fail(node.place, message, expected)
        })
    }

    /// `N` finite numbers.
    pub fn numbers<const N: usize>(&self, what: &str, node: &Node) -> Option<[f64; N]> {
        let expected = format!("an array of {N} finite numbers");
        let nodes = self.array::<N>(what, node, &expected)?;
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
            return self.fail(node.place, message, "a vector with a direction");
        }
        // Bringing the largest component to ±1 first keeps squares from under- and overflowing
        // and leaves multiples of the axes exact.
        let scaled = vector / vector.abs().max_element();
        Some(scaled / scaled.length())
    }

    /// One of several things by its name.
    pub fn choice<T: Copy>(
        &self,
        what: &str,
        node: &Node,
        all: &[T],
        name: impl Fn(T) -> &'static str,
    ) -> Option<T> {
        let names: Vec<&str> = all.iter().map(|one| name(*one)).collect();
        let Value::Text(text) = &node.value else {
            return self.wrong_type(what, node, &one_of(&names));
        };
        match all.iter().find(|one| name(**one) == text) {
            Some(one) => Some(*one),
            None => self.unknown(node.place, format!("{what} is \"{text}\""), text, &names),
        }
    }

    /// A finder of implicit surfaces.
    pub fn finder(&self, what: &str, node: &Node) -> Option<FinderChoice> {
        let (_, finder) = self.choice(what, node, FinderChoice::NAMES, |(name, _)| name)?;
        Some(finder)
    }
}

/// All values, if nothing is wrong with any. All are read before any is missed, so that the first
/// complaint is the first in the file.
pub(super) fn every<T>(values: impl Iterator<Item = Option<T>>) -> Option<Vec<T>> {
    values.collect::<Vec<_>>().into_iter().collect()
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
            let mut complaint = Complaint::new(self.place, message, Some(expected.to_owned()));
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
                self.report.fail(entry.key_place, message, expected)
            }
        }
    }
}

/// As many names as a message lists.
const LISTED: usize = 12;

/// The nearest of `names`, if it is close enough to be a slip of the pen: one edit in three
/// letters, at least one, whatever the case.
pub(super) fn nearest(name: &str, names: &[&str]) -> Option<String> {
    let lower = name.to_lowercase();
    let allowed = (lower.chars().count() / 3).max(1);
    names
        .iter()
        .map(|candidate| {
            let distance = strsim::osa_distance(&lower, &candidate.to_lowercase());
            (distance, *candidate)
        })
        .filter(|(distance, _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate.to_owned())
}

/// `one of "a", "b"`, shortened when there are many.
pub(super) fn one_of(names: &[&str]) -> String {
    if names.is_empty() {
        return "a name (but none is defined)".to_owned();
    }
    let listed: Vec<String> = names
        .iter()
        .take(LISTED)
        .map(|n| format!("\"{n}\""))
        .collect();
    let rest = names.len() - listed.len();
    let listed = listed.join(", ");
    match (names.len(), rest) {
        (1, _) => listed,
        (_, 0) => format!("one of {listed}"),
        _ => format!("one of {listed} … and {rest} more"),
    }
}
