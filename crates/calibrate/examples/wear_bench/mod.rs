//! Cases with known clearances, what an estimation makes of them, and the table of both.

mod case;
pub mod other;
pub mod own;
mod table;

pub use table::Table;
