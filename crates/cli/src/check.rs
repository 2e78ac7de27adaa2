//! `crosshead check`: all mistakes of files that people write, at once.

use crate::Failure;
use crate::result_format::ResultFormat;
use ::features::recorded::counted;
use bench::settings::HiddenEffects;
use clap::Args;
use input::bundle::{self, Bundle};
use input::calibration::Calibration;
use input::yaml::Document;
use input::{Error, MachineFile, schema};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use sweep::Sweep;

/// Arguments of `crosshead check`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead check machine.yaml sweep.yaml
  crosshead check recordings/

Every mistake is a line on standard error: file, line, key, what was found, what was expected. The
keys of a file show its kind. Nothing is written and nothing is simulated.

Exit status: 0 no mistakes; 1 there are some; 2 a file cannot be read.")]
pub struct Arguments {
    /// machine.yaml, sweep.yaml, calibration.yaml, hidden-effects.yaml, recordings.yaml, or the folder of a bundle
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    format: ResultFormat,
}

/// What was found in a file.
#[derive(Serialize)]
struct Checked {
    file: PathBuf,
    /// What kind of file it is.
    kind: &'static str,
    mistakes: Vec<Mistake>,
    /// Recordings that it names and that are not there.
    not_there_yet: Vec<PathBuf>,
}

/// A mistake.
#[derive(Serialize)]
struct Mistake {
    /// Another file where that is wrong which the file names.
    file: String,
    line: Option<u64>,
    column: Option<u64>,
    key: String,
    /// What was found and what was expected.
    problem: String,
}

impl Checked {
    fn print(&self) {
        if self.mistakes.is_empty() {
            println!("{}: {}, no mistakes", self.file.display(), self.kind);
        }
        for file in &self.not_there_yet {
            println!("  {} is not there yet", file.display());
        }
    }
}

/// The kinds of files, in the order of their schemas.
#[derive(Clone, Copy)]
enum Kind {
    Machine,
    Sweep,
    Bundle,
    Calibration,
    HiddenEffects,
}

const KINDS: [(Kind, &str); 5] = [
    (Kind::Machine, "a machine"),
    (Kind::Sweep, "a sweep"),
    (Kind::Bundle, "a bundle of recordings"),
    (Kind::Calibration, "settings of a calibration"),
    (Kind::HiddenEffects, "a test bench of hidden effects"),
];

/// Checks each file.
///
/// # Errors
/// Files with mistakes, or that cannot be read.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let schemas = [
        schema::machine_schema(),
        sweep::sweep_file::schema(),
        schema::bundle_schema(),
        input::calibration::schema(),
        bench::settings::schema(),
    ];
    let mut all = Vec::new();
    for path in &arguments.files {
        all.push(check_file(path, &schemas)?);
    }
    arguments
        .format
        .print(&all, |all| all.iter().for_each(Checked::print))?;
    let mistakes = || all.iter().flat_map(|checked| &checked.mistakes);
    let files: BTreeSet<&String> = mistakes().map(|mistake| &mistake.file).collect();
    match mistakes().count() {
        0 => Ok(()),
        count => Err(Failure::work(format!(
            "{} in {}",
            counted(count as u64, "mistake"),
            counted(files.len() as u64, "file")
        ))),
    }
}

/// Checks the file at `path`; its mistakes are lines on standard error.
fn check_file(path: &Path, schemas: &[Value]) -> Result<Checked, Failure> {
    let path = match path.is_dir() {
        true => path.join(bundle::FILE),
        false => path.to_owned(),
    };
    let (kind, error) = match Document::open(&path) {
        Ok(document) => {
            let kind = match Bundle::is_at(&path) {
                true => Some(2),
                false => schema::closest(&document.tree, schemas),
            };
            let (kind, words) = KINDS[kind.unwrap_or(0)];
            (Some((kind, words)), check(kind, &path, document).err())
        }
        Err(error) => match error.problem() {
            input::Problem::Unreadable(_) => return Err(Failure::input(error)),
            _ => (None, Some(error)),
        },
    };
    let found = error.map_or(Vec::new(), Error::into_each);
    found
        .iter()
        .for_each(|mistake| eprintln!("error: {mistake}"));
    let own = path.display().to_string();
    let mistakes: Vec<Mistake> = found
        .iter()
        .map(|mistake| Mistake::of(mistake, &own))
        .collect();
    let not_there_yet = match kind {
        Some((kind, _)) if mistakes.is_empty() => missing(kind, &path),
        _ => Vec::new(),
    };
    Ok(Checked {
        file: path,
        kind: kind.map_or("not YAML", |(_, words)| words),
        mistakes,
        not_there_yet,
    })
}

impl Mistake {
    /// The mistake `error` of the file `own`, or of one that it names.
    fn of(error: &Error, own: &str) -> Self {
        Self {
            file: error.file().unwrap_or(own).to_owned(),
            line: error.place().map(|place| place.line),
            column: error.place().map(|place| place.column),
            key: error.key().to_owned(),
            problem: error.problem().to_string(),
        }
    }
}

fn check(kind: Kind, path: &Path, document: Document) -> Result<(), Error> {
    let folder = path.parent().unwrap_or(Path::new(""));
    match kind {
        Kind::Machine => MachineFile::from_document(document)?.resolve().map(|_| ()),
        Kind::Sweep => Sweep::new(document, folder)?.nominal().map(|_| ()),
        Kind::Bundle => check_bundle(folder, &document),
        Kind::Calibration => check_calibration(folder, &document),
        Kind::HiddenEffects => HiddenEffects::of(&document).map(|_| ()),
    }
}

/// Checks a `recordings.yaml`, and whether the recordings that are there have the columns that it names.
fn check_bundle(folder: &Path, document: &Document) -> Result<(), Error> {
    input::check_bundle(folder, document)?;
    let bundle = Bundle::new(folder, document.clone())?;
    Error::all(::calibrate::bundle::wrong_columns(&bundle)).map_or(Ok(()), Err)
}

/// Checks settings of a calibration, and the machine and the recordings that they name.
fn check_calibration(folder: &Path, document: &Document) -> Result<(), Error> {
    let settings = Calibration::checked(document, ::calibrate::check_settings)?;
    let machine = settings.machine.as_ref().map(|path| {
        let read = input::machine_file::read(&folder.join(path));
        read.and_then(|machine| machine.resolve()).err()
    });
    let bundles = settings.bundles().iter().map(|path| folder.join(path));
    let bundles = bundles
        .filter(|bundle| Bundle::is_at(bundle))
        .map(|bundle| {
            let document = Document::open(&bundle.join(bundle::FILE));
            document
                .and_then(|document| check_bundle(&bundle, &document))
                .err()
        });
    let wrong = machine.into_iter().chain(bundles).flatten();
    Error::all(wrong).map_or(Ok(()), Err)
}

/// The recordings of a bundle, or the bundles of a calibration, that are not there.
fn missing(kind: Kind, path: &Path) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files: Vec<PathBuf> = match kind {
        Kind::Bundle => Bundle::read(path).map_or(Vec::new(), |bundle| {
            let runs = bundle.runs.iter();
            let files = runs.flat_map(|run| run.recordings());
            files.map(|(file, _)| bundle.folder.join(file)).collect()
        }),
        Kind::Calibration => Calibration::read(path).map_or(Vec::new(), |(settings, _)| {
            let bundles = settings.bundles().iter();
            bundles.map(|bundle| folder.join(bundle)).collect()
        }),
        _ => Vec::new(),
    };
    files.retain(|file| !file.exists());
    files
}
