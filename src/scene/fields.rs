//! Typed reading of tree nodes, and the collection of complaints.
//!
//! A reader that meets something wrong adds a complaint and returns `None`; reading goes on, so
//! that in the end the first complaint in the order of the file can be shown.

use std::cell::{Cell, RefCell};
use std::fmt::Display;
use std::ops::RangeInclusive;

use glam::DVec3;

use super::FinderChoice;
use super::implicit::DefaultFinder;
use super::tree::{Entry, Node, Place, Table, Value};

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
}

/// A value to be read.
#[derive(Clone)]
pub(super) struct Item<'a> {
    pub report: &'a Report,
    /// What it is called in messages.
    pub path: String,
    pub node: &'a Node,
}

impl<'a> Item<'a> {
    pub fn fail<T>(&self, message: impl Into<String>, expected: impl Into<String>) -> Option<T> {
        self.report.fail(self.node.place, message, expected)
    }

    /// Complains of what it is.
    pub fn wrong<T>(&self, is: impl Display, expected: impl Into<String>) -> Option<T> {
        self.fail(format!("{} is {is}", self.path), expected)
    }

    pub fn wrong_type<T>(&self, expected: impl Into<String>) -> Option<T> {
        self.wrong(self.node.kind(), expected)
    }

    /// Complains that it is none of `names`.
    pub fn unknown<T>(&self, message: String, name: &str, names: &[&str]) -> Option<T> {
        self.report.unknown(self.node.place, message, name, names)
    }

    /// A finite number.
    pub fn number(&self) -> Option<f64> {
        let expected = "a finite number";
        match &self.node.value {
            #[expect(
                clippy::cast_precision_loss,
                reason = "a number written without a point means the nearest f64"
            )]
            Value::Integer(number) => Some(*number as f64),
            Value::Float(number) if number.is_finite() => Some(*number),
            Value::Float(number) if number.is_nan() => self.wrong("NaN", expected),
            Value::Float(_) => self.wrong("infinite", expected),
            _ => self.wrong_type(expected),
        }
    }

    /// A finite number that passes a test.
    pub fn number_that(&self, expected: &str, test: impl Fn(f64) -> bool) -> Option<f64> {
        let number = self.number()?;
        if test(number) {
            return Some(number);
        }
        self.wrong(number, expected)
    }

    /// A number above zero.
    pub fn positive(&self) -> Option<f64> {
        self.number_that("a number greater than 0", |x| x > 0.0)
    }

    /// An integer in a range.
    pub fn integer<T>(&self, range: RangeInclusive<T>) -> Option<T>
    where
        T: Display + TryFrom<i64> + PartialOrd,
    {
        let expected = format!("an integer from {} to {}", range.start(), range.end());
        let allowed = |number: &T| range.contains(number);
        match &self.node.value {
            Value::Integer(number) => match T::try_from(*number).ok().filter(allowed) {
                Some(number) => Some(number),
                None => self.wrong(number, expected),
            },
            Value::Float(number) => self.wrong(format!("{number:?}"), expected),
            _ => self.wrong_type(expected),
        }
    }

    pub fn text(&self) -> Option<&'a str> {
        match &self.node.value {
            Value::Text(text) => Some(text),
            _ => self.wrong_type("a string"),
        }
    }

    pub fn nodes(&self, expected: &str) -> Option<&'a [Node]> {
        match &self.node.value {
            Value::List(nodes) => Some(nodes),
            _ => self.wrong_type(expected),
        }
    }

    /// The entries of an array.
    pub fn list(&self, expected: &str) -> Option<Vec<Self>> {
        let nodes = self.nodes(expected)?.iter().enumerate();
        let entries = nodes.map(|(i, node)| Self {
            path: format!("{}[{i}]", self.path),
            node,
            ..*self
        });
        Some(entries.collect())
    }

    /// The entries of an array of `N`.
    pub fn array<const N: usize>(&self, expected: &str) -> Option<[Self; N]> {
        let entries = self.list(expected)?;
        let count = entries.len();
        entries.try_into().ok().or_else(|| {
            let message = format!("{} has {count} entries", self.path);
            self.fail(message, expected)
        })
    }

    /// `N` finite numbers.
    pub fn numbers<const N: usize>(&self) -> Option<[f64; N]> {
        let entries = self.array::<N>(&format!("an array of {N} finite numbers"))?;
        let mut numbers = [0.0; N];
        for (number, entry) in numbers.iter_mut().zip(entries) {
            *number = entry.number()?;
        }
        Some(numbers)
    }

    /// A point or vector `[x, y, z]`.
    pub fn vector(&self) -> Option<DVec3> {
        self.numbers().map(DVec3::from_array)
    }

    /// A vector other than zero, scaled to length 1.
    pub fn direction(&self) -> Option<DVec3> {
        let vector = self.vector()?;
        if vector == DVec3::ZERO {
            return self.wrong("the zero vector", "a vector with a direction");
        }
        // Bringing the largest component to ±1 first keeps squares from under- and overflowing
        // and leaves multiples of the axes exact.
        let scaled = vector / vector.abs().max_element();
        Some(scaled / scaled.length())
    }

    /// One of several things by its name.
    pub fn choice<T: Copy>(&self, all: &[T], name: impl Fn(T) -> &'static str) -> Option<T> {
        let names: Vec<&str> = all.iter().map(|one| name(*one)).collect();
        let Value::Text(text) = &self.node.value else {
            return self.wrong_type(one_of(&names));
        };
        let found = all.iter().find(|one| name(**one) == text);
        found.copied().or_else(|| {
            let message = format!("{} is \"{text}\"", self.path);
            self.unknown(message, text, &names)
        })
    }

    /// A finder of implicit surfaces, and where it is written.
    pub fn finder(&self) -> Option<DefaultFinder> {
        let place = self.node.place;
        let finder = self.choice(FinderChoice::ALL, FinderChoice::name)?;
        Some((finder, Some(place)))
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
    pub fn open(item: Item<'a>, keys: &[&str]) -> Option<Self> {
        match &item.node.value {
            Value::Table(table) => Some(Self::of(
                item.report,
                item.path,
                item.node.place,
                table,
                keys,
            )),
            _ => item.wrong_type("a table"),
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
        let unknown = |entry: &&Entry| !keys.contains(&entry.key.as_str());
        let unknown: Vec<&Entry> = table.entries.iter().filter(unknown).collect();
        for Entry { key, key_place, .. } in &unknown {
            let message = match what.as_str() {
                "" => format!("unknown key \"{key}\""),
                what => format!("unknown key \"{key}\" in {what}"),
            };
            report.unknown::<()>(*key_place, message, key, keys);
        }
        Self {
            report,
            what,
            place,
            table,
            misspelt: !unknown.is_empty(),
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

    pub fn item(&self, key: &str) -> Option<Item<'a>> {
        self.get(key).map(|node| Item {
            report: self.report,
            path: self.path(key),
            node,
        })
    }

    /// A value that must be there.
    pub fn required<T>(
        &self,
        key: &str,
        expected: &str,
        read: impl FnOnce(Item<'a>) -> Option<T>,
    ) -> Option<T> {
        match self.item(key) {
            Some(item) => read(item),
            None => self.missing(format!("{} is missing", self.path(key)), expected),
        }
    }

    /// A value with a default: `Some(default)` if absent, `None` if there and wrong.
    pub fn optional<T>(
        &self,
        key: &str,
        default: T,
        read: impl FnOnce(Item<'a>) -> Option<T>,
    ) -> Option<T> {
        self.item(key).map_or(Some(default), read)
    }

    /// A value that may be absent: then `Some(None)`.
    pub fn maybe<T>(
        &self,
        key: &str,
        read: impl FnOnce(Item<'a>) -> Option<T>,
    ) -> Option<Option<T>> {
        self.optional(key, None, |item| read(item).map(Some))
    }

    /// The one key of `keys` that is there; complains when there are none or several.
    pub fn exactly_one(&self, keys: &[&'static str]) -> Option<(&'static str, Item<'a>)> {
        self.at_most_one(keys)?.or_else(|| {
            let message = format!("{} does not say what it is", self.what);
            self.missing(message, &one_of(keys))
        })
    }

    /// The key of `keys` that is there, if any; complains when there are several.
    pub fn at_most_one(&self, keys: &[&'static str]) -> Option<Option<(&'static str, Item<'a>)>> {
        let entry = |key: &&'static str| Some((*key, self.table.entry(key)?));
        let mut found: Vec<_> = keys.iter().filter_map(entry).collect();
        found.sort_by_key(|(_, entry)| entry.key_place);
        if let [(first, _), (second, entry), ..] = found.as_slice() {
            let message = format!("\"{second}\" contradicts \"{first}\" in {}", self.what);
            let expected = format!("only {}", one_of(keys));
            return self.report.fail(entry.key_place, message, expected);
        }
        let found = found.first();
        Some(found.and_then(|(key, _)| Some((*key, self.item(key)?))))
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
