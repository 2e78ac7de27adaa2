//! The programs of the wheel: the same code as that of the package, called with the arguments of a command line.

use crate::failure::wrong;
use cli::program::{Crosshead, GenDataset, main};
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;

/// Does what `arguments` say, the first of which is the program's own name, and gives the exit status.
///
/// # Errors
/// A program of another name than `crosshead` and `gen-dataset`.
#[pyfunction]
pub fn program(py: Python<'_>, name: &str, arguments: Vec<OsString>) -> PyResult<u8> {
    let main = match name {
        "crosshead" => main::<Crosshead>,
        "gen-dataset" => main::<GenDataset>,
        other => return Err(wrong(format!("no program is called {other}"))),
    };
    Ok(py.detach(|| main(arguments)))
}

/// Names the program that simulates single cases in processes of their own, and the jobs of a cluster.
#[pyfunction]
pub fn set_program(path: PathBuf) {
    sweep::program::set(path);
}

/// Writes the page of a dataset, a calibration, wear or an explanation to the file `out`.
///
/// # Errors
/// A folder that holds none of them, or a page that cannot be made or written.
#[pyfunction]
pub fn page(py: Python<'_>, folder: PathBuf, out: PathBuf) -> PyResult<()> {
    let written = py.detach(|| cli::report::write(&folder, &out));
    written.map(drop).map_err(crate::failure::raised)
}
