//! Time spent on a study, and an estimate of the time left.

use std::time::{Duration, Instant};

use super::run::Watch;
use crate::render::Progress;

pub struct Clock<'a> {
    watch: &'a mut dyn Watch,
    start: Instant,
    planned: f64,
    /// Planned seconds of the work done, and of the render under way.
    done: [f64; 2],
    /// Seconds spent rendering so far.
    pub rendering: f64,
}

impl<'a> Clock<'a> {
    /// Starts, with this many seconds planned.
    pub fn new(watch: &'a mut dyn Watch, planned: f64) -> Self {
        Self {
            watch,
            start: Instant::now(),
            planned,
            done: [0.0; 2],
            rendering: 0.0,
        }
    }

    /// Sets the planned seconds of the next render.
    pub fn expect(&mut self, seconds: f64) {
        self.done[1] = seconds;
    }

    /// Runs a render, and reports its progress to the watcher.
    pub fn time<T>(&mut self, what: &str, work: impl FnOnce(&mut dyn Progress) -> T) -> T {
        let start = Instant::now();
        self.tell(what, 0.0);
        let result = work(&mut Part { clock: self, what });
        let taken = start.elapsed().as_secs_f64();
        self.rendering += taken;
        self.done[0] += if self.done[1] > 0.0 {
            self.done[1]
        } else {
            taken
        };
        self.done[1] = 0.0;
        result
    }

    fn tell(&mut self, what: &str, part: f64) {
        let done = self.done[0] + part * self.done[1];
        let share = (done / self.planned.max(done)).clamp(0.0, 1.0);
        // The pace measured so far; as planned until something is done.
        let pace = if done > 0.0 {
            self.start.elapsed().as_secs_f64() / done
        } else {
            1.0
        };
        let left = (self.planned - done).max(0.0) * pace;
        self.watch.at(what, share, left);
    }
}

/// Progress of one render, reported as a part of the study's.
struct Part<'a, 'b> {
    clock: &'a mut Clock<'b>,
    what: &'a str,
}

impl Progress for Part<'_, '_> {
    fn passed(&mut self, done: u32, wanted: u32, _: Duration, _: Option<f64>) -> bool {
        self.clock
            .tell(self.what, f64::from(done) / f64::from(wanted));
        !self.clock.watch.stops()
    }
}
