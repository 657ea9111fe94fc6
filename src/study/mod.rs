//! Comparisons: of pictures with pictures and with truths, and of methods with each other.

pub mod compare;
pub mod finders;
