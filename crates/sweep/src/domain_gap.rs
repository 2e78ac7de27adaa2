//! How far the simulated windows of a dataset differ from measured ones.

use crate::reader::{self, Dataset, LabelledSample, matrix};
use crate::recorded_table::RecordedTable;
use classify::{DomainGap, Sample};

/// Folds of the cross-validation.
pub const CROSS_VALIDATION: usize = 5;

/// What stands in the way.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A dataset that cannot be read.
    #[error(transparent)]
    Dataset(#[from] reader::Error),
    /// A table of recordings that lacks a column.
    #[error(transparent)]
    Recordings(#[from] recordings::Error),
    /// Too few to train on one part and test on the other.
    #[error(
        "recordings: found {measured} measured and {simulated} simulated ones, expected at least {expected} of either: \
         windows of one recording are not independent of each other"
    )]
    TooFew {
        /// Measured recordings.
        measured: usize,
        /// Groups of simulated cases.
        simulated: usize,
        /// So many folds.
        expected: usize,
    },
}

/// Windows of a dataset beside those of recordings.
#[derive(Clone, Debug)]
pub struct Compared {
    /// How far they differ.
    pub gap: DomainGap,
    /// Names of the features, in the order of the columns below.
    pub names: Vec<String>,
    /// The windows of the dataset.
    pub simulated: Sample,
    /// Those of the recordings.
    pub measured: Sample,
}

/// Compares all windows of a dataset with those of recordings, whose table has its features. Windows of one recording or of
/// one group of cases are never on both sides of a fold.
///
/// # Errors
/// [`Error`].
pub fn domain_gap(
    dataset: &Dataset,
    recordings: &RecordedTable,
    seed: u64,
) -> Result<Compared, Error> {
    let LabelledSample {
        names,
        sample: simulated,
        ..
    } = dataset.sample(None, "fault")?;
    let measured = Sample {
        values: matrix(&recordings.rows, &names)?,
        groups: recordings.recordings()?,
    };
    let gap = between(&names, &simulated, &measured, CROSS_VALIDATION, seed)?;
    Ok(Compared {
        gap,
        names,
        simulated,
        measured,
    })
}

/// The same of rows whose columns have these names, in so many folds.
///
/// # Errors
/// [`Error::TooFew`].
pub fn between(
    names: &[String],
    simulated: &Sample,
    measured: &Sample,
    folds: usize,
    seed: u64,
) -> Result<DomainGap, Error> {
    classify::domain_gap(names, simulated, measured, folds, seed).ok_or_else(|| Error::TooFew {
        measured: measured.distinct(),
        simulated: simulated.distinct(),
        expected: folds.max(2),
    })
}
