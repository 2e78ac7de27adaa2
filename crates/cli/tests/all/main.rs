//! The tests of the command line, in one program.

mod calibrate;
mod calibrated_sweep;
mod check;
mod compare;
mod console;
mod damage;
mod dataset;
mod dataset_bytes;
mod domain_gap;
mod estimate_wear;
mod explain_gap;
mod explain_pressures;
mod features;
mod features_shaft;
mod first_look;
mod hidden_effects;
mod hostile;
mod json;
mod one_run;
mod output;
mod own_machine;
mod plant;
mod readme;
mod recorded_sensors;
mod recovery;
mod replay;
mod report;
mod serve;
mod several_files;
mod shards;
mod small_sweep;
mod transcripts;
#[path = "../../../../tests/readers/venv.rs"]
mod venv;
mod verdicts;
mod wrong_files;
