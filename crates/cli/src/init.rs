//! `crosshead init`: a file to fill in.

use crate::Failure;
use clap::{Args, ValueEnum};
use input::bundle::Bundle;
use input::template::{self, Asked};
use input::{MachineFile, machine_file};
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use sweep::calibration::machine_of;

/// Arguments of `crosshead init`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead init machine
  crosshead init machine --throws 2 --double-acting --out compressor.yaml
  crosshead init machine --like data/machines/two-stage.yaml --out compressor.yaml
  crosshead init machine --from-bundle data/recordings/example-single-stage
  crosshead init sweep --machine compressor.yaml
  crosshead init bundle --out recordings/recordings.yaml

The file has a comment at every key and is right as it stands: `crosshead check FILE` finds no
mistakes in it.

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// Which file
    file: File,
    /// The file to write [default: machine.yaml, sweep.yaml, recordings.yaml or calibration.yaml]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Number of throws of the machine [default: 1, or that of --like]
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=16))]
    throws: Option<u8>,
    /// Give the cylinders of the machine a second chamber, at the crank end
    #[arg(long)]
    double_acting: bool,
    /// A machine file whose values stand in the new one [default: a single-stage compressor]
    #[arg(long, value_name = "MACHINE.yaml")]
    like: Option<PathBuf>,
    /// A bundle whose machine section, at the conditions of its first run, gives the values
    #[arg(long, value_name = "BUNDLE", conflicts_with = "like")]
    from_bundle: Option<PathBuf>,
    /// The machine of a sweep [default: machine.yaml in the folder of the new file]
    #[arg(long, value_name = "MACHINE.yaml")]
    machine: Option<PathBuf>,
    /// The folder of recordings of a calibration
    #[arg(long, value_name = "BUNDLE", default_value = "recordings")]
    bundle: String,
    /// Replace a file that is there
    #[arg(long)]
    overwrite: bool,
}

/// A file that people write.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum File {
    /// machine.yaml: a compressor
    Machine,
    /// sweep.yaml: the cases of a dataset
    Sweep,
    /// recordings.yaml: a bundle of measured runs
    Bundle,
    /// calibration.yaml: what is fitted to a bundle
    Calibration,
}

impl File {
    fn name(self) -> &'static str {
        match self {
            Self::Machine => "machine.yaml",
            Self::Sweep => "sweep.yaml",
            Self::Bundle => input::bundle::FILE,
            Self::Calibration => "calibration.yaml",
        }
    }
}

/// Writes the file.
///
/// # Errors
/// A file that is there already, or that cannot be read or written; an option of another file.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    refuse_others(arguments)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| arguments.file.name().into());
    let folder = out.parent().unwrap_or(Path::new(""));
    let text = match arguments.file {
        File::Machine => machine(arguments)?,
        File::Sweep => sweep(arguments, folder)?,
        File::Bundle => template::bundle(&recordings(folder))?,
        File::Calibration => template::calibration(&arguments.bundle)?,
    };
    write(&out, &text, arguments.overwrite)?;
    println!("{}", out.display());
    Ok(())
}

fn machine(arguments: &Arguments) -> Result<String, Failure> {
    let like = match (&arguments.from_bundle, &arguments.like) {
        (Some(folder), _) => {
            let tree = machine_of(&Bundle::read(folder)?)?;
            Some(MachineFile::from_tree(&tree)?)
        }
        (None, like) => like.as_deref().map(machine_file::read).transpose()?,
    };
    Ok(template::machine(&Asked {
        like: like.as_ref(),
        throws: arguments.throws.map(usize::from),
        double_acting: arguments.double_acting,
    })?)
}

fn sweep(arguments: &Arguments, folder: &Path) -> Result<String, Failure> {
    let named = arguments.machine.clone();
    let path = named.unwrap_or_else(|| folder.join(File::Machine.name()));
    if !path.exists() {
        return Err(Failure::input(format!(
            "{}: there is no such file: `crosshead init machine` writes one, --machine names another",
            path.display()
        )));
    }
    let machine = machine_file::read(&path)?;
    let resolved = machine.resolve()?;
    Ok(sweep::sweep_file::template(
        &from(folder, &path),
        &resolved,
        machine.to_tree(),
    )?)
}

/// `path` as a file in `folder` has it.
fn from(folder: &Path, path: &Path) -> String {
    let inside = path.strip_prefix(folder).map(Path::to_owned);
    let absolute = || path.canonicalize().unwrap_or_else(|_| path.to_owned());
    inside.unwrap_or_else(|_| absolute()).display().to_string()
}

/// The recordings in `folder`, in the order of their names.
fn recordings(folder: &Path) -> Vec<String> {
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let is_recording = |name: &String| {
        let ending = Path::new(name)
            .extension()
            .and_then(|ending| ending.to_str());
        ending.is_some_and(|ending| ["csv", "parquet"].contains(&ending))
    };
    let mut names: Vec<String> = names.filter(is_recording).collect();
    names.sort();
    names
}

/// Options that the file does not have.
fn refuse_others(arguments: &Arguments) -> Result<(), Failure> {
    let of_machine = arguments.throws.is_some()
        || arguments.double_acting
        || arguments.like.is_some()
        || arguments.from_bundle.is_some();
    let wrong = match arguments.file {
        File::Machine => arguments
            .machine
            .as_ref()
            .map(|_| "--machine is an option of init sweep"),
        _ if of_machine => {
            Some("--throws, --double-acting, --like and --from-bundle are options of init machine")
        }
        File::Sweep => None,
        File::Bundle | File::Calibration => arguments
            .machine
            .as_ref()
            .map(|_| "--machine is an option of init sweep"),
    };
    wrong.map_or(Ok(()), |words| Err(Failure::input(words)))
}

fn write(path: &Path, text: &str, overwrite: bool) -> Result<(), Failure> {
    let mut options = OpenOptions::new();
    options.write(true);
    match overwrite {
        true => options.create(true).truncate(true),
        false => options.create_new(true),
    };
    let written = options
        .open(path)
        .and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::input(format!(
            "{} is already there; --overwrite replaces it, --out FILE writes elsewhere",
            path.display()
        )),
        _ => Failure::unwritten(path, error),
    })
}
