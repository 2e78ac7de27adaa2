//! The tests of input, in one program.

mod bundle;
mod bundle_machine;
mod clearance_relation;
mod data_sheet;
mod effects;
mod errors;
mod machine_file;
mod materials;
mod quantities;
mod schema;
mod tables;
mod template;
mod two_stage;
