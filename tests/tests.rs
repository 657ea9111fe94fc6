//! The test suite, one binary.

mod cli;
mod film_files;
mod oracle_primitives;
mod scene_file;
mod shape_ladder;
mod shape_list;
mod spectrum;
mod truths;
