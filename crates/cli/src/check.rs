//! `crosshead check`: all mistakes of files that people write, at once.

use crate::Failure;
use bench::settings::HiddenEffects;
use clap::Args;
use input::bundle::{self, Bundle};
use input::calibration::Calibration;
use input::yaml::Document;
use input::{Error, MachineFile, schema};
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
    let (mut mistakes, mut files) = (0, 0);
    for path in &arguments.files {
        let path = match path.is_dir() {
            true => path.join(bundle::FILE),
            false => path.clone(),
        };
        let document = Document::open(&path);
        let document = document.map_err(|error| match error.problem() {
            input::Problem::Unreadable(_) => Failure::input(error),
            _ => Failure::work(error),
        })?;
        let kind = match Bundle::is_at(&path) {
            true => Some(2),
            false => schema::closest(&document.tree, &schemas),
        };
        let (kind, words) = KINDS[kind.unwrap_or(0)];
        match check(kind, &path, document) {
            Ok(()) => {
                println!("{}: {words}, no mistakes", path.display());
                tell_missing(kind, &path);
            }
            Err(error) => {
                let found = error.into_each();
                found
                    .iter()
                    .for_each(|mistake| eprintln!("error: {mistake}"));
                mistakes += found.len();
                files += 1;
            }
        }
    }
    match mistakes {
        0 => Ok(()),
        _ => Err(Failure::work(format!(
            "{} in {}",
            count(mistakes, "mistake"),
            count(files, "file")
        ))),
    }
}

fn check(kind: Kind, path: &Path, document: Document) -> Result<(), Error> {
    let folder = path.parent().unwrap_or(Path::new(""));
    match kind {
        Kind::Machine => MachineFile::from_document(document)?.resolve().map(|_| ()),
        Kind::Sweep => Sweep::new(document, folder)?.nominal().map(|_| ()),
        Kind::Bundle => input::check_bundle(folder, &document),
        Kind::Calibration => Calibration::of(&document).map(|_| ()),
        Kind::HiddenEffects => HiddenEffects::of(&document).map(|_| ()),
    }
}

/// Says which recordings of a bundle are not there yet.
fn tell_missing(kind: Kind, path: &Path) {
    let (Kind::Bundle, Ok(bundle)) = (kind, Bundle::read(path)) else {
        return;
    };
    let files = bundle.runs.iter().map(|run| bundle.folder.join(&run.file));
    for file in files.filter(|file| !file.is_file()) {
        println!("  {} is not there yet", file.display());
    }
}

fn count(number: usize, things: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {things}{plural}")
}
