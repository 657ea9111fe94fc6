//! Comparisons that are worth a chart.

pub mod finders;
