//! How far a render or a study is, and whether the user wants it to stop.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use etalon::Progress;
use etalon::inside::film::whole;
use etalon::inside::study::run::Watch;
use indicatif::{HumanDuration, ProgressBar, ProgressFinish, ProgressStyle};

use super::render::{Job, percent};
use super::tell;

/// How often the user has asked to stop.
static STOPS: AtomicU32 = AtomicU32::new(0);

/// What a shell calls a program ended by Ctrl-C: 128 + SIGINT.
const ENDED_BY_INTERRUPT: i32 = 130;

/// From now on Ctrl-C ends the render after the pass it is in, and a second one at once.
pub fn listen() {
    // Without a handler Ctrl-C ends the program at once, as ever.
    let _ = ctrlc::set_handler(|| {
        if STOPS.fetch_add(1, Ordering::Relaxed) > 0 {
            let _kept_until_the_end = whole::abandon();
            std::process::exit(ENDED_BY_INTERRUPT);
        }
    });
}

/// Whether the user has asked to stop.
pub fn interrupted() -> bool {
    STOPS.load(Ordering::Relaxed) > 0
}

/// Parts that a bar is divided into.
const PARTS: f64 = 1000.0;

/// A bar on stderr where that is a terminal, unless `quiet`; gone when it is dropped.
fn bar(prefix: String, quiet: bool) -> Option<ProgressBar> {
    (!quiet && std::io::stderr().is_terminal()).then(|| {
        let bar = ProgressBar::new(PARTS as u64).with_finish(ProgressFinish::AndClear);
        if let Ok(style) = ProgressStyle::with_template("{prefix}{wide_bar} {msg}") {
            bar.set_style(style);
        }
        bar.set_prefix(prefix);
        bar.tick();
        bar
    })
}

/// Seconds in words.
fn human(seconds: f64) -> String {
    let duration = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
    format!("{:#}", HumanDuration(duration))
}

/// A bar for a render, which stops when asked to.
pub struct Rendering {
    bar: Option<ProgressBar>,
    pixels: f64,
    /// Seconds that the render may take.
    limit: f64,
}

impl Rendering {
    /// Watches a job that may take so long.
    pub fn new(job: &Job, limit: Option<Duration>, quiet: bool) -> Self {
        Self {
            bar: bar(format!("{} ", job.output.display()), quiet),
            pixels: job.render.window().pixels() as f64,
            limit: limit.map_or(f64::INFINITY, |limit| limit.as_secs_f64()),
        }
    }
}

impl Progress for Rendering {
    fn passed(&mut self, done: u32, wanted: u32, spent: Duration, error: Option<f64>) -> bool {
        if let Some(bar) = &self.bar {
            let seconds = spent.as_secs_f64();
            let rate = f64::from(done) * self.pixels / seconds;
            // Until the samples are done or the time is up, whichever comes first.
            let samples = seconds * f64::from(wanted - done) / f64::from(done);
            let left = samples.min((self.limit - seconds).max(0.0));
            let error = error.map_or_else(|| "unknown".to_owned(), percent);
            bar.set_position((PARTS * seconds / (seconds + left)) as u64);
            bar.set_message(format!(
                "{done} spp, {:.2} M samples/s, {} left, standard error {error}",
                rate * 1e-6,
                human(left)
            ));
        }
        !interrupted()
    }
}

/// A bar for a study, and its notes on stderr.
pub struct Studying {
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Studying {
    /// Shows everything, or nothing.
    pub fn new(quiet: bool) -> Self {
        let bar = bar(String::new(), quiet);
        Self { bar, quiet }
    }
}

impl Watch for Studying {
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
            bar.set_message(format!("{what}; {} left", human(left)));
        }
    }

    fn stops(&self) -> bool {
        interrupted()
    }
}
