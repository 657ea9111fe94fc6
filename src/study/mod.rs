//! Comparisons that are worth a chart.

pub mod axis;
pub mod finders;
pub mod row;
