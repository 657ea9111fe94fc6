//! Time spent on a study, and what is left of it.

use std::time::{Duration, Instant};

use super::run::Watch;
use crate::render::Progress;

/// Time spent, and what is left of the plan.
pub struct Clock<'a> {
    watch: &'a mut dyn Watch,
    start: Instant,
    planned: f64,
    /// Planned seconds of what is done, and of what is under way.
    done: [f64; 2],
    /// Seconds spent rendering.
    pub rendering: f64,
}

impl<'a> Clock<'a> {
    /// Starts, with so many seconds planned.
    pub fn new(watch: &'a mut dyn Watch, planned: f64) -> Self {
        Self {
            watch,
            start: Instant::now(),
            planned,
            done: [0.0; 2],
            rendering: 0.0,
        }
    }

    /// What comes next should take so many seconds.
    pub fn expect(&mut self, seconds: f64) {
        self.done[1] = seconds;
    }

    /// Does a part of the work, and tells of it.
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
        // As fast as so far, once there is a so far; as planned before.
        let pace = if done > 0.0 {
            self.start.elapsed().as_secs_f64() / done
        } else {
            1.0
        };
        let left = (self.planned - done).max(0.0) * pace;
        self.watch.at(what, share, left);
    }
}

/// One render within a study.
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
