//! Error over samples and seconds, and whether error bars agree with errors.
//!
//! A study ([`run`]) renders every point of a [`grid`] of settings several times with independent
//! seeds, compares each render with a [`mod@reference`], and keeps one [`Row`](crate::chart::Row)
//! of each in a [`journal`]; [`budget`] checks that this fits into the time and memory there is.

pub mod axis;
pub mod budget;
pub mod choice;
pub mod clock;
pub mod coverage;
pub mod grid;
pub mod journal;
pub mod own;
pub mod reference;
pub mod report;
pub mod run;
pub mod subject;
pub mod work;

use std::path::{Path, PathBuf};

use crate::plan::PlanError;
use crate::scene::SceneError;

/// Why a study cannot be carried out.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    #[error("a study needs at least 2 independent renders of a point to know its errors' spread")]
    OneReplicate,
    /// `center` estimates another picture than the other samplers.
    #[error(
        "the sampler \"center\" sends every path through its pixel's centre and so shows another picture than the \
         others: study it alone"
    )]
    TwoPictures,
    #[error("stopped before the reference was finished: there is nothing to take up again")]
    Interrupted,
    #[error("cannot {action} {}: {reason}", path.display())]
    File {
        /// A verb and, where the path alone does not say it, what it acts on.
        action: &'static str,
        path: PathBuf,
        reason: String,
    },
    #[error("{}: {reason}", path.display())]
    Table {
        path: PathBuf,
        reason: crate::chart::row::TableError,
    },
    /// The directory holds another study.
    #[error(
        "{} is of another study: {key} is {found} there and {wanted} here", path.display()
    )]
    Other {
        path: PathBuf,
        /// What differs.
        key: String,
        found: String,
        wanted: String,
    },
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("at {at}: {reason}")]
    Plan {
        /// The settings of the point that cannot be planned.
        at: String,
        reason: PlanError,
    },
    #[error("the axis {0} is given twice")]
    Twice(&'static str),
    #[error(transparent)]
    Reference(#[from] reference::ReferenceError),
    #[error(transparent)]
    Budget(#[from] budget::BudgetError),
    #[error(transparent)]
    Film(#[from] crate::film::Error),
}

impl StudyError {
    fn file(action: &'static str, path: &Path, reason: &dyn ToString) -> Self {
        Self::File {
            action,
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }
}
