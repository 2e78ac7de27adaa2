//! The table of features of recordings, measured or simulated: a row for each window.
//!
//! ```text
//! inputs()            the files that paths name, and what their bundles say of them
//! Table::new(inputs)  the columns over all files
//! Table::windows()    the windows of all files, in order
//! row(window)         its row; rows depend on their window alone
//! recorded(window)    its channels in SI
//! ```

mod counted;
mod error;
mod inputs;
mod jobs;
mod machine;
mod shaft;
mod summary;
mod table;
mod units;
mod window_length;

pub use counted::counted;
pub use error::Error;
pub use inputs::{Input, Said, inputs};
pub use jobs::Jobs;
pub use machine::KnownMachine;
pub use shaft::Asked as CrankReference;
pub use summary::Summary;
pub use table::{Job, Recorded, Row, recorded, row};
pub use units::Unit;
pub use window_length::WindowLength;

use recordings::Schema;
use std::collections::BTreeSet;
use table::{Columns, Layout};
use units::Role;

/// The table of features of some files.
pub struct Table<'a> {
    inputs: &'a [Input],
    layouts: Vec<Layout>,
    schema: Schema,
}

impl<'a> Table<'a> {
    /// Opens every file to find the columns.
    ///
    /// # Errors
    /// A file that cannot be read, or does not go together with the others or with what is `said`.
    pub fn new(inputs: &'a [Input], said: &Said) -> Result<Self, Error> {
        let mut labels = Columns::default();
        let layouts = inputs
            .iter()
            .map(|input| Layout::new(input, &input.open()?, said, &mut labels));
        let mut layouts = layouts.collect::<Result<Vec<_>, _>>()?;
        let schema = table::schema(labels, &mut layouts)?;
        Ok(Self {
            inputs,
            layouts,
            schema,
        })
    }

    /// The columns.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// Names and units of the channels that have features.
    pub fn channels(&self) -> BTreeSet<(&str, &str)> {
        let channels = self.layouts.iter().flat_map(|layout| &layout.channels);
        let measured = channels.filter(|channel| channel.role == Role::Measured);
        measured
            .map(|channel| (channel.name.as_str(), channel.unit.as_str()))
            .collect()
    }

    /// The first file that has channels without a unit that is known, and these.
    pub fn without_unit(&self) -> Option<(&str, &[String])> {
        let mut layouts = self.layouts.iter();
        let layout = layouts.find(|layout| !layout.without_unit.is_empty())?;
        Some((&layout.file, &layout.without_unit))
    }

    /// The windows of all files, in order.
    pub fn windows(self, length: WindowLength) -> Jobs<'a> {
        Jobs::new(
            self.inputs,
            self.layouts,
            self.schema.columns().len(),
            length,
        )
    }
}
