//! How far a study is.

use std::io::IsTerminal;
use std::time::Duration;

use etalon::inside::study::run::Watch;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};

use super::super::render::progress::interrupted;
use super::super::tell;

/// Parts that the bar is divided into.
const PARTS: f64 = 1000.0;

/// Notes on stderr, and a bar where that is a terminal.
pub struct Shown {
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Shown {
    /// Shows everything, or nothing.
    pub fn new(quiet: bool) -> Self {
        let shown = !quiet && std::io::stderr().is_terminal();
        Self {
            bar: shown.then(bar),
            quiet,
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(PARTS as u64);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {msg}") {
        bar.set_style(style);
    }
    bar
}

impl Watch for Shown {
    fn note(&mut self, line: &str) {
        match &self.bar {
            Some(bar) => bar.println(format!("note: {line}")),
            None if !self.quiet => tell(&format!("note: {line}")),
            None => {}
        }
    }

    fn at(&mut self, what: &str, share: f64, left: f64) {
        if let Some(bar) = &self.bar {
            bar.set_position((PARTS * share) as u64);
            let left = Duration::try_from_secs_f64(left).unwrap_or(Duration::MAX);
            bar.set_message(format!("{what}; {:#} left", HumanDuration(left)));
        }
    }

    fn stops(&self) -> bool {
        interrupted()
    }
}
