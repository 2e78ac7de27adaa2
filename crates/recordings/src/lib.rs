//! Tables of recordings and features, and their files: Parquet, MCAP and CSV.
//!
//! - [`Table`]: columns with a name, a unit and a description, and rows checked against them;
//! - [`formats`]: one file per format; the only place in the workspace that knows Arrow and MCAP;
//! - [`measured`]: recordings of any origin, read a stretch at a time;
//! - [`WholeFile`]: a file that appears whole or not at all, with its size and checksum;
//! - [`shell`]: words of the shell, for commands to paste;
//! - [`DatasetCard`], [`croissant()`] and [`Manifest`]: what a dataset says about itself, to people and programs.
//!
//! A table reaches the disk through three steps, each of which hands the writer on:
//!
//! ```
//! # fn main() -> Result<(), recordings::Error> {
//! # let folder = tempfile::tempdir().unwrap();
//! # let (temporary, destination) = (folder.path().join("a.part"), folder.path().join("a.parquet"));
//! use recordings::{Column, Kind, Schema, WholeFile, formats::parquet::TableWriter};
//!
//! let schema = Schema::new(vec![
//!     Column::new("case_id", Kind::Text, "name of the case"),
//!     Column::new("acceleration_m_s2", Kind::Samples, "of the crosshead").unit("m/s^2"),
//! ])?;
//! let file = WholeFile::create(&temporary, &destination)?;
//! let mut table = TableWriter::new(file, &schema, 256)?;
//! table.write(vec!["case-0".into(), vec![0.5_f32, -0.5].into()])?;
//! let record = table.finish()?.commit()?;
//! assert_eq!(record.sha256.len(), 64);
//! # Ok(())
//! # }
//! ```

pub mod formats;
pub mod measured;
pub mod shell;

mod croissant;
mod dataset_card;
mod error;
mod licence;
mod manifest;
mod schema;
mod table;
mod value_kind;
mod whole_file;

pub use croissant::croissant;
pub use dataset_card::{DatasetCard, Subset};
pub use error::Error;
pub use licence::Licence;
pub use manifest::{CaseWarning, ColumnEntry, Counts, FailedCase, FileEntry, Manifest};
pub use schema::{Column, Role, Schema};
pub use table::{Cell, Data, Table, Value};
pub use value_kind::Kind;
pub use whole_file::{FileRecord, WholeFile, sync_folder};
