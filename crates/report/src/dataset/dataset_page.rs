//! The page of a dataset, from its tables.

use super::{about, cases, columns};
use crate::Error;
use crate::dataset_page::{DatasetPage, Design};
use study::{baseline, counts, examples, features, grid, operation, random, ranking};
use sweep::reader::Dataset;

impl DatasetPage {
    /// The page of a dataset.
    ///
    /// # Errors
    /// A table that cannot be read.
    pub fn from_dataset(dataset: &Dataset) -> Result<Self, Error> {
        let faults = counts::faults(dataset);
        let sample = dataset.sample(None, "fault")?;
        let examples = examples::examples(dataset, &faults)?;
        let motions = match dataset.plan.study {
            Some(_) => Some(dataset.motions()?),
            None => None,
        };
        let design = match grid::grids(dataset, motions.as_ref())? {
            Some(grids) => Design::Grid(grids),
            None => Design::Random(random::sweep(dataset, &faults)),
        };
        let ranks = ranking::ranking(&sample);
        let (features, feature_rows) = features::by_fault(dataset, &faults);
        let channels = dataset.plan.channels().into_iter();
        Ok(Self {
            name: dataset.plan.name.clone(),
            about: about::dataset(dataset),
            version: dataset.manifest().version.clone(),
            seed: dataset.manifest().seed,
            sample_rate_hz: dataset.plan.settings.sample_rate,
            samples_per_revolution: (dataset.plan.over_angle).map(|of| of.samples_per_revolution),
            revolutions_per_window: dataset.revolutions_per_window(),
            samples_per_window: counts::samples_per_window(dataset),
            channels: channels.map(|(name, _)| name).collect(),
            joints: dataset.joints(),
            splits: dataset.splits(),
            ranges: counts::ranges(dataset),
            failed: counts::failed(dataset),
            warnings: dataset.manifest().warnings.clone(),
            no_examples: about::no_recordings(dataset).to_owned(),
            examples,
            design,
            operation: operation::operation(dataset, &faults)?,
            baseline: baseline::baseline(dataset)?,
            by_class: ranking::by_class(dataset, &faults, &sample, &ranks)?,
            ranking: ranks,
            cases: cases::cases(dataset, &faults, &sample)?,
            features,
            feature_rows,
            columns: columns::columns(dataset)?,
            faults,
        })
    }
}
