//! The Rust side of the Python package `crosshead`.
//!
//! It parses arguments, makes one call into a library crate, and hands tables over by Arrow's C interface. What Python
//! users see is in `python/crosshead`, which calls the functions of this module. Values of files travel as JSON text.
//!
//! Work runs on a thread of its own without the interpreter's lock ([`interruptible`]). Meanwhile the calling thread looks
//! for signals, so that Ctrl-C stops it, and shows progress.

mod angle;
mod calibrate;
mod column;
mod dataset;
mod domain_gap;
mod explain_gap;
mod failure;
mod features;
mod generate;
mod interruptible;
mod machine;
mod program;
mod settings;
mod signal_batches;
mod simulate;
mod stream;
mod table;
mod wear;

use pyo3::prelude::*;

/// The functions and types that the package is made of.
#[pymodule(gil_used = false)]
mod _crosshead {
    use super::*;
    #[pymodule_export]
    use crate::angle::over_crank_angle;
    #[pymodule_export]
    use crate::calibrate::calibrate;
    #[pymodule_export]
    use crate::column::Column;
    #[pymodule_export]
    use crate::dataset::{Description, ParquetFiles, TableIterator, open_dataset};
    #[pymodule_export]
    use crate::domain_gap::domain_gap;
    #[pymodule_export]
    use crate::explain_gap::explain_gap;
    #[pymodule_export]
    use crate::features::features;
    #[pymodule_export]
    use crate::generate::generate;
    #[pymodule_export]
    use crate::machine::Machine;
    #[pymodule_export]
    use crate::program::{page, program, set_program};
    #[pymodule_export]
    use crate::signal_batches::{SignalBatches, signal_batches};
    #[pymodule_export]
    use crate::simulate::{Run, simulate};
    #[pymodule_export]
    use crate::table::Table;
    #[pymodule_export]
    use crate::wear::estimate_wear;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
