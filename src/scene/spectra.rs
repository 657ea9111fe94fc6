//! Reading spectra.

use std::collections::HashMap;
use std::path::Path;

use super::fields::{Fields, Item, Report, one_of};
use super::file;
use super::tree::{Node, Value};
use crate::declare::Role;
use crate::spectrum::{self, NM_MAX, NM_MIN, RgbError, SPECTRUM_NAMES, Spectrum};

/// A spectrum as written; what a colour becomes depends on where it is used.
#[derive(Debug, Clone)]
enum Draft {
    Fixed(Spectrum),
    Rgb([f64; 3]),
}

/// Everything needed to read a spectrum: the named ones, and where files are looked for.
pub(super) struct Spectra<'a> {
    pub report: &'a Report,
    base_dir: &'a Path,
    /// `None` for a definition that has been complained of.
    named: HashMap<String, Option<Draft>>,
    names: Vec<String>,
}

/// Keys of a spectrum's table: it has one of them.
pub(super) const KINDS: &[&str] = &["table", "csv", "blackbody", "rgb", "name", "constant"];
const SAMPLES: &str = "at least two samples [nm, value]";

fn expected() -> String {
    format!(
        "a spectrum: a number, a name, or a table with {}",
        one_of(KINDS)
    )
}

impl<'a> Spectra<'a> {
    /// Reads `[spectra]`; a definition may use names defined above it.
    pub fn read(report: &'a Report, base_dir: &'a Path, node: Option<&Node>) -> Self {
        let mut spectra = Self {
            report,
            base_dir,
            named: HashMap::new(),
            names: SPECTRUM_NAMES.map(str::to_owned).to_vec(),
        };
        let Some(node) = node else { return spectra };
        let item = |path: String, node| Item { report, path, node };
        let Value::Table(table) = &node.value else {
            item("spectra".to_owned(), node).wrong_type::<()>("a table of named spectra");
            return spectra;
        };
        for entry in &table.entries {
            if Spectrum::named(&entry.key).is_some() {
                let message = format!("\"{}\" is the name of a standard spectrum", entry.key);
                report.fail::<()>(entry.key_place, message, "a name of your own");
                continue;
            }
            let draft = spectra.draft(&item(format!("spectra.{}", entry.key), &entry.node));
            spectra.named.insert(entry.key.clone(), draft);
            spectra.names.push(entry.key.clone());
        }
        spectra
    }

    /// Reads a spectrum and checks its values.
    pub fn spectrum(&self, item: &Item<'_>, role: Role) -> Option<Spectrum> {
        let spectrum = match (self.draft(item)?, role) {
            (Draft::Fixed(spectrum), _) => spectrum,
            (Draft::Rgb(rgb), Role::Reflectance) => fitted(item, Spectrum::rgb_reflectance(rgb))?,
            (Draft::Rgb(rgb), Role::Emission) => fitted(item, Spectrum::rgb_emission(rgb))?,
            (Draft::Rgb(_), Role::Index | Role::Extinction) => {
                return item.wrong("a colour", "a number, \"table\" or \"csv\"");
            }
        };
        check(item, &spectrum, role)?;
        Some(spectrum)
    }

    fn draft(&self, item: &Item<'_>) -> Option<Draft> {
        match &item.node.value {
            Value::Integer(_) | Value::Float(_) => {
                Some(Draft::Fixed(Spectrum::Constant(item.number()?)))
            }
            Value::Text(name) => self.by_name(item, name, 1.0),
            Value::Table(_) => self.described(item),
            _ => item.wrong_type(expected()),
        }
    }

    fn by_name(&self, item: &Item<'_>, name: &str, scale: f64) -> Option<Draft> {
        if let Some(spectrum) = Spectrum::named(name) {
            return scaled(item, Draft::Fixed(spectrum), scale);
        }
        if let Some(draft) = self.named.get(name) {
            return scaled(item, draft.clone()?, scale);
        }
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        let message = format!("{} names the unknown spectrum \"{name}\"", item.path);
        item.unknown(message, name, &names)
    }

    fn described(&self, item: &Item<'_>) -> Option<Draft> {
        let fields = Fields::open(item.clone(), &[KINDS, &["scale"]].concat())?;
        let scale = fields.optional("scale", 1.0, |scale| scale.number());
        let (kind, inner) = fields.exactly_one(KINDS)?;
        let draft = match kind {
            "table" => Draft::Fixed(Spectrum::Table(table(&inner)?)),
            "csv" => Draft::Fixed(Spectrum::Table(self.csv(&inner)?)),
            "blackbody" => Draft::Fixed(Spectrum::Blackbody {
                kelvin: inner.positive()?,
                scale: 1.0,
            }),
            "rgb" => Draft::Rgb(inner.numbers()?),
            "name" => return self.by_name(&inner, inner.text()?, scale?),
            _ => Draft::Fixed(Spectrum::Constant(inner.number()?)),
        };
        scaled(item, draft, scale?)
    }

    fn csv(&self, item: &Item<'_>) -> Option<spectrum::Table> {
        let name = item.text()?;
        let fail = |message: String, expected: &str| {
            item.fail(format!("{}: {message}", item.path), expected)
        };
        let bytes = match file::read_bytes(&self.base_dir.join(name)) {
            Ok(bytes) => bytes,
            Err(error) => {
                let error = error.to_string();
                let first = error.lines().next().unwrap_or_default();
                return fail(first.to_owned(), "a file relative to the scene file");
            }
        };
        let rows = "rows of two finite numbers, wavelength in nm (increasing) and value";
        let Ok(text) = String::from_utf8(bytes) else {
            return fail(format!("{name} is not UTF-8 text"), rows);
        };
        let table = match spectrum::Table::from_csv(&text) {
            Ok(table) => table,
            Err(error) => return fail(format!("{name}: {error}"), rows),
        };
        if table.nm.len() < 2 {
            return fail(format!("{name} has only one sample"), SAMPLES);
        }
        match table.nm.first() {
            Some(first) if *first <= 0.0 => {
                let message = format!("{name}: the wavelength {first} nm is not positive");
                fail(message, "wavelengths greater than 0 nm")
            }
            _ => Some(table),
        }
    }
}

fn fitted(item: &Item<'_>, fit: Result<Spectrum, RgbError>) -> Option<Spectrum> {
    let (component, expected) = match fit {
        Ok(spectrum) => return Some(spectrum),
        Err(RgbError::Reflectance(c)) => (c, "components between 0 and 1"),
        Err(RgbError::Emission(c)) => (c, "finite components of at least 0"),
    };
    let message = format!("{} has the colour component {component}", item.path);
    item.fail(message, expected)
}

fn check(item: &Item<'_>, spectrum: &Spectrum, role: Role) -> Option<()> {
    let (low, high) = (spectrum.min_value(), spectrum.max_value());
    let fail = |value: f64, expected: &str| {
        if matches!(spectrum, Spectrum::Constant(_)) {
            return item.wrong(value, expected);
        }
        item.fail(format!("{} has the value {value}", item.path), expected)
    };
    match role {
        Role::Reflectance if low < 0.0 => fail(low, "a reflectance between 0 and 1"),
        Role::Reflectance if high > 1.0 => fail(high, "a reflectance between 0 and 1"),
        Role::Emission | Role::Extinction if low < 0.0 => fail(low, "values of at least 0"),
        Role::Index if low <= 0.0 => fail(
            low,
            &format!("values greater than 0 at all wavelengths from {NM_MIN} to {NM_MAX} nm"),
        ),
        _ if !high.is_finite() => fail(high, "finite values"),
        _ => Some(()),
    }
}

fn scaled(item: &Item<'_>, draft: Draft, factor: f64) -> Option<Draft> {
    let (draft, finite) = match draft {
        Draft::Rgb(rgb) => {
            let rgb = rgb.map(|c| c * factor);
            (Draft::Rgb(rgb), rgb.iter().all(|c| c.is_finite()))
        }
        Draft::Fixed(spectrum) => {
            let scaled = spectrum.scaled(factor);
            let finite = scaled.min_value().is_finite() && scaled.max_value().is_finite();
            (Draft::Fixed(scaled), finite)
        }
    };
    if finite {
        return Some(draft);
    }
    let message = format!("{} overflows when multiplied by {factor}", item.path);
    item.fail(message, "finite values")
}

fn table(item: &Item<'_>) -> Option<spectrum::Table> {
    let rows = item.list(SAMPLES)?;
    match rows.len() {
        0 => return item.wrong("empty", SAMPLES),
        1 => return item.fail(format!("{} has only one sample", item.path), SAMPLES),
        _ => {}
    }
    let mut nm = Vec::with_capacity(rows.len());
    let mut values = Vec::with_capacity(rows.len());
    for row in rows {
        let [wavelength, value] = row.numbers()?;
        if let Err((message, expected)) = check_wavelength(nm.last(), wavelength) {
            return row.fail(format!("{}: {message}", row.path), expected);
        }
        nm.push(wavelength);
        values.push(value);
    }
    Some(spectrum::Table { nm, values })
}

/// The rules a further wavelength of a table has to keep, or what is wrong and what was expected.
fn check_wavelength(previous: Option<&f64>, wavelength: f64) -> Result<(), (String, &'static str)> {
    if wavelength <= 0.0 {
        let message = format!("the wavelength {wavelength} nm is not positive");
        return Err((message, "wavelengths greater than 0 nm"));
    }
    match previous {
        Some(previous) if wavelength <= *previous => Err((
            format!("the wavelength {wavelength} nm follows {previous} nm"),
            "strictly increasing wavelengths",
        )),
        _ => Ok(()),
    }
}

/// Reads `environment = SPECTRUM` or `[environment] radiance = SPECTRUM`.
pub(super) fn environment(spectra: &Spectra<'_>, item: Item<'_>) -> Option<Spectrum> {
    match &item.node.value {
        Value::Table(table) if table.get("radiance").is_some() || table.entries.is_empty() => {
            let fields = Fields::open(item, &["radiance"])?;
            fields.required("radiance", &expected(), |radiance| {
                spectra.spectrum(&radiance, Role::Emission)
            })
        }
        _ => spectra.spectrum(&item, Role::Emission),
    }
}
