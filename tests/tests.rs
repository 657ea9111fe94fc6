//! The test suite, one binary.

mod cli;
mod cli_render;
mod film_files;
mod fresnel;
mod implicit_expression;
mod implicit_field;
mod implicit_interval;
mod implicit_invented;
mod implicit_oracle;
mod lane_functions;
mod lane_shapes;
mod lanes_support;
mod lights;
mod many_objects;
mod metrics;
mod oracle_primitives;
mod sampling;
mod scene_file;
mod shape_ladder;
mod shape_list;
mod soundness;
mod spectrum;
mod statistics_support;
mod truth_file;
mod truths;
mod wavelength_grid;
