//! The files that people write: quantities with units, machine.yaml, their errors and schemas.
//!
//! A file is read in three steps, and a sweep joins at the second:
//!
//! ```text
//! text ──yaml──> tree of keys and values ──reader──> sections with units ──resolve──> Machine (SI)
//!                  (knows its lines)       (knows its paths)     (checks what must go together)
//! ```
//!
//! Every mistake becomes one [`Error`] with file, line, key, what was found and what was expected. All mistakes of
//! a file are found in one reading.

pub mod amount;
pub mod bundle;
pub mod bundle_channel;
mod bundle_check;
pub mod bundle_machine;
pub mod calibration;
pub mod choice;
mod dimension;
pub mod error;
pub mod file_kind;
mod form;
mod kind;
pub mod machine_file;
mod mistakes;
mod nearest;
pub mod paths;
pub mod quantity;
mod reader;
pub mod recorded_unit;
pub mod run_settings;
pub mod schema;
pub mod sided;
pub mod template;
mod tree;
pub mod unit;
mod unit_table;
pub mod yaml;
mod yaml_repair;

/// The catalogue of effects as data.
pub mod effects {
    pub use crate::machine_file::effects::{
        CATALOGUE, Choice, Entry, Kind, Parameter, Proposal, at_path, entry, of_path, proposed,
    };
}

pub use bundle_check::{check as check_bundle, machine_of_run};
pub use bundle_machine::from_bundle;
pub use error::{Error, Place, Problem, nearest};
pub use machine_file::{
    MachineFile, NormalClearance, Resolved, ThrowNormalClearance, sensor_section, synonyms,
};
pub use run_settings::run_settings;
