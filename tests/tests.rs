//! The test suite, one binary.

mod oracle_primitives;
mod shape_ladder;
mod shape_list;
