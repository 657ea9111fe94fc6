//! The rooms of the house depend on each other as the table in `src/lib.rs` says, and in no circle.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::support::files;

/// What each room may use.
type Table = BTreeMap<String, BTreeSet<String>>;

/// Lines `room → room, room` of the documentation.
fn table(text: &str) -> Table {
    let names = |list: &str| {
        let names = list.split(',').map(|name| name.trim().to_owned());
        names.filter(|name| !name.is_empty()).collect()
    };
    text.lines()
        .filter_map(|line| line.strip_prefix("//! ")?.split_once(" →"))
        .filter(|(room, _)| room.chars().all(|c| c.is_ascii_lowercase()))
        .map(|(room, list)| (room.to_owned(), names(list)))
        .collect()
}

/// The rooms that code names by `crate::`, comments left aside.
fn used(code: &str) -> BTreeSet<String> {
    let mut rooms = BTreeSet::new();
    for line in code.lines().filter(|l| !l.trim_start().starts_with("//")) {
        for rest in line.split("crate::").skip(1) {
            let inner = |c: char| !c.is_ascii_lowercase() && c != '_';
            match rest.strip_prefix('{') {
                Some(list) => rooms.extend(
                    list.split([',', '{', '}'])
                        .map(|item| item.trim().split(inner).next().unwrap_or("").to_owned()),
                ),
                None => rooms.extend(rest.split(inner).next().map(str::to_owned)),
            }
        }
    }
    rooms
}

/// Uses that the table does not allow, as `room → room`.
fn forbidden(table: &Table, uses: &Table) -> Vec<String> {
    let of_room = |(room, used): (&String, &BTreeSet<String>)| {
        let allowed = &table[room];
        used.iter()
            .filter(|other| table.contains_key(*other) && *other != room)
            .filter(|other| !allowed.contains(*other))
            .map(|other| format!("{room} → {other}"))
            .collect::<Vec<_>>()
    };
    uses.iter().flat_map(of_room).collect()
}

/// Rooms that reach themselves.
fn circles(table: &Table) -> Vec<&str> {
    let reaches_itself = |start: &str| {
        let mut waiting: Vec<&str> = table[start].iter().map(String::as_str).collect();
        let mut seen = BTreeSet::new();
        while let Some(room) = waiting.pop() {
            if room == start {
                return true;
            }
            if seen.insert(room) {
                waiting.extend(table.get(room).into_iter().flatten().map(String::as_str));
            }
        }
        false
    };
    let rooms = table.keys().map(String::as_str);
    rooms.filter(|room| reaches_itself(room)).collect()
}

/// The Rust files in a folder and below it.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let below = |name: String| match folder.join(name) {
        path if path.is_dir() => rust_files(&path),
        path => vec![path],
    };
    let mut found: Vec<PathBuf> = files(folder).into_iter().flat_map(below).collect();
    found.retain(|path| path.extension().is_some_and(|e| e == "rs"));
    found
}

/// What every room of the table uses; rooms of the lane crate stand in a folder of their own.
fn uses(table: &Table) -> Table {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let of_room = |room: &String| {
        let mut files = Vec::new();
        for place in [source.join(room), source.join("lanes").join(room)] {
            if place.is_dir() {
                files.extend(rust_files(&place));
            }
            files.extend(Some(place.with_extension("rs")).filter(|file| file.is_file()));
        }
        assert!(!files.is_empty(), "the room {room} has no folder");
        let of_file = |file| used(&std::fs::read_to_string(file).unwrap());
        (room.clone(), files.iter().flat_map(of_file).collect())
    };
    table.keys().map(of_room).collect()
}

/// Folders of rooms that the table does not know.
fn unknown(table: &Table) -> Vec<String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let folders = |folder: PathBuf| {
        let names = files(&folder).into_iter();
        names.filter(move |name| folder.join(name).is_dir())
    };
    folders(source.join("lanes"))
        .chain(folders(source))
        // The command line is the program's, above all rooms; `doors` is for tests.
        .filter(|name| !["cli", "lanes", "doors"].contains(&name.as_str()))
        .filter(|name| !table.contains_key(name))
        .collect()
}

#[test]
fn rooms_use_what_the_table_allows() {
    let table = table(include_str!("../src/lib.rs"));
    assert!(table.len() > 15, "{table:?}");
    let uses = uses(&table);
    assert_eq!(forbidden(&table, &uses), Vec::<String>::new());
    assert_eq!(circles(&table), Vec::<&str>::new());
    assert_eq!(unknown(&table), Vec::<String>::new());
    // A table that allows more than is used would let the first wrong arrow in unseen.
    for (room, allowed) in &table {
        let idle: Vec<_> = allowed.difference(&uses[room]).collect();
        assert!(idle.is_empty(), "{room} does not use {idle:?}");
    }
}

#[test]
fn a_wrong_arrow_and_a_circle_are_seen() {
    let table = table("//! math →\n//! shape → math\n//! scene → shape, math\n");
    let uses = |code: &str| Table::from([("shape".to_owned(), used(code))]);
    for code in [
        "use crate::scene::Scene;",
        "use crate::{math::ray, scene::Scene};",
        "let scene = crate::scene::load();",
    ] {
        assert_eq!(forbidden(&table, &uses(code)), ["shape → scene"], "{code}");
    }
    let honest = "// as in crate::scene\nuse crate::math::Ray;\nuse crate::shape::Hit;";
    assert!(forbidden(&table, &uses(honest)).is_empty());
    assert!(circles(&table).is_empty());
    let mut circular = table.clone();
    circular.get_mut("math").unwrap().insert("scene".to_owned());
    assert_eq!(circles(&circular), ["math", "scene", "shape"]);
}

/// Code over lanes would be compiled again, for every instruction set and precision, with each change of
/// a test; the doors stand in `tests/doors`.
#[test]
fn tests_and_tools_compile_no_lanes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = ["tests", "tools"]
        .map(|folder| rust_files(&root.join(folder)))
        .concat();
    files.retain(|file| !file.starts_with(root.join("tests/doors")));
    assert!(files.len() > 50);
    let generic = ["Lanes", "DoubleLanes"].map(|bound| format!(": {bound}"));
    for file in files {
        let code = std::fs::read_to_string(&file).unwrap();
        let mut lines = code.lines();
        let found = lines.find(|line| generic.iter().any(|word| line.contains(word)));
        assert_eq!(found, None, "{}", file.display());
    }
}
