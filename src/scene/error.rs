//! What can be wrong with a scene file, and how it is shown.

use std::fmt;
use std::path::PathBuf;

/// Why there is no scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The operating system refuses to read the file.
    #[error("cannot read {}: {reason}", path.display())]
    Unreadable {
        /// The file asked for.
        path: PathBuf,
        /// What the operating system said.
        reason: std::io::Error,
    },
    /// The path names a directory.
    #[error("{} is a directory\n  = expected: a scene file (TOML)", path.display())]
    Directory {
        /// The path asked for.
        path: PathBuf,
    },
    /// The file has more bytes than a scene file may have.
    #[error("{} is larger than {limit} bytes\n  = expected: a scene file of at most {limit} bytes", path.display())]
    TooLarge {
        /// The file asked for.
        path: PathBuf,
        /// The largest size accepted, bytes.
        limit: u64,
    },
    /// Something in the text is wrong, at a known place.
    #[error("{0}")]
    Invalid(Box<Diagnostic>),
}

impl SceneError {
    /// The place and the words, if the error has a place in a text.
    pub fn diagnostic(&self) -> Option<&Diagnostic> {
        match self {
            Self::Invalid(diagnostic) => Some(diagnostic),
            _ => None,
        }
    }
}

/// A text that a scene is read from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// A scene file, by the name that it has in messages.
    File(String),
    /// An entry of [`Overrides::set`](super::Overrides::set), as `key=value`.
    Set,
    /// [`Overrides::panel`](super::Overrides::panel).
    Panel,
    /// [`Overrides::finder`](super::Overrides::finder).
    Finder,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::File(name) => name,
            Self::Set => "set",
            Self::Panel => "panel",
            Self::Finder => "finder",
        })
    }
}

/// One complaint with its place; `Display` shows it in the manner of rustc.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// What is wrong.
    pub message: String,
    /// The text it is about.
    pub origin: Origin,
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// The part of the source line that is shown, without its line ending.
    pub excerpt: String,
    /// Characters of the excerpt before the underline.
    pub indent: usize,
    /// Characters underlined, at least 1.
    pub width: usize,
    /// What would have been right.
    pub expected: Option<String>,
    /// The nearest valid name.
    pub suggestion: Option<String>,
}

/// Longest part of a source line that is shown: two terminal lines of the usual 80 columns.
const EXCERPT: usize = 160;
/// Characters kept before the underline when a long line is cut.
const LEAD: usize = 40;

impl Diagnostic {
    /// A complaint about the bytes `start..end` of `text`.
    pub(super) fn at(
        origin: Origin,
        text: &str,
        start: usize,
        end: usize,
        message: String,
    ) -> Self {
        let start = floor_boundary(text, start);
        let end = floor_boundary(text, end.max(start));
        let byte_order_mark = if text.starts_with('\u{feff}') { 3 } else { 0 };
        let start = start.max(byte_order_mark);
        let end = end.max(start);
        let line_start = text[..start].rfind('\n').map_or(byte_order_mark, |i| i + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
        let column = text[line_start..start].chars().count();
        let width = text[start..end.min(line_end)].trim_end().chars().count();
        let is_cut = column > EXCERPT - LEAD;
        let skipped = if is_cut { column - LEAD } else { 0 };
        let line = text[line_start..line_end].chars().skip(skipped);
        let excerpt: String = line.take(EXCERPT).map(printable).collect();
        let indent = column - skipped;
        Self {
            message,
            origin,
            line: text[..start].matches('\n').count() + 1,
            column: column + 1,
            excerpt: excerpt.trim_end().to_owned(),
            indent,
            width: width.clamp(1, EXCERPT - indent),
            expected: None,
            suggestion: None,
        }
    }
}

/// Control characters could move the cursor of the terminal that shows the message.
fn printable(c: char) -> char {
    match c {
        '\t' | '\r' => ' ',
        c if c.is_control() => char::REPLACEMENT_CHARACTER,
        c => c,
    }
}

/// The largest character boundary of `text` that is at most `index`.
fn floor_boundary(text: &str, index: usize) -> usize {
    let mut index = index.min(text.len());
    while !text.is_char_boundary(index) {
        index -= 1;
    }
    index
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            message,
            origin,
            line,
            column,
            excerpt,
            ..
        } = self;
        let gutter = " ".repeat(line.to_string().len());
        let (blank, marks) = (" ".repeat(self.indent), "^".repeat(self.width));
        writeln!(f, "{message}\n{gutter}--> {origin}:{line}:{column}")?;
        write!(
            f,
            "{gutter} |\n{line} | {excerpt}\n{gutter} | {blank}{marks}"
        )?;
        if let Some(expected) = &self.expected {
            write!(f, "\n{gutter} = expected: {expected}")?;
        }
        if let Some(name) = &self.suggestion {
            write!(f, "\n{gutter} = help: did you mean \"{name}\"?")?;
        }
        Ok(())
    }
}
