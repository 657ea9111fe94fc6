//! Renders that are judged against references, with as many samples as that takes.
//!
//! A [`Case`](case::Case) is a scene with what is asked about its pictures: the image mean of each channel and
//! band, and the mean of R, G, B over the pixels that show each material. A pilot, thrown away
//! afterwards, says how many samples the questions need, or else which tolerances the samples that
//! can be afforded allow ([`Planned`](planned::Planned)). Then each question gets one of three verdicts; what is
//! inconclusive is asked again of fresh samples, four times as many, at most [`ROUNDS`] times
//! ([`Outcome`](outcome::Outcome)). Blocks of pixels and their distribution are judged besides, as
//! `compare` does.

pub mod case;
pub mod outcome;
pub mod planned;
pub mod verdict;

/// Times a question may be asked.
pub const ROUNDS: u32 = 3;
