//! Reading implicit surfaces: a name or an expression, its parameters and its box.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;
use num_rational::BigRational;

use super::fields::{Fields, Item, Report, every};
use super::objects::SHAPES;
use super::tree::{Entry, Node, Place, Value};
use super::{FinderChoice, Implicit};
use crate::field::expression::{
    self, Expression, ExpressionError, Parameter, check_name, parse_constant, rational,
};
use crate::field::named::{self, NamedSurface, SURFACES};
use crate::field::over_box::over_box;

/// The finder of objects that name none, and where it is written.
pub(super) type DefaultFinder = (FinderChoice, Option<Place>);

/// Steps along a ray of the baseline finder: default and maximum.
const STEPS: u32 = 1000;
const MOST_STEPS: u32 = 1_000_000;

/// As many characters of an expression as a message shows.
const SHOWN: usize = 40;

pub(super) const KEYS: [&str; 5] = ["inside", "parameters", "closed", "finder", "steps"];
const BOX: &str = "[[x, y, z], [x, y, z]], the lower and the upper corner of a box";

/// Reads `{ implicit = … }`.
pub(super) fn read(item: Item<'_>, default: &DefaultFinder) -> Option<Implicit> {
    let fields = Fields::open(item, &[SHAPES, &KEYS].concat())?;
    let (_, written) = fields.exactly_one(SHAPES)?;
    let surface = named::find(written.text()?);
    let parameters = fields.optional("parameters", Vec::new(), |item| parameters(&item, surface));
    let field = parameters.and_then(|parameters| match surface {
        Some(surface) => named_field(&fields, surface, &parameters),
        None => read_field(&written, &parameters),
    });
    let inside = match surface {
        Some(surface) => {
            let half = DVec3::splat(surface.half_width);
            fields.optional("inside", [-half, half], |item| clip_box(&item))
        }
        // A field that could not be read may be a misspelt name, which has a box.
        None if field.is_none() && fields.get("inside").is_none() => None,
        None => fields.required("inside", BOX, |item| clip_box(&item)),
    };
    let closed = fields.optional("closed", false, |item| match item.node.value {
        Value::Bool(closed) => Some(closed),
        _ => item.wrong_type("true or false"),
    });
    let finder = fields.optional("finder", *default, |item| item.finder());
    let steps = fields.optional("steps", STEPS, |item| item.integer(1..=MOST_STEPS));
    let (finder, chosen_at) = finder?;
    let (mut field, mut inside, closed) = (field?, inside?, closed?);
    if closed && let Some(capped) = field.capped(&inside) {
        field = capped;
        // Some room about the caps, which must not lie where the surface is cut off.
        let room = (inside[1] - inside[0]) / 16.0;
        inside = [inside[0] - room, inside[1] + room];
    }
    let implicit = Implicit {
        name: surface.map(|surface| surface.name),
        field: Arc::new(field),
        inside,
        closed,
        finder,
        steps: steps?,
    };
    check(&implicit, &written, chosen_at)?;
    Some(implicit)
}

/// What only field, box and finder together can have wrong.
fn check(implicit: &Implicit, written: &Item<'_>, chosen_at: Option<Place>) -> Option<()> {
    let polynomial = implicit.field.polynomial.is_some();
    if !polynomial && over_box(&implicit.field.tape, &implicit.inside).undefined {
        let message = "object.shape.implicit is defined nowhere in its box";
        let expected = "a field that has values in \"inside\": no root of a negative number, \
                        logarithm of zero or division by zero everywhere";
        return written.fail(message, expected);
    }
    if implicit.finder.takes_any_field() || polynomial {
        return Some(());
    }
    let problem = if implicit.closed {
        "a closed surface, whose caps are no polynomial".to_owned()
    } else {
        // The finder may be asked for far from the field.
        let text = written.text()?;
        let shown: String = text.chars().take(SHOWN).collect();
        let rest = if shown.len() < text.len() { "…" } else { "" };
        format!("a field that is no polynomial: {shown}{rest}")
    };
    let message = format!("the finder \"{}\" for {problem}", implicit.finder.name());
    let any = FinderChoice::ALL.iter().rev();
    let any = any.filter(|finder| finder.takes_any_field());
    let mut names: Vec<_> = any.map(|finder| format!("\"{}\"", finder.name())).collect();
    // "auto" first.
    names.rotate_right(1);
    let last = names.pop().unwrap_or_default();
    let expected = format!("{} or {last}", names.join(", "));
    let place = chosen_at.unwrap_or(written.node.place);
    written.report.fail(place, message, expected)
}

/// The field of an expression. What looks like a name of a surface is taken for a misspelt one.
fn read_field(item: &Item<'_>, parameters: &[Parameter]) -> Option<Expression> {
    let text = item.text()?;
    let known = |p: &Parameter| p.name == text;
    if check_name(text).is_ok() && !parameters.iter().any(known) {
        let names: Vec<&str> = SURFACES.iter().map(|surface| surface.name).collect();
        return item.unknown(format!("{} is \"{text}\"", item.path), text, &names);
    }
    expression::parse(text, parameters).map_or_else(|error| complain(item, text, &error), Some)
}

/// The field of a named surface; what can be wrong with it lies in its parameters.
fn named_field(
    fields: &Fields<'_>,
    surface: &NamedSurface,
    parameters: &[Parameter],
) -> Option<Expression> {
    match surface.field(parameters) {
        Ok(field) => Some(field),
        Err(error) => {
            let place = fields.get("parameters").map_or(fields.place, |n| n.place);
            let message = format!("with these parameters of {}: {error}", surface.name);
            fields.report.complain(place, message, None)
        }
    }
}

fn parameters(item: &Item<'_>, surface: Option<&NamedSurface>) -> Option<Vec<Parameter>> {
    let Value::Table(table) = &item.node.value else {
        return item.wrong_type("a table of names and values");
    };
    let mut known: Vec<Parameter> = Vec::with_capacity(table.entries.len());
    let read = table.entries.iter().map(|entry| {
        let allowed = check_parameter(item.report, entry, surface);
        let number = Item {
            path: format!("{}.{}", item.path, entry.key),
            node: &entry.node,
            ..*item
        };
        let value = value(&number, &known);
        let parameter = allowed.and(value).map(|value| Parameter {
            name: entry.key.clone(),
            value,
        });
        known.extend(parameter.clone());
        parameter
    });
    every(read)
}

/// A named surface has its own parameters; those of an expression must not mean something already.
fn check_parameter(report: &Report, entry: &Entry, surface: Option<&NamedSurface>) -> Option<()> {
    let (key, place) = (&entry.key, entry.key_place);
    let Some(surface) = surface else {
        return check_name(key).map_or_else(
            |problem| {
                let error = ExpressionError::from(problem);
                report.fail(place, error.to_string(), error.expected.unwrap_or_default())
            },
            Some,
        );
    };
    let names: Vec<&str> = surface.parameters.iter().map(|(name, _)| *name).collect();
    if names.contains(&key.as_str()) {
        return Some(());
    }
    let message = format!("\"{key}\" is no parameter of {}", surface.name);
    report.unknown(place, message, key, &names)
}

/// A number as written, or a constant expression of numbers and parameters above.
fn value(item: &Item<'_>, known: &[Parameter]) -> Option<BigRational> {
    match &item.node.value {
        Value::Integer(number) => Some(BigRational::from_integer((*number).into())),
        Value::Float(_) => {
            item.number()?;
            let written = item.node.written.as_ref();
            let exact = written.and_then(|text| rational(&text.replace('_', "")));
            exact.or_else(|| item.wrong("beyond all measure", "a number"))
        }
        Value::Text(text) => {
            parse_constant(text, known).map_or_else(|error| complain(item, text, &error), Some)
        }
        _ => item.wrong_type("a number, or a string such as \"9/80\""),
    }
}

/// Passes on what is wrong with an expression, at its place in the file.
fn complain<T>(item: &Item<'_>, text: &str, error: &ExpressionError) -> Option<T> {
    let place = inner(item.node, text, &error.span);
    if error.names.is_empty() {
        let expected = error.expected.clone();
        return item.report.complain(place, error.to_string(), expected);
    }
    let names: Vec<&str> = error.names.iter().map(String::as_str).collect();
    let name = text.get(error.span.clone()).unwrap_or("");
    item.report.unknown(place, error.to_string(), name, &names)
}

/// Where a part of a string stands in its origin: the whole string where escapes or trimmed line
/// ends keep its bytes from being those of the origin.
fn inner(node: &Node, text: &str, span: &Range<usize>) -> Place {
    let written = node.written.as_deref().unwrap_or("");
    // No quotes about a bare word, else one or three on each side, and perhaps a line end after three.
    let around = written.len().saturating_sub(text.len());
    let closing = if around < 6 { around / 2 } else { 3 };
    let opening = around - closing;
    let same = written.get(opening..opening + text.len()) == Some(text);
    if !same || !matches!(around, 0 | 2 | 6..=8) {
        return node.place;
    }
    let start = node.place.start + opening;
    Place::new(node.place.origin, start + span.start..start + span.end)
}

fn clip_box(item: &Item<'_>) -> Option<[DVec3; 2]> {
    let [low, high] = item.array(BOX)?.map(|corner| corner.vector());
    let (low, high) = (low?, high?);
    if !low.cmplt(high).all() {
        return item.wrong("a box without inside", BOX);
    }
    if !(high - low).is_finite() {
        return item.wrong("a box beyond all measure", BOX);
    }
    Some([low, high])
}
