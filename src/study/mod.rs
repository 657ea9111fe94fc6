//! Comparisons: of pictures with pictures and with truths, and of methods with each other.

pub mod agreement;
pub mod compare;
pub mod failures;
pub mod finders;
