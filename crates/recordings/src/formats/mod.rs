//! One file or folder per format.
//!
//! A format of recordings takes a module with a `FORMAT` (its name, the endings of its files, how its first bytes
//! are recognised, and its reader) and a line in the list below.

mod guarded;
pub mod record_batch;
pub(crate) mod recording_format;
pub mod table_file;

use recording_format::RecordingFormat;

/// The one list of the formats of recordings.
macro_rules! formats {
    ($( $vis:vis $module:ident, )*) => {
        $( $vis mod $module; )*

        /// The formats of recordings.
        pub(crate) const FORMATS: &[RecordingFormat] = &[$( $module::FORMAT ),*];
    };
}

formats! {
    pub csv,
    pub(crate) wav,
    pub(crate) mat,
    pub(crate) hdf5,
    pub parquet,
    pub mcap,
}
