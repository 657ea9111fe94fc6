//! Error against cost, as pictures: tables of renders gathered into curves and drawn as SVG.
//!
//! A [`Row`] is one render, as [`row::read`] finds it in a table, whichever program rendered.
//! [`curves()`] gathers rows that differ in the abscissa and the seed only, and [`figures`] makes a
//! [`Figure`] of them.

mod curve;
mod figure;
pub mod figures;
mod key;
pub mod row;

pub use curve::{Curve, Mean, Point, best, curves, front};
pub use figure::{Figure, FigureError, Guide, MARKERS, Mark, Series};
pub use key::Key;
pub use row::Row;
