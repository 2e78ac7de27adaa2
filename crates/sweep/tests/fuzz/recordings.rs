//! Recordings that strangers hand in, in every format that is read.

use crate::parts::{Parts, Split};
use crate::trial::{executions, seeds, trial};
use recordings::Error;
use recordings::formats::parquet::read_table;
use recordings::measured::{MeasuredFile, Options};
use std::path::Path;

/// Samples that are read of a file.
const MOST: usize = 1 << 22;

/// Tries the reader of recordings that end in `kind`.
pub fn recordings(kind: &'static str, split: Split) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("recording.{kind}"));
    trial(
        kind,
        seeds(kind),
        Parts(split),
        executions(300, 100),
        move |file| {
            let _keep = &folder;
            std::fs::write(&path, file).unwrap();
            read(&path).map_err(|error| error.to_string())
        },
    );
}

/// Reads a file as `features`, a bundle and a report do.
fn read(path: &Path) -> Result<String, Error> {
    let file = MeasuredFile::open(path, &Options::default())?;
    let channels = file.channels().len();
    let mut left = MOST;
    let mut found = 0;
    for recording in file {
        let mut recording = recording?;
        let mut samples = vec![Vec::new(); channels];
        found += 1;
        while left > 0 {
            let block = recording.read(left, &mut samples)?;
            if block.samples == 0 {
                break;
            }
            left -= block.samples.min(left);
            samples.iter_mut().for_each(Vec::clear);
        }
    }
    if path.extension().is_some_and(|ending| ending == "parquet") {
        read_table(path)?;
    }
    Ok(format!("{channels} channels, {found} recordings"))
}
