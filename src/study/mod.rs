//! Error over samples and seconds, and whether renders agree with references and their error bars
//! with their errors.
//!
//! A study ([`run`]) renders every point of a [`grid`] of choices several times with independent
//! seeds, compares each render with a [`mod@reference`], and keeps one [`Row`](crate::chart::Row)
//! of each in a [`journal`]; [`budget`] sees to it that this fits into the time there is.

pub mod axis;
pub mod budget;
pub mod choice;
pub mod clock;
pub mod coverage;
pub mod grid;
pub mod journal;
pub mod measure;
pub mod own;
pub mod record;
pub mod reference;
pub mod report;
pub mod run;
pub mod subject;
pub mod work;

use std::path::PathBuf;

use crate::render::seeds;

/// Why a study cannot be carried out.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// One replicate has no spread.
    #[error("a study needs at least 2 independent renders of a point to know its errors' spread")]
    OneReplicate,
    /// `center` estimates another picture than the other samplers.
    #[error(
        "the sampler \"center\" sends every path through its pixel's centre and so shows another picture than the \
         others: study it alone"
    )]
    TwoPictures,
    /// Stopped before there was anything to keep.
    #[error("stopped before the reference was finished: there is nothing to take up again")]
    Interrupted,
    /// The directory cannot be made.
    #[error("cannot make the directory {}: {source}", path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A point is not valid.
    #[error(transparent)]
    Subject(#[from] subject::SubjectError),
    /// The grid contradicts itself.
    #[error(transparent)]
    Grid(#[from] grid::GridError),
    /// The reference cannot be used.
    #[error(transparent)]
    Reference(#[from] reference::ReferenceError),
    /// The study would take too much.
    #[error(transparent)]
    Budget(#[from] budget::BudgetError),
    /// The directory holds another study.
    #[error(transparent)]
    Record(#[from] record::RecordError),
    /// The table cannot be used.
    #[error(transparent)]
    Journal(#[from] journal::JournalError),
    /// A picture cannot be written.
    #[error(transparent)]
    Film(#[from] crate::film::Error),
}
