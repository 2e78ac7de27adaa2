//! Results in a few lines of plain text.

mod comparison;
mod domain_gap;
mod run;

pub use comparison::comparison;
pub use domain_gap::domain_gap;
pub use run::{analysis, motion, run};
pub(crate) use run::{rpm, too_deep};

/// Features that are named.
const NAMED: usize = 10;

/// A number that there may not be.
fn number(value: Option<f64>) -> String {
    value.map_or("none".to_owned(), |value| text::number(value, 3))
}
