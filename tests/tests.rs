//! The test suite, one binary.
mod spectrum;
