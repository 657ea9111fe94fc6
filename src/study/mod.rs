//! Comparisons that are worth a chart.

pub mod failures;
pub mod finders;
