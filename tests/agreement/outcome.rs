//! Verdicts.

use std::fmt::Write as _;

use super::ROUNDS;
use super::case::{Case, CaseError};
use super::planned::{Planned, Question};
use super::verdict::{Verdict, judge as verdict};
use etalon::inside::compare::{Judgement, Side, judge};
use etalon::inside::stats::Estimate;

/// Levels of single tests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Of a question, shared by its rounds.
    pub question: f64,
    /// Of the judgement of a picture's means, blocks and their distribution.
    pub picture: f64,
}

/// The answer to a question.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    pub question: Question,
    /// Picture minus reference, over the reference's mean.
    pub difference: Estimate,
    pub verdict: Verdict,
    /// In which round, from 1.
    pub round: u32,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    pub answers: Vec<Answer>,
    /// Means, blocks and distribution in the first round.
    pub judgement: Option<Judgement>,
    /// Camera paths per pixel of each round.
    pub samples: Vec<u32>,
}

impl Levels {
    /// Shares a level among `cases` cases with `questions` questions in all: half for the questions,
    /// half for the pictures.
    pub fn shared(level: f64, cases: usize, questions: usize) -> Self {
        Self {
            question: level / 2.0 / questions as f64,
            picture: level / 2.0 / cases as f64,
        }
    }
}

/// Renders and judges: `render` takes camera paths per pixel and the number of the round, and must
/// draw fresh samples each time.
pub fn decide(
    case: &Case,
    planned: &Planned,
    reference: &Side,
    levels: Levels,
    mut render: impl FnMut(u32, u32) -> Result<Side, CaseError>,
) -> Result<Outcome, CaseError> {
    let mut open = planned.questions.clone();
    let mut outcome = Outcome::default();
    let mut spp = planned.spp;
    for round in 1..=ROUNDS {
        let picture = render(spp, round)?;
        outcome.samples.push(spp);
        if round == 1 {
            outcome.judgement = judge(&picture, reference, levels.picture);
        }
        let answers: Vec<Answer> = open
            .drain(..)
            .filter_map(|question| {
                let (difference, mean) = question.ask(case, &picture, reference)?;
                let difference = difference.scaled(1.0 / mean);
                let level = levels.question / f64::from(ROUNDS);
                let verdict = verdict(&difference, question.tolerance, level);
                Some(Answer {
                    question,
                    difference,
                    verdict,
                    round,
                })
            })
            .collect();
        for answer in answers {
            if answer.verdict == Verdict::Inconclusive && round < ROUNDS {
                open.push(answer.question);
            } else {
                outcome.answers.push(answer);
            }
        }
        if open.is_empty() {
            break;
        }
        spp = spp.saturating_mul(4);
    }
    Ok(outcome)
}

impl Outcome {
    /// Whether something is shown to be wrong.
    pub fn alarms(&self) -> bool {
        let failed = |answer: &Answer| answer.verdict == Verdict::Fail;
        self.answers.iter().any(failed) || self.judgement.as_ref().is_some_and(|j| !j.consistent)
    }

    pub fn open(&self) -> usize {
        let open = |answer: &&Answer| answer.verdict == Verdict::Inconclusive;
        self.answers.iter().filter(open).count()
    }

    /// A line an answer, and one for each test of the picture that rejects.
    pub fn text(&self, case: &Case) -> String {
        let mut text = String::new();
        for answer in &self.answers {
            let verdict = match answer.verdict {
                Verdict::Pass => "pass",
                Verdict::Fail => "FAIL",
                Verdict::Inconclusive => "inconclusive",
            };
            let _ = writeln!(
                text,
                "  {:<34} {:>+9.4} % ± {:.4} %, tolerance {:.3} %: {verdict} (round {})",
                answer.question.name(case),
                100.0 * answer.difference.value,
                100.0 * answer.difference.standard_error,
                100.0 * answer.question.tolerance,
                answer.round,
            );
        }
        let Some(judgement) = &self.judgement else {
            return text;
        };
        for channel in &judgement.channels {
            if let Some(blocks) = &channel.blocks {
                let _ = writeln!(
                    text,
                    "  {:<34} worst of {} blocks {:+.1} s.e. (p = {:.1e}), all p = {:.2}, {} left out",
                    channel.channel,
                    blocks.count,
                    blocks.worst_score,
                    blocks.worst_p_value,
                    blocks.distribution_p_value,
                    blocks.left_out,
                );
            }
            for words in &channel.rejected {
                let _ = writeln!(text, "  {}: REJECTED: {words}", channel.channel);
            }
        }
        text
    }
}
