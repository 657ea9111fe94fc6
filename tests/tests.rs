//! The test suite, one binary.

mod film_files;
mod spectrum;
