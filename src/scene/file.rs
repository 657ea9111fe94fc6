//! From a path to a checked scene.

use std::fs;
use std::io::Read;
use std::path::Path;

use super::build;
use super::error::{Diagnostic, Origin, SceneError};
use super::fields::{Complaint, Fields, Item, Report};
use super::overlay::{self, Setting};
use super::tree::{self, Entry, Node, Origins, Place, Table, Value};
use super::{Scene, Source};

/// The largest scene file (and data file) accepted, bytes.
pub const LARGEST_FILE: u64 = 16 << 20;

/// What is laid over a scene file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Overrides {
    /// Name of the panel to lay over the file's own scene.
    pub panel: Option<String>,
    /// Dotted paths and TOML values, laid over the file and the panel in this order.
    pub set: Vec<(String, String)>,
    /// Name of the finder of all implicit surfaces, whatever the file says.
    pub finder: Option<String>,
}

impl Overrides {
    /// Values of [`Self::set`] out of `key=value` pairs between blanks, as references record them.
    pub fn pairs(text: &str) -> Vec<(String, String)> {
        let pairs = text.split_whitespace();
        pairs
            .filter_map(|pair| pair.split_once('='))
            .map(|(key, value)| (key.to_owned(), value.to_owned()))
            .collect()
    }
}

/// Reads the scene file at `path`.
///
/// # Errors
/// Files that cannot be read or hold no valid scene; the message says where and why.
pub fn load(path: &Path, options: &Overrides) -> Result<Scene, SceneError> {
    let text = read(path)?;
    let base_dir = path.parent().unwrap_or(Path::new(""));
    parse(&path.display().to_string(), &text, base_dir, options)
}

/// Reads the text of the scene file at `path`.
///
/// # Errors
/// Directories, unreadable or too large files, and text that is not UTF-8.
pub fn read(path: &Path) -> Result<String, SceneError> {
    String::from_utf8(read_bytes(path)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(error.as_bytes());
        let name = path.display().to_string();
        let message = "not UTF-8 text".to_owned();
        let mut diagnostic = Diagnostic::at(Origin::File(name), &text, at, at + 1, message);
        diagnostic.expected = Some("a scene file (TOML) in UTF-8".to_owned());
        SceneError::Invalid(Box::new(diagnostic))
    })
}

/// Reads a whole file of bounded size. Devices and pipes have no size to ask for, so the reading
/// itself is bounded.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, SceneError> {
    let unreadable = |reason| SceneError::Unreadable {
        path: path.to_owned(),
        reason,
    };
    if fs::metadata(path).map_err(unreadable)?.is_dir() {
        return Err(SceneError::Directory {
            path: path.to_owned(),
        });
    }
    let mut bytes = Vec::new();
    fs::File::open(path)
        .and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes))
        .map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(SceneError::TooLarge {
            path: path.to_owned(),
            limit: LARGEST_FILE,
        });
    }
    Ok(bytes)
}

/// Reads a scene from text. `path_for_messages` is what the text is called in messages,
/// `base_dir` where the files it names are looked for.
///
/// # Errors
/// Anything that is not a valid scene, in the file's own scene or any of its panels; the first
/// error in the order of the file is reported. With [`Overrides::set`] only the scene asked for is checked.
pub fn parse(
    path_for_messages: &str,
    text: &str,
    base_dir: &Path,
    options: &Overrides,
) -> Result<Scene, SceneError> {
    let origins = origins(path_for_messages, text, options);
    let report = Report::default();
    let mut root = parse_tree(&origins, text)?;
    let set = options.set.iter().enumerate();
    let settings = set.filter_map(|(i, (key, value))| Setting::parse(&report, i + 1, key, value));
    let (for_panels, settings): (Vec<_>, Vec<_>) = settings.partition(Setting::is_for_panels);
    for setting in for_panels {
        setting.apply(&report, &mut root);
    }
    let panels = panels(&report, &mut root);
    let chosen = choose(&report, &panels, options);

    let mut asked = root.clone();
    if let Some(panel) = chosen {
        overlay::merge(&mut asked, &panel.over);
    }
    for setting in settings {
        setting.apply(&report, &mut asked);
    }
    if let Some(name) = &options.finder {
        let place = Place::new(origins.texts.len() - 1, 0..name.len());
        overlay::use_finder(&mut asked, place, name);
    }
    let source = Source {
        path: path_for_messages.to_owned(),
        text: text.to_owned(),
        set: options.set.clone(),
    };
    let panel = chosen.map(|panel| panel.name.clone());
    let scene = build::scene(&report, base_dir, &asked, source, panel);
    if options.set.is_empty() {
        check_others(&report, base_dir, root, &panels, chosen);
    }
    let unread = || Complaint::new(Place::new(0, 0..0), "the file holds no scene", None);
    match (report.first(), scene) {
        (None, Some(scene)) => Ok(scene),
        (complaint, _) => Err(invalid(&origins, complaint.unwrap_or_else(unread))),
    }
}

/// The names of the panels of a scene file, in the order of the file.
///
/// # Errors
/// Text that is not TOML, and panels without a name, with a name twice, or with unknown keys.
pub fn panel_names(path_for_messages: &str, text: &str) -> Result<Vec<String>, SceneError> {
    let origins = origins(path_for_messages, text, &Overrides::default());
    let report = Report::default();
    let mut root = parse_tree(&origins, text)?;
    let panels = panels(&report, &mut root).into_iter();
    let names = panels.map(|panel| panel.name).collect();
    report
        .first()
        .map_or(Ok(names), |complaint| Err(invalid(&origins, complaint)))
}

/// The file, the settings, the panel, and last the finder.
fn origins(path: &str, text: &str, options: &Overrides) -> Origins {
    let mut texts = vec![(Origin::File(path.to_owned()), text.to_owned())];
    let set = options.set.iter();
    texts.extend(set.map(|(key, value)| (Origin::Set, format!("{key}={value}"))));
    let panel = options.panel.iter();
    texts.extend(panel.map(|name| (Origin::Panel, name.clone())));
    let finder = options.finder.iter();
    texts.extend(finder.map(|name| (Origin::Finder, name.clone())));
    Origins { texts }
}

fn parse_tree(origins: &Origins, text: &str) -> Result<Table, SceneError> {
    tree::parse(text, 0, 0).map_err(|error| {
        let place = Place::new(0, error.span().unwrap_or(0..0));
        let words = error.message().trim().replace('\n', ", ");
        let (message, expected) = match words.split_once(", expected ") {
            Some((message, expected)) => (message.to_owned(), expected.to_owned()),
            None => (words, "TOML".to_owned()),
        };
        invalid(origins, Complaint::new(place, message, Some(expected)))
    })
}

fn invalid(origins: &Origins, complaint: Complaint) -> SceneError {
    let mut diagnostic = origins.diagnostic(complaint.place, complaint.message);
    diagnostic.expected = complaint.expected;
    diagnostic.suggestion = complaint.suggestion;
    SceneError::Invalid(Box::new(diagnostic))
}

/// A named variant and the tables it lays over the file's own.
struct Panel {
    name: String,
    name_place: Place,
    over: Table,
}

/// Tables a panel may lay over the file's own.
const TABLES: &[&str] = &["camera", "materials", "environment", "truth"];

/// Takes the panels out of the document.
fn panels(report: &Report, root: &mut Table) -> Vec<Panel> {
    let Some(node) = root.remove("panel") else {
        return Vec::new();
    };
    let item = Item {
        report,
        path: "panel".to_owned(),
        node: &node,
    };
    let nodes = item.nodes("[[panel]] tables").unwrap_or_default();
    let mut panels: Vec<Panel> = Vec::with_capacity(nodes.len());
    for node in nodes {
        let Some(panel) = panel(Item {
            node,
            ..item.clone()
        }) else {
            continue;
        };
        if panels.iter().any(|other| other.name == panel.name) {
            let message = format!("the panel name \"{}\" is used twice", panel.name);
            report.fail::<()>(panel.name_place, message, "a name of its own");
        }
        panels.push(panel);
    }
    panels
}

fn panel(item: Item<'_>) -> Option<Panel> {
    let place = item.node.place;
    let keys = [&["name"], build::IMAGE_KEYS, TABLES].concat();
    let fields = Fields::open(item, &keys)?;
    let name = fields.required("name", "name = \"…\"", |item| {
        Some((item.text()?, item.node.place))
    });
    let mut over = Table::default();
    let mut image = Table::default();
    for entry in &fields.table.entries {
        let key = entry.key.as_str();
        if TABLES.contains(&key) {
            over.put(entry.clone());
        } else if build::IMAGE_KEYS.contains(&key) {
            image.put(entry.clone());
        }
    }
    if !image.entries.is_empty() {
        let image = Node::new(place, Value::Table(image));
        over.put(Entry::new("image", place, image));
    }
    name.map(|(name, name_place)| Panel {
        name: name.to_owned(),
        name_place,
        over,
    })
}

fn choose<'a>(report: &Report, panels: &'a [Panel], options: &Overrides) -> Option<&'a Panel> {
    let name = options.panel.as_ref()?;
    let found = panels.iter().find(|panel| panel.name == *name);
    found.or_else(|| {
        let names: Vec<&str> = panels.iter().map(|panel| panel.name.as_str()).collect();
        let place = Place::new(options.set.len() + 1, 0..name.len());
        report.unknown(place, format!("there is no panel \"{name}\""), name, &names)
    })
}

/// Checks what was not asked for: the other panels, and the file's own scene, which may leave to
/// its panels to say what is missing.
fn check_others(
    report: &Report,
    base_dir: &Path,
    root: Table,
    panels: &[Panel],
    chosen: Option<&Panel>,
) {
    let variants = panels.iter().map(Some).chain([None]);
    for variant in variants {
        if variant.map(|p| p.name_place) == chosen.map(|p| p.name_place) {
            continue;
        }
        let findings = Report::default();
        let mut table = root.clone();
        if let Some(panel) = variant {
            // Shapes and lights are the same in every panel and have been checked.
            table.remove("object");
            table.remove("light");
            overlay::merge(&mut table, &panel.over);
        }
        build::scene(&findings, base_dir, &table, Source::default(), None);
        report.absorb(findings, |c| variant.is_some() || !c.missing);
    }
}
