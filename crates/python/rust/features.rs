//! Features of recordings, measured or simulated.

use crate::failure::wrong;
use crate::interruptible::interruptible;
use crate::table::Table;
use ::features::recorded::{CrankReference, KnownMachine, Said, Unit, WindowLength, inputs};
use cli::Failure;
use input::quantity::{AboveZero, Angle, Frequency, Quantity, Speed};
use pyo3::prelude::*;
use recordings::formats::record_batch::record_batch;
use recordings::measured::Options;
use std::path::PathBuf;
use sweep::reader::Like;
use sweep::recorded_table::recorded_table;

/// What is said of recordings: texts with their units, as on the command line.
#[derive(FromPyObject)]
pub struct Asked {
    #[pyo3(item)]
    columns: Vec<String>,
    #[pyo3(item)]
    sample_rate: Option<String>,
    #[pyo3(item)]
    unit: Option<String>,
    #[pyo3(item)]
    speed: Option<String>,
    #[pyo3(item)]
    crank_angle: Option<String>,
    #[pyo3(item)]
    tacho: Option<String>,
    #[pyo3(item)]
    top_dead_centre: Option<String>,
    #[pyo3(item)]
    machine: Option<PathBuf>,
    #[pyo3(item)]
    window: Option<String>,
    #[pyo3(item)]
    chaos: bool,
    #[pyo3(item)]
    allow_outside: bool,
}

impl Asked {
    fn said(&self) -> Result<Said, Failure> {
        let rate = |text: &str| Quantity::<Frequency, AboveZero>::named("sample_rate", text);
        let speed = |text: &str| {
            let speed = Quantity::<Speed, AboveZero>::named("speed", text);
            speed.map(|speed| speed.to_degrees() / 6.0)
        };
        let angle = |text: &str| Quantity::<Angle>::named("top_dead_centre", text);
        let unit = |text: &str| {
            let found = || format!("unit: found '{text}', expected a unit, e.g. 'm/s^2'");
            Unit::parse(text).ok_or_else(found)
        };
        Ok(Said {
            options: Options {
                columns: self.columns.clone(),
                sample_rate_hz: parsed(&self.sample_rate, rate)?,
                skipped_lines: 0,
            },
            speed_rpm: parsed(&self.speed, speed)?,
            unit: parsed(&self.unit, unit)?,
            crank: CrankReference {
                crank_angle: self.crank_angle.clone(),
                tacho: self.tacho.clone(),
                top_dead_centre: parsed(&self.top_dead_centre, angle)?,
            },
            machine: (self.machine.as_deref().map(KnownMachine::read)).transpose()?,
            allow_outside: self.allow_outside,
            motion: self.chaos,
        })
    }

    fn length(&self) -> Result<WindowLength, Failure> {
        let length = |text: &str| {
            let like = "expected a duration, e.g. '2 s', or '10 revolutions'";
            WindowLength::parse(text).map_err(|found| format!("window: found {found}, {like}"))
        };
        Ok(parsed(&self.window, length)?.unwrap_or(WindowLength::Default))
    }
}

/// An argument that may be left out.
fn parsed<T>(
    text: &Option<String>,
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<Option<T>, Failure> {
    let value = text.as_deref().map(parse).transpose();
    value.map_err(Failure::input)
}

/// The features of the recordings at `paths`, a row for each window, the recording that each row is of, and what looks
/// wrong with them.
///
/// With `like`, the folder of a dataset, these are its features, from windows as it has them.
///
/// # Errors
/// Wrong arguments, a file that cannot be read, recordings that differ from the dataset, or Ctrl-C.
#[pyfunction]
#[pyo3(signature = (paths, asked, like, progress))]
pub fn features(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    asked: Asked,
    like: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Table, Vec<String>, Vec<String>)> {
    if asked.window.is_some() && like.is_some() {
        return Err(wrong(
            "window: found one beside like, which says how long windows are",
        ));
    }
    let (table, recordings) = interruptible(py, progress, |shared| {
        let (mut said, mut length) = (asked.said()?, asked.length()?);
        let like = like.as_deref().map(Like::read);
        let like = like.transpose().map_err(Failure::input)?;
        if let Some(like) = &like {
            like.say(&mut said);
            length = like.length();
        }
        let inputs = inputs(&paths, &said).map_err(Failure::input)?;
        let threads = std::thread::available_parallelism().map_or(1, Into::into);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(Failure::work)?;
        shared.begin("windows", None, 0);
        let go_on = || {
            shared.add(1);
            !shared.is_stopped()
        };
        let table = recorded_table(&inputs, &said, length, like.as_ref(), &pool, go_on);
        let table = table.map_err(Failure::input)?;
        let recordings = table.recordings().map_err(Failure::work)?;
        Ok((table, recordings))
    })?;
    let batch = record_batch(&table.rows).map_err(crate::failure::failed)?;
    Ok((Table::of_batch(batch), recordings, table.warnings))
}
