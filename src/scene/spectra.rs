//! Reading spectra.

use std::collections::HashMap;
use std::path::Path;

use super::fields::{Complaint, Fields, Report};
use super::file;
use super::lookup;
use super::tree::{Node, Table, Value};
use crate::spectrum::{self, Spectrum};

/// A spectrum as written; what a colour becomes depends on where it is used.
#[derive(Debug, Clone)]
enum Draft {
    Fixed(Spectrum),
    Rgb([f64; 3]),
}

/// What a spectrum is used as, which decides the values it may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Values in [0, 1].
    Reflectance,
    /// Values from 0.
    Emission,
    /// Real part of a refractive index: values above 0.
    Index,
    /// Extinction coefficient: values from 0.
    Extinction,
}

/// Everything needed to read a spectrum: the named ones, and where files are looked for.
pub(super) struct Spectra<'a> {
    pub report: &'a Report,
    base_dir: &'a Path,
    /// `None` for a definition that has been complained of.
    named: HashMap<String, Option<Draft>>,
    names: Vec<String>,
}

const KINDS: &[&str] = &["table", "csv", "blackbody", "rgb", "name", "constant"];
const KEYS: &[&str] = &[
    "table",
    "csv",
    "blackbody",
    "rgb",
    "name",
    "constant",
    "scale",
];
const EXPECTED: &str = "a spectrum: a number, a name, or a table with one of \"table\", \"csv\", \
                        \"blackbody\", \"rgb\", \"name\", \"constant\"";
const SAMPLES: &str = "at least two samples [nm, value]";

impl<'a> Spectra<'a> {
    /// Reads `[spectra]`; a definition may use names defined above it.
    pub fn read(report: &'a Report, base_dir: &'a Path, node: Option<&Node>) -> Self {
        let mut spectra = Self {
            report,
            base_dir,
            named: HashMap::new(),
            names: lookup::SPECTRA.iter().map(ToString::to_string).collect(),
        };
        let Some(node) = node else { return spectra };
        let Value::Table(table) = &node.value else {
            report.wrong_type::<()>("spectra", node, "a table of named spectra");
            return spectra;
        };
        for entry in &table.entries {
            if lookup::SPECTRA.contains(&entry.key.as_str()) {
                let message = format!("\"{}\" is the name of a standard spectrum", entry.key);
                report.add(Complaint::new(entry.key_place, message).expected("a name of your own"));
                continue;
            }
            let draft = spectra.draft(&format!("spectra.{}", entry.key), &entry.node);
            spectra.named.insert(entry.key.clone(), draft);
            spectra.names.push(entry.key.clone());
        }
        spectra
    }

    /// Reads a spectrum and checks its values.
    pub fn spectrum(&self, what: &str, node: &Node, role: Role) -> Option<Spectrum> {
        let spectrum = match (self.draft(what, node)?, role) {
            (Draft::Fixed(spectrum), _) => spectrum,
            (Draft::Rgb(rgb), Role::Reflectance) => {
                self.check_rgb(what, node, rgb, 1.0)?;
                lookup::rgb_reflectance(rgb)
            }
            (Draft::Rgb(rgb), Role::Emission) => {
                self.check_rgb(what, node, rgb, f64::INFINITY)?;
                lookup::rgb_emission(rgb)
            }
            (Draft::Rgb(_), Role::Index | Role::Extinction) => {
                let complaint = Complaint::new(node.place, format!("{what} is a colour"));
                return self
                    .report
                    .fail(complaint.expected("a number, \"table\" or \"csv\""));
            }
        };
        self.check(what, node, &spectrum, role)?;
        Some(spectrum)
    }

    fn check_rgb(&self, what: &str, node: &Node, rgb: [f64; 3], largest: f64) -> Option<()> {
        let wrong = rgb.into_iter().find(|c| *c < 0.0 || *c > largest);
        let Some(wrong) = wrong else { return Some(()) };
        let message = format!("{what} has the colour component {wrong}");
        let expected = if largest == 1.0 {
            "components between 0 and 1"
        } else {
            "components of at least 0"
        };
        self.report
            .fail(Complaint::new(node.place, message).expected(expected))
    }

    fn check(&self, what: &str, node: &Node, spectrum: &Spectrum, role: Role) -> Option<()> {
        let (low, high) = lookup::spectrum_bounds(spectrum);
        let fail = |value: f64, expected: &str| {
            let message = if matches!(spectrum, Spectrum::Constant(_)) {
                format!("{what} is {value}")
            } else {
                format!("{what} has the value {value}")
            };
            self.report
                .fail(Complaint::new(node.place, message).expected(expected))
        };
        match role {
            Role::Reflectance if low < 0.0 => fail(low, "a reflectance between 0 and 1"),
            Role::Reflectance if high > 1.0 => fail(high, "a reflectance between 0 and 1"),
            Role::Emission | Role::Extinction if low < 0.0 => fail(low, "values of at least 0"),
            Role::Index if low <= 0.0 => fail(low, "values greater than 0"),
            _ => Some(()),
        }
    }

    fn draft(&self, what: &str, node: &Node) -> Option<Draft> {
        match &node.value {
            Value::Integer(_) | Value::Float(_) => {
                let value = self.report.number(what, node)?;
                Some(Draft::Fixed(Spectrum::Constant(value)))
            }
            Value::Text(name) => self.by_name(what, node, name, 1.0),
            Value::Table(_) => self.from_table(what, node),
            _ => self.report.wrong_type(what, node, EXPECTED),
        }
    }

    fn by_name(&self, what: &str, node: &Node, name: &str, scale: f64) -> Option<Draft> {
        if let Some(spectrum) = lookup::spectrum(name, scale) {
            return Some(Draft::Fixed(spectrum));
        }
        if let Some(draft) = self.named.get(name) {
            return self.scaled(what, node, draft.clone()?, scale);
        }
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        let message = format!("{what} names the unknown spectrum \"{name}\"");
        self.report.unknown(node.place, message, name, &names)
    }

    fn from_table(&self, what: &str, node: &Node) -> Option<Draft> {
        let fields = Fields::open(self.report, what, node, KEYS)?;
        let scale = fields.optional("scale", 1.0, |what, node| self.report.number(what, node));
        let (kind, inner) = fields.exactly_one(KINDS)?;
        let path = fields.path(kind);
        let draft = match kind {
            "table" => Draft::Fixed(Spectrum::Table(self.table(&path, inner)?)),
            "csv" => Draft::Fixed(Spectrum::Table(self.csv(&path, inner)?)),
            "blackbody" => Draft::Fixed(Spectrum::Blackbody {
                kelvin: self.report.positive(&path, inner)?,
                scale: 1.0,
            }),
            "rgb" => Draft::Rgb(self.report.numbers(&path, inner)?),
            "name" => {
                let name = self.report.text(&path, inner)?;
                return self.by_name(&path, inner, name, scale?);
            }
            _ => Draft::Fixed(Spectrum::Constant(self.report.number(&path, inner)?)),
        };
        self.scaled(what, node, draft, scale?)
    }

    fn scaled(&self, what: &str, node: &Node, draft: Draft, factor: f64) -> Option<Draft> {
        let (draft, finite) = match draft {
            Draft::Rgb(rgb) => {
                let rgb = rgb.map(|c| c * factor);
                (Draft::Rgb(rgb), rgb.iter().all(|c| c.is_finite()))
            }
            Draft::Fixed(Spectrum::Constant(value)) => (
                Draft::Fixed(Spectrum::Constant(value * factor)),
                (value * factor).is_finite(),
            ),
            Draft::Fixed(Spectrum::Blackbody { kelvin, scale }) => {
                let scale = scale * factor;
                (
                    Draft::Fixed(Spectrum::Blackbody { kelvin, scale }),
                    scale.is_finite(),
                )
            }
            Draft::Fixed(Spectrum::Table(mut table)) => {
                table.values.iter_mut().for_each(|v| *v *= factor);
                let finite = table.values.iter().all(|v| v.is_finite());
                (Draft::Fixed(Spectrum::Table(table)), finite)
            }
        };
        if finite {
            return Some(draft);
        }
        let message = format!("{what} overflows when multiplied by {factor}");
        self.report
            .fail(Complaint::new(node.place, message).expected("finite values"))
    }

    fn table(&self, what: &str, node: &Node) -> Option<spectrum::Table> {
        let rows = self.report.list(what, node, SAMPLES)?;
        if rows.len() < 2 {
            let message = match rows.len() {
                0 => format!("{what} is empty"),
                _ => format!("{what} has only one sample"),
            };
            return self
                .report
                .fail(Complaint::new(node.place, message).expected(SAMPLES));
        }
        let mut nm = Vec::with_capacity(rows.len());
        let mut values = Vec::with_capacity(rows.len());
        for (i, row) in rows.iter().enumerate() {
            let [wavelength, value] = self.report.numbers(&format!("{what}[{i}]"), row)?;
            if let Err((message, expected)) = check_wavelength(nm.last(), wavelength) {
                let message = format!("{what}[{i}]: {message}");
                return self
                    .report
                    .fail(Complaint::new(row.place, message).expected(expected));
            }
            nm.push(wavelength);
            values.push(value);
        }
        Some(spectrum::Table { nm, values })
    }

    fn csv(&self, what: &str, node: &Node) -> Option<spectrum::Table> {
        let name = self.report.text(what, node)?;
        let fail = |message: String, expected: &str| {
            let message = format!("{what}: {message}");
            self.report
                .fail(Complaint::new(node.place, message).expected(expected))
        };
        let path = self.base_dir.join(name);
        let bytes = match file::read_bytes(&path) {
            Ok(bytes) => bytes,
            Err(error) => {
                let error = error.to_string();
                let first = error.lines().next().unwrap_or_default();
                let message = first.trim_start_matches("error: ").to_owned();
                return fail(message, "a file relative to the scene file");
            }
        };
        match parse_csv(&bytes) {
            Ok(table) => Some(table),
            Err((message, expected)) => fail(format!("{name}: {message}"), expected),
        }
    }
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

/// Two columns, nm and value, with or without a heading; `#` begins a comment line.
fn parse_csv(bytes: &[u8]) -> Result<spectrum::Table, (String, &'static str)> {
    const ROW: &str = "two columns, wavelength in nm and value, both finite";
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(bytes);
    let (mut nm, mut values) = (Vec::new(), Vec::new());
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(|error| (error.to_string(), ROW))?;
        let line = record
            .position()
            .map_or(row as u64 + 1, csv::Position::line);
        let numbers: Vec<Option<f64>> = record.iter().map(|cell| cell.parse().ok()).collect();
        match numbers.as_slice() {
            [Some(wavelength), Some(value)] if wavelength.is_finite() && value.is_finite() => {
                check_wavelength(nm.last(), *wavelength)
                    .map_err(|(message, expected)| (format!("line {line}: {message}"), expected))?;
                nm.push(*wavelength);
                values.push(*value);
            }
            [None, None] if row == 0 => {}
            _ => return Err((format!("line {line} cannot be read"), ROW)),
        }
    }
    if nm.len() < 2 {
        return Err((format!("{} samples", nm.len()), SAMPLES));
    }
    Ok(spectrum::Table { nm, values })
}

/// Reads `environment = SPECTRUM` or `[environment] radiance = SPECTRUM`.
pub(super) fn environment(spectra: &Spectra<'_>, root: &Table) -> Option<Option<Spectrum>> {
    let Some(node) = root.get("environment") else {
        return Some(None);
    };
    let read = |what: &str, node: &Node| spectra.spectrum(what, node, Role::Emission);
    match &node.value {
        Value::Table(table) if table.get("radiance").is_some() || table.entries.is_empty() => {
            let fields = Fields::open(spectra.report, "environment", node, &["radiance"])?;
            fields.required("radiance", EXPECTED, read).map(Some)
        }
        _ => read("environment", node).map(Some),
    }
}
