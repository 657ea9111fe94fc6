//! Error against cost, as pictures: tables of renders gathered into curves and drawn as SVG.
//!
//! A [`Row`] is one render, as [`row::read`] finds it in a table, whichever program rendered.
//! [`curves()`] gathers rows that differ in the abscissa and the seed only, and [`figures`] makes a
//! [`Figure`] of them.

mod curve;
mod figure;
pub mod figures;
pub mod row;

pub use curve::{Curve, Point, best, curves};
pub use figure::{Figure, FigureError};
pub use row::{Key, Row};
