//! Failures of the libraries as exceptions, with the messages of the command line.

use cli::Failure;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

/// The module of the package that defines the exceptions.
const ERRORS: &str = "crosshead.errors";

/// `crosshead.InputError` where the input is wrong, `KeyboardInterrupt` where the user has stopped the work,
/// `crosshead.Error` elsewhere.
pub fn raised(failure: Failure) -> PyErr {
    let message = failure.message().to_owned();
    match failure {
        Failure::Interrupted(_) => PyKeyboardInterrupt::new_err(message),
        Failure::Input(_) => of_package("InputError", message),
        Failure::Work(_) | Failure::Incomplete(_) => of_package("Error", message),
    }
}

/// Wrong input.
pub fn wrong(message: impl ToString) -> PyErr {
    raised(Failure::input(message))
}

/// Failed work.
pub fn failed(message: impl ToString) -> PyErr {
    raised(Failure::work(message))
}

fn of_package(name: &str, message: String) -> PyErr {
    Python::attach(|py| {
        let class = py.import(ERRORS).and_then(|errors| errors.getattr(name));
        match class.and_then(|class| class.call1((message,))) {
            Ok(error) => PyErr::from_value(error),
            Err(error) => error,
        }
    })
}
