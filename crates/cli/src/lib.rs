//! The programs `gen-dataset` and `crosshead`: parse, one call, one message.
//!
//! Every verb is a file here: its arguments as a struct, and a `run` that calls the libraries.
//! Results go to files, summaries to standard output, progress and the one message of a failure to
//! standard error, and there the next step. Exit status: 0 done, 1 the work failed, 2 the input or the
//! arguments are wrong, 3 a dataset is not complete yet, 130 interrupted (Ctrl-C).
#![allow(clippy::print_stdout)]

#[macro_use]
mod output;

pub mod bundle;
pub mod calibrate;
pub mod check;
pub mod compare;
pub mod completions;
pub mod console;
pub mod domain_gap;
pub mod estimate_wear;
pub mod explain_gap;
pub mod failure;
pub mod features;
pub mod gen_dataset;
pub mod hidden_effects;
pub mod init;
mod interrupt;
pub mod man;
pub mod program;
mod progress;
mod reading;
pub mod replay;
pub mod report;
mod result_format;
pub mod schema;
#[cfg(feature = "serve")]
pub mod serve;
pub mod simulate;
pub mod sweep;
pub mod try_case;
pub mod verify;

pub use failure::{Failure, finish};
