//! The reduced suite: the same verdicts as on the references, on the scenes here, with etalon in the
//! place of the reference and both sides drawn afresh each time.

use etalon::Plan;

use crate::agreement::case::Case;
use crate::agreement::outcome::{Levels, decide};
use crate::agreement::planned::{Paths, Planned, plan};

use super::planted::{Mistake, plant};
use super::scenes::{SCENES, scene};

/// Probability of a false alarm of the whole suite.
pub const LEVEL: f64 = 1e-3;
/// Camera paths per pixel of the pilots.
const PILOT: u32 = 64;
/// Camera paths of a case in the first round at most.
const MOST: Paths = Paths {
    to_show: 1 << 18,
    to_sharpen: 0,
};
const NO_MORE: Paths = Paths {
    to_show: 0,
    to_sharpen: 0,
};

pub struct Suite {
    cases: Vec<(Case, Planned)>,
    levels: Levels,
}

#[derive(Debug, Clone, Default)]
pub struct Run {
    /// Scenes that raised an alarm.
    pub alarms: Vec<String>,
    /// Scenes in which the mistake could be planted.
    pub planted: usize,
    /// Questions that stayed open.
    pub open: usize,
    /// Largest distance of a question's difference, in standard errors.
    pub score: f64,
}

impl Suite {
    pub fn new() -> Self {
        let cases: Vec<Case> = SCENES
            .iter()
            .map(|(name, text)| Case::new(name, scene(text), None).expect("placed"))
            .collect();
        // A first guess of the number of questions, for the samples; then the levels are exact.
        let questions: usize = cases.iter().map(|c| 3 * (1 + c.regions.len())).sum();
        let levels = Levels::shared(LEVEL, cases.len(), questions);
        let cases = cases.into_iter().map(|case| {
            let pilot = case.render(PILOT, 1).expect("rendered");
            let level = levels.question;
            let planned = plan(&case, (&pilot, PILOT), &pilot, MOST, level);
            // The reference has the samples of the picture, so its variance is the same.
            let pilot = case.render(planned.spp, 2).expect("rendered");
            let planned = plan(&case, (&pilot, planned.spp), &pilot, NO_MORE, level);
            (case, planned)
        });
        Self {
            cases: cases.collect(),
            levels,
        }
    }

    pub fn text(&self) -> String {
        let line = |(case, planned): &(Case, Planned)| {
            let tolerances = planned.questions.iter().map(|q| q.tolerance);
            let (least, largest) =
                tolerances.fold((f64::INFINITY, 0.0f64), |(a, b), t| (a.min(t), b.max(t)));
            format!(
                "  {:<22} {:>6} paths a pixel, {:>2} questions with tolerances from {:.2} % to {:.2} %\n",
                case.name,
                planned.spp,
                planned.questions.len(),
                100.0 * least,
                100.0 * largest
            )
        };
        self.cases.iter().map(line).collect()
    }

    /// Runs it: honestly, or with a mistake in one side.
    pub fn run(&self, mistake: Option<Mistake>, seed: u64) -> Run {
        let mut run = Run::default();
        for (index, (case, planned)) in self.cases.iter().enumerate() {
            let seeds = |round: u32| (seed << 8 | index as u64) << 4 | u64::from(round);
            let reference = case.render(planned.spp, seeds(0)).expect("rendered");
            let mut planted = false;
            let outcome = decide(case, planned, &reference, self.levels, |spp, round| {
                let mut scene = case.scene.clone();
                (scene.image.spp, scene.image.seed) = (spp, seeds(round));
                let mut plan = Plan::new(&scene, false)?;
                planted = mistake.is_some_and(|m| plant(m, &scene, &mut plan));
                case.rendered(&plan, spp)
            })
            .expect("rendered");
            run.planted += usize::from(planted);
            run.open += outcome.open();
            for answer in &outcome.answers {
                run.score = run.score.max(answer.difference.score(0.0).abs());
            }
            if outcome.alarms() {
                run.alarms.push(case.name.clone());
            }
        }
        run
    }
}
