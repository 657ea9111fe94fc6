//! Ways in for tests: functions that are not generic, so that whoever calls them compiles no lanes.

pub mod material;
