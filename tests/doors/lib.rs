//! What tests, benchmarks and checks ask of etalon's lane code.
//!
//! Generic code is compiled where it is used. These functions are not generic: they are compiled
//! once, here, and a test that changes compiles no lanes. Each takes an instruction set and, unless
//! its arguments tell, a precision. Numbers come as f64 and are rounded to the precision first;
//! results are widened exactly.

#![allow(missing_docs, reason = "for this repository's tests alone")]

mod columns;
pub mod fields;
pub mod functions;
pub mod intervals;
pub mod lights;
pub mod material;
pub mod models;
pub mod samplers;
pub mod shapes;
pub mod words;

/// Tables of lane code, made in one of the precisions.
#[derive(Debug, Clone, Copy)]
pub enum Made<S, D> {
    Single(S),
    Double(D),
}
