//! Whether recordings have the columns that a bundle asks them for, seen from their headings alone.

use input::bundle::{Bundle, Run};
use input::bundle_channel::Meaning;
use input::{Error, Problem};
use recordings::measured::{MeasuredChannel, MeasuredFile, Options};
use serde_json::Value;
use std::path::Path;

/// The recordings of a bundle that cannot be opened, and the columns that one lacks, with their lines in
/// `recordings.yaml`. Recordings that are not there are passed over, and so are runs whose channels are not understood.
pub fn wrong_columns(bundle: &Bundle) -> Vec<Error> {
    let machine = input::from_bundle(&bundle.machine).unwrap_or(Value::Null);
    let runs = bundle.runs.iter().enumerate();
    let wrong = runs.flat_map(|(i, run)| {
        let meanings = bundle.meanings(i, &machine).unwrap_or_default();
        let wrong = of_run(bundle, run, &meanings).into_iter();
        wrong.map(move |error| error.under(format!("runs.{i}")))
    });
    wrong.map(|error| bundle.locate(error)).collect()
}

fn of_run(bundle: &Bundle, run: &Run, meanings: &[Meaning]) -> Vec<Error> {
    let is_used =
        |i: usize| !matches!(meanings.get(i), None | Some(Meaning::Time | Meaning::Other));
    let mut wrong = Vec::new();
    for (index, (file, _)) in run.recordings().enumerate() {
        let path = match bundle.path_of_file(run, index) {
            Ok(path) if path.exists() => path,
            _ => continue,
        };
        let known = match channels(&path) {
            Ok(known) => known,
            Err(error) => {
                let key = match run.files.is_empty() {
                    true => "file".to_owned(),
                    false => format!("files.{index}"),
                };
                wrong.push(Error::new(key, Problem::Other(error.to_string())));
                continue;
            }
        };
        let columns: Vec<&str> = known.iter().map(|c| c.column.as_str()).collect();
        for (i, channel) in run.channels_of(file).filter(|(i, _)| is_used(*i)) {
            if !known.iter().any(|found| found.is_called(&channel.column)) {
                let key = format!("channels.{i}.column");
                wrong.push(Error::unknown_name(key, &channel.column, &columns));
            }
        }
    }
    wrong
}

/// The channels of a file, all of them.
fn channels(path: &Path) -> Result<Vec<MeasuredChannel>, recordings::Error> {
    let file = MeasuredFile::open(path, &Options::default())?;
    Ok(file.channels().to_vec())
}
