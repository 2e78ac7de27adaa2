//! The programs `gen-dataset` and `crosshead`: parse, one call, one message.
//!
//! Every verb is a file here: its arguments as a struct, and a `run` that calls the libraries.
//! Results go to files, summaries to standard output, progress and the one message of a failure to
//! standard error, and there the next step. Exit status: 0 done, 1 the work failed, 2 the input or the
//! arguments are wrong, 3 a dataset is not complete yet, 130 interrupted (Ctrl-C).
#![allow(clippy::print_stdout)]

#[macro_use]
mod output;
#[macro_use]
mod verbs;

mod bundle;
pub mod calibrate;
mod check;
mod choice;
mod compare;
mod completions;
mod console;
mod domain_gap;
mod estimate_wear;
pub mod explain_gap;
mod failure;
mod features;
mod gen_dataset;
mod hidden_effects;
mod init;
mod interrupt;
mod man;
pub mod program;
mod progress;
mod reading;
mod replay;
pub mod report;
mod result_format;
mod schema;
#[cfg(feature = "serve")]
mod serve;
mod simulate;
mod sweep;
pub mod try_case;
mod verify;

pub use failure::{Failure, finish};
