//! `recordings.yaml`: a folder of measured runs of one machine.
//!
//! Programs write it, so its values are SI with the unit at the end of the key. The machine section
//! is handed on as it stands: what is read from it depends on what it is wanted for. A bundle of a
//! machine with one throw is one with the throw ``, so that load and joints have one shape.

pub use crate::bundle_channel::Channel;

use crate::bundle_channel::{Meaning, is_time, meaning};
use crate::choice::{Ideal, Or};
use crate::error::{Error, Problem, nearest};
use crate::quantity::{AboveZero, FromZero, Number};
use crate::schema::{BUNDLE_FORMAT, bundle_schema};
use crate::yaml::Document;
use serde::Deserialize;
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

/// Name of the file that makes a folder a bundle.
pub const FILE: &str = "recordings.yaml";

/// Speed that is taken for a recording over the crank angle alone, rpm: pressures over the angle do not depend on it.
pub const ANY_SPEED: f64 = 60.0;

/// A folder of measured runs.
#[derive(Clone, Debug)]
pub struct Bundle {
    /// The folder.
    pub folder: PathBuf,
    /// The machine as its user knows it, as it stands in the file; null where there is none.
    pub machine: Value,
    /// The runs, at least one, each with an `id` of its own.
    pub runs: Vec<Run>,
    /// Whether a recording may lie outside of the folder; false in a bundle that has just been read.
    pub allow_outside: bool,
    document: Document,
}

/// A run at one operating point.
#[derive(Clone, Debug, Deserialize)]
pub struct Run {
    /// Its name.
    pub id: String,
    /// Its recording, a path from the folder on; the first one where it has several.
    #[serde(default)]
    pub file: PathBuf,
    /// Its recordings where it has several, each with channels of its own.
    #[serde(default)]
    pub files: Vec<Or<PathBuf, FileOfRun>>,
    /// Measured mean speed, rpm.
    pub speed_rpm: Option<Number<AboveZero>>,
    /// Speed at which a free crank's torque is the mean torque, rpm.
    pub speed_reference_rpm: Option<Number<AboveZero>>,
    /// Gas pressures, by throw.
    #[serde(default)]
    pub load: BTreeMap<String, Load>,
    /// Clearance of the joints as the user believes it, by throw and joint.
    #[serde(default)]
    pub joints: BTreeMap<String, BTreeMap<String, Joint>>,
    /// Samples per second.
    pub sample_rate_hz: Option<Number<AboveZero>>,
    /// Samples of every channel.
    pub samples: Option<u64>,
    /// Revolutions that the recording covers.
    pub revolutions: Option<Number<FromZero>>,
    /// The channels, at least one.
    pub channels: Vec<Channel>,
    /// The run as it stands in the file.
    #[serde(skip)]
    pub section: Value,
}

/// One of several recordings of a run.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileOfRun {
    /// The recording, a path from the folder on.
    pub file: PathBuf,
    /// Time of its first sample on the clock that the files of the run share, s; where it is left out, as its column
    /// of time has it.
    #[serde(default)]
    pub start_s: Option<Number>,
}

/// The gas pressures of a throw, absolute.
#[derive(Clone, Debug, Deserialize)]
pub struct Load {
    /// Suction pressure, Pa.
    pub suction_pressure_pa: Number<FromZero>,
    /// Discharge pressure, Pa.
    pub discharge_pressure_pa: Number<FromZero>,
}

/// A joint: `ideal`, or with a clearance.
pub type Joint = Or<Ideal, Clear>;

/// A joint with clearance.
#[derive(Clone, Debug, Deserialize)]
pub struct Clear {
    /// Radial clearance, m.
    pub clearance_m: Number<FromZero>,
}

/// The keys of a run, to find slips of the keyboard among those that are unknown.
const KEYS: [&str; 11] = [
    "id",
    "file",
    "files",
    "speed_rpm",
    "speed_reference_rpm",
    "load",
    "joints",
    "sample_rate_hz",
    "samples",
    "revolutions",
    "channels",
];

/// The keys at the top of the file.
const TOP: [&str; 3] = ["format", "machine", "runs"];

/// The keys of a channel.
const CHANNEL: [&str; 6] = [
    "name",
    "column",
    "unit",
    "file",
    "offset",
    "crank_angle_rad",
];

/// The keys of a throw's load.
const LOAD: [&str; 2] = ["suction_pressure_pa", "discharge_pressure_pa"];

/// The keys of a clear joint.
const CLEAR: [&str; 1] = ["clearance_m"];

/// The joints of a throw.
const JOINTS: [&str; 3] = ["big_end", "small_end", "guide"];

impl Run {
    /// Its recordings, with the time of the first sample where the bundle states it, s.
    pub fn recordings(&self) -> impl Iterator<Item = (&Path, Option<f64>)> {
        let only = self.files.is_empty().then_some((self.file.as_path(), None));
        let several = self.files.iter().map(|file| match file {
            Or::Scalar(file) => (file.as_path(), None),
            Or::Section(of_run) => (
                of_run.file.as_path(),
                of_run.start_s.map(|start| start.get()),
            ),
        });
        only.into_iter().chain(several)
    }

    /// The channels that stand in this one of its recordings, with their places in the list.
    pub fn channels_of(&self, file: &Path) -> impl Iterator<Item = (usize, &Channel)> {
        let channels = self.channels.iter().enumerate();
        channels.filter(move |(_, channel)| channel.file.as_deref().unwrap_or(&self.file) == file)
    }
}

impl Bundle {
    /// Whether `path` is a folder with a `recordings.yaml`, or that file itself.
    pub fn is_at(path: &Path) -> bool {
        path.join(FILE).is_file() || path.file_name().is_some_and(|name| name == FILE)
    }

    /// Reads the bundle at `path`, a folder or its `recordings.yaml`. The recordings themselves are
    /// not opened. Keys that are not known are passed over, as the format may grow, unless they look
    /// like a misspelt one.
    ///
    /// # Errors
    /// All mistakes, with their lines.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let (folder, file) = if path.file_name().is_some_and(|name| name == FILE) {
            (path.parent().unwrap_or(Path::new("")), path.to_owned())
        } else {
            (path, path.join(FILE))
        };
        Self::new(folder, Document::open(&file)?)
    }

    /// The bundle in `folder` whose `recordings.yaml` has the content `document`.
    ///
    /// # Errors
    /// All mistakes, with their lines.
    pub fn new(folder: &Path, document: Document) -> Result<Self, Error> {
        let runs = document.collect(bundle_schema, |tree| {
            known_format(tree).and_then(|()| runs(tree))
        })?;
        Ok(Self {
            folder: folder.to_owned(),
            machine: document.tree.get("machine").cloned().unwrap_or_default(),
            runs,
            allow_outside: false,
            document,
        })
    }

    /// Where the recording of a run lies. A bundle may come from a stranger, and names only what lies in its folder
    /// unless [`Bundle::allow_outside`] says otherwise.
    ///
    /// # Errors
    /// A recording that lies elsewhere: an absolute path, one with `..`, or one through a link that leads out.
    pub fn path_of(&self, run: &Run) -> Result<PathBuf, Error> {
        self.path_of_file(run, 0)
    }

    /// Where recording `index` of a run lies.
    ///
    /// # Errors
    /// As [`Bundle::path_of`].
    pub fn path_of_file(&self, run: &Run, index: usize) -> Result<PathBuf, Error> {
        let file = run
            .recordings()
            .nth(index)
            .map_or(run.file.as_path(), |(file, _)| file);
        let path = self.folder.join(file);
        let within = file
            .components()
            .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        // The caller that opens it reports one that is missing.
        let leads_out = || match (path.canonicalize(), self.folder().canonicalize()) {
            (Ok(path), Ok(folder)) => !path.starts_with(folder),
            _ => false,
        };
        if self.allow_outside || within && !leads_out() {
            return Ok(path);
        }
        let i = self.runs.iter().position(|other| other.id == run.id);
        let key = match run.files.get(index) {
            None => "file".to_owned(),
            Some(Or::Scalar(_)) => format!("files.{index}"),
            Some(Or::Section(_)) => format!("files.{index}.file"),
        };
        let key = format!("runs.{}.{key}", i.unwrap_or(0));
        let expected = "a file in the folder of the bundle; --allow-outside reads others";
        Err(self.locate(Error::clash(key, expected)))
    }

    /// The folder, which is `.` where its path is empty.
    fn folder(&self) -> &Path {
        match self.folder.as_os_str().is_empty() {
            true => Path::new("."),
            false => &self.folder,
        }
    }

    /// What the channels of run `index` are, in their order. `machine` is the content of the machine file, or
    /// the bundle's own section; null where the machine is not known. Its throws give the channels their names.
    ///
    /// # Errors
    /// A channel whose unit or name is not understood.
    pub fn meanings(&self, index: usize, machine: &Value) -> Result<Vec<Meaning>, Error> {
        self.meanings_on(index, &throws(machine))
    }

    /// What the channels of run `index` are, in their order, on a machine whose throws have these names, as
    /// [`meaning`] takes them.
    ///
    /// # Errors
    /// A channel whose unit or name is not understood.
    pub fn meanings_on(&self, index: usize, throws: &[String]) -> Result<Vec<Meaning>, Error> {
        let throws: Vec<&str> = throws.iter().map(String::as_str).collect();
        let channels = self.runs[index].channels.iter().enumerate();
        channels
            .map(|(i, channel)| {
                meaning(channel, &throws)
                    .map_err(|error| self.locate(error.under(format!("runs.{index}.channels.{i}"))))
            })
            .collect()
    }

    /// `error`, whose key is a dotted path (`runs.0.file`), with the line where that stands.
    pub fn locate(&self, error: Error) -> Error {
        self.document.locate(error)
    }
}

/// The names of the throws of a machine file's content; one empty name for a machine of one, none for no machine.
fn throws(machine: &Value) -> Vec<String> {
    if machine.is_null() {
        return Vec::new();
    }
    let Some(throws) = machine["throws"].as_array() else {
        return vec![String::new()];
    };
    let names = throws.iter().map(|throw| throw["name"].as_str());
    names
        .map(|name| name.unwrap_or_default().to_owned())
        .collect()
}

/// Checks that the file is of the format that is read here; one that does not say is taken for it.
fn known_format(tree: &Value) -> Result<(), Error> {
    known_keys(tree, &TOP)?;
    match tree.get("format") {
        None => Ok(()),
        Some(Value::String(format)) if format == BUNDLE_FORMAT => Ok(()),
        Some(_) => Err(Error::clash("format", format_args!("'{BUNDLE_FORMAT}'"))),
    }
}

fn runs(tree: &Value) -> Result<Vec<Run>, Error> {
    let list = match tree.get("runs") {
        Some(Value::Array(list)) if !list.is_empty() => list,
        Some(_) => return Err(Error::clash("runs", "a list of one run or more")),
        None => return Err(Error::missing("runs")),
    };
    let mut ids = BTreeSet::new();
    let mut runs = Vec::new();
    for (i, run) in list.iter().enumerate() {
        let key = format!("runs.{i}");
        let run = read_run(run).map_err(|error| error.under(&key))?;
        if !ids.insert(run.id.clone()) {
            return Err(Error::clash(
                format!("{key}.id"),
                "an id of its own for every run",
            ));
        }
        runs.push(run);
    }
    Ok(runs)
}

/// Whether `section` holds a section of the keys `own` for each throw, in place of these keys themselves.
/// The machine does not decide it: it may stand in another file.
fn is_by_throw(section: &Value, own: &[&str]) -> bool {
    let of_throw = |value: &Value| {
        let keys = value.as_object().map(|part| part.keys());
        keys.is_some_and(|mut keys| keys.any(|key| nearest(key, own.iter().copied()).is_some()))
    };
    let throws = section.as_object();
    throws.is_some_and(|throws| throws.values().any(of_throw))
}

/// Refuses a key that is probably a misspelt one of `known`. Others are passed over: a format may grow.
fn known_keys(section: &Value, known: &[&str]) -> Result<(), Error> {
    let keys = section.as_object().into_iter().flat_map(Map::keys);
    let mut unknown = keys.filter(|key| !known.contains(&key.as_str()));
    // The beginning of several, as `speed`, is near to none of them.
    let begins = |key: &str| key.len() >= 4 && known.iter().any(|known| known.starts_with(key));
    let is_near =
        |key: &str| nearest(key, known.iter().copied()).is_some_and(|near| !key.starts_with(near));
    match unknown.find(|key| is_near(key) || begins(key)) {
        Some(key) => Err(Error::unknown_key(key, known)),
        None => Ok(()),
    }
}

/// Checks that the run has one recording or several, and that each channel says in which it stands.
fn check_files(run: &Run, section: &Value) -> Result<(), Error> {
    match (section.get("file"), section.get("files")) {
        (None, None) => return Err(Error::missing("file")),
        (Some(_), Some(_)) => return Err(Error::clash("files", "it or file, not both")),
        (None, Some(_)) if run.files.is_empty() => {
            return Err(Error::clash("files", "a list of one file or more"));
        }
        _ => {}
    }
    let names: Vec<&str> = run
        .recordings()
        .filter_map(|(file, _)| file.to_str())
        .collect();
    for (i, channel) in run.channels.iter().enumerate() {
        let key = format!("channels.{i}.file");
        match channel.file.as_deref().and_then(Path::to_str) {
            Some(name) if !names.contains(&name) => {
                return Err(Error::unknown_name(key, name, &names).against("files"));
            }
            None if names.len() > 1 => {
                let expected = Some(format!("the file that has it, one of {}", names.join(", ")));
                return Err(Error::new(key, Problem::Missing { expected }));
            }
            _ => {}
        }
    }
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            return Err(Error::clash(format!("files.{i}"), "each file once"));
        }
        if names.len() > 1 && run.channels_of(Path::new(name)).next().is_none() {
            let expected = "a file in which a channel stands";
            return Err(Error::clash(format!("files.{i}"), expected).against("channels"));
        }
    }
    Ok(())
}

/// Refuses misspelt keys of a run and of its sections.
fn known_keys_of_run(section: &Value) -> Result<(), Error> {
    known_keys(section, &KEYS)?;
    for (i, channel) in section["channels"]
        .as_array()
        .into_iter()
        .flatten()
        .enumerate()
    {
        known_keys(channel, &CHANNEL).map_err(|error| error.under(format!("channels.{i}")))?;
    }
    let of_throws = |key: &str, own: &[&str]| -> Vec<(String, Value)> {
        let stated = &section[key];
        match stated.as_object().filter(|_| is_by_throw(stated, own)) {
            None => vec![(key.to_owned(), stated.clone())],
            Some(throws) => {
                let throws = throws.iter();
                let throws =
                    throws.map(|(throw, stated)| (format!("{key}.{throw}"), stated.clone()));
                throws.collect()
            }
        }
    };
    for (place, load) in of_throws("load", &LOAD) {
        known_keys(&load, &LOAD).map_err(|error| error.under(place))?;
    }
    for (place, joints) in of_throws("joints", &JOINTS) {
        known_keys(&joints, &JOINTS).map_err(|error| error.under(&place))?;
        for (joint, clear) in joints.as_object().into_iter().flatten() {
            let place = format!("{place}.{joint}");
            known_keys(clear, &CLEAR).map_err(|error| error.under(place))?;
        }
    }
    Ok(())
}

fn read_run(section: &Value) -> Result<Run, Error> {
    let mut tree = section.clone();
    known_keys_of_run(section)?;
    if let Value::Object(section) = &mut tree {
        for (key, own) in [("load", &LOAD[..]), ("joints", &JOINTS[..])] {
            if let Some(value) = section
                .get_mut(key)
                .filter(|value| !is_by_throw(value, own))
            {
                // A key without letters leaves no trace in messages.
                *value = Value::Object(Map::from_iter([(String::new(), value.take())]));
            }
        }
    }
    let mut run: Run = crate::reader::read(&tree)?;
    run.section = section.clone();
    check_files(&run, section)?;
    let first = run.recordings().next().map(|(file, _)| file.to_owned());
    run.file = first.unwrap_or_default();
    if run.channels.is_empty() {
        return Err(Error::clash("channels", "a list of one channel or more"));
    }
    let mut columns = BTreeSet::new();
    for (i, channel) in run.channels.iter().enumerate() {
        // Each file has times of its own.
        let of = channel.file.as_ref().filter(|_| is_time(channel));
        if !columns.insert((of, &channel.column)) {
            let key = format!("channels.{i}.column");
            return Err(Error::clash(key, "a column of its own for every channel"));
        }
    }
    Ok(run)
}
