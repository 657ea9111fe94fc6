//! How far a render is, and when to stop it.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use etalon::Progress;
use etalon::inside::film::whole;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};

use super::job::Job;
use super::report::percent;

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

/// Shows progress on a terminal and stops when asked to.
pub struct Watch {
    bar: Option<ProgressBar>,
    pixels: f64,
    limit: Option<Duration>,
}

impl Watch {
    /// Watches a job that may take `limit`; shows a bar if `shown` and stderr is a terminal.
    pub fn new(job: &Job, limit: Option<Duration>, shown: bool) -> Self {
        let shown = shown && std::io::stderr().is_terminal();
        Self {
            bar: shown.then(|| bar(job)),
            pixels: job.render.window().pixels() as f64,
            limit,
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    /// Seconds left: until the samples are done or the time is up, whichever comes first.
    fn left(&self, done: u32, wanted: u32, seconds: f64) -> f64 {
        let samples = seconds * f64::from(wanted - done) / f64::from(done);
        let limit = self.limit.map_or(f64::INFINITY, |l| l.as_secs_f64());
        samples.min((limit - seconds).max(0.0))
    }
}

/// Parts that the bar is divided into.
const PARTS: f64 = 1000.0;

fn bar(job: &Job) -> ProgressBar {
    let bar = ProgressBar::new(PARTS as u64);
    if let Ok(style) = ProgressStyle::with_template("{prefix} {wide_bar} {msg}") {
        bar.set_style(style);
    }
    bar.set_prefix(job.output.display().to_string());
    bar.tick();
    bar
}

impl Progress for Watch {
    fn passed(&mut self, done: u32, wanted: u32, spent: Duration, error: Option<f64>) -> bool {
        if let Some(bar) = &self.bar {
            let seconds = spent.as_secs_f64();
            let rate = f64::from(done) * self.pixels / seconds;
            let left = self.left(done, wanted, seconds);
            let error = error.map_or_else(|| "unknown".to_owned(), percent);
            bar.set_position((PARTS * seconds / (seconds + left)) as u64);
            let left = HumanDuration(Duration::try_from_secs_f64(left).unwrap_or(Duration::MAX));
            bar.set_message(format!(
                "{done} spp, {:.2} M samples/s, {left:#} left, standard error {error}",
                rate * 1e-6
            ));
        }
        !interrupted()
    }
}
