//! CSV of plain columns, for spreadsheets and for a look with the naked eye (RFC 4180).

pub(crate) mod read;
mod write;

pub use write::write_table;
