//! The test suite, one binary. It compiles no lane code: tests that ask lanes knock at `etalon-doors`.

#![allow(clippy::too_many_lines, reason = "tables of cases are long")]

mod agreement;
mod cli;
mod cli_render;
mod compare;
mod convergence;
mod equilibrium;
mod film_files;
mod fresnel;
mod front_door;
mod implicit_afar;
mod implicit_expression;
mod implicit_field;
mod implicit_fuzz;
mod implicit_interval;
mod implicit_invented;
mod implicit_oracle;
mod lane_functions;
mod lane_shapes;
mod lanes_support;
mod lights;
mod many_implicits;
mod many_lights;
mod many_objects;
mod materials;
mod metrics;
mod mirror_chains;
mod mistakes;
mod occluders;
mod oracle_primitives;
mod oracle_support;
#[cfg(feature = "planted")]
mod phong_pictures;
mod plan_bounds;
mod plan_full;
mod polynomial_support;
mod references;
mod render_goal;
mod rooms;
mod sampling;
mod scene_file;
mod shape_ladder;
mod shape_list;
mod slopes;
mod soundness;
mod spectrum;
mod statistics;
mod statistics_support;
mod study;
mod truth_file;
mod truths;
mod wavelength_grid;
mod wavelength_pdfs;
