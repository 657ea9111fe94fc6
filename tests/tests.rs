//! The test suite, one binary.
mod scene_file;
mod spectrum;
