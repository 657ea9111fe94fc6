//! Root finders: siblings that look for the first zero of a function of one variable.
//!
//! Each answers *found* with an enclosure, *absent* as a proof, or *undecided*; none of them turns
//! the third into one of the others. Their only argument is a function on a
//! stretch of t: rays and surfaces are not known here.

pub mod bernstein;
pub mod exact;
pub mod interval;
pub mod sign_change;
pub mod sphere_trace;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// An interval [low, high] of t that holds the first zero. Finders that prove nothing give
    /// their estimate twice.
    pub enclosure: [f64; 2],
    /// How many times it is a zero, where that is known; at even ones the sign does not change.
    pub multiplicity: Option<u32>,
}

/// A finder's answer about the first zero within a stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    Found(Root),
    Absent,
    /// The finder's arithmetic or its work bound did not suffice.
    Undecided,
}
