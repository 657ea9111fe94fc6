//! Scalar fields f(x, y, z): from an expression to values, gradients and enclosures.
//!
//! [`expression`] reads the text of a scene file, [`tape`] holds the operations, [`polynomial`] and
//! [`program`] are the forms that exact and certified root finding needs. A tape is evaluated in f64
//! or in lanes ([`evaluate`]), with a running error bound ([`bounded`]) or in intervals
//! ([`interval_program`]). Where a ray meets the zeros of a field is left to `shape::implicit`.

pub mod bounded;
pub mod differentiate;
pub mod evaluate;
pub mod expression;
pub mod interval_program;
pub mod named;
pub mod normal;
pub mod outer;
pub mod over_box;
pub mod polynomial;
pub mod program;
pub mod rational;
pub mod structure;
pub mod tape;
