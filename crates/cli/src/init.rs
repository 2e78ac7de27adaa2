//! `crosshead init`: a file to fill in.

use crate::Failure;
use crate::choice::kind_of;
use crate::output::{refuse_existing, refuse_folder, warn};
use ::calibrate::check::{BUNDLE, CALIBRATION};
use ::sweep::calibration::{SWEEP_FILE, machine_of};
use ::sweep::sweep_file;
use clap::Args;
use input::bundle::Bundle;
use input::file_kind::{FileKind, MACHINE_FILE};
use input::template::{self, Asked, Recorded};
use input::{MachineFile, machine_file};
use recordings::measured::{Heading, headings};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What the file in this folder begins with.
type Template = fn(&Arguments, &Path) -> Result<String, Failure>;

const TEMPLATES: [(FileKind, Template); 4] = [
    (MACHINE_FILE, machine),
    (SWEEP_FILE, sweep),
    (BUNDLE, |_, folder| {
        let (mut recorded, mut unread) = (Vec::new(), Vec::new());
        for heading in headings(folder) {
            match heading {
                Ok(heading) => recorded.push(run_of(heading)),
                Err(error) => unread.push(format!("left out: {error}")),
            }
        }
        warn(&unread);
        Ok(template::bundle(&recorded)?)
    }),
    (CALIBRATION, |arguments, _| {
        Ok(template::calibration(&arguments.bundle)?)
    }),
];

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
    #[arg(value_parser = kind_of(TEMPLATES))]
    file: (FileKind, Template),
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

fn run_of(heading: Heading) -> Recorded {
    let columns = heading.channels.into_iter();
    Recorded {
        file: heading.file,
        columns: columns
            .map(|channel| (channel.column, channel.unit))
            .collect(),
        sample_rate_hz: heading.sample_rate_hz,
        speed_rpm: heading.speed_rpm,
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    refuse_others(arguments)?;
    let (kind, template) = arguments.file;
    let out = arguments.out.clone().unwrap_or_else(|| kind.file.into());
    refuse_folder(&out)?;
    let text = template(arguments, out.parent().unwrap_or(Path::new("")))?;
    refuse_existing([&out], arguments.overwrite, "--out FILE")?;
    let file = match arguments.overwrite {
        true => File::create(&out),
        false => File::create_new(&out),
    };
    let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| Failure::unwritten(&out, error))?;
    println!("{}", out.display());
    Ok(())
}

fn machine(arguments: &Arguments, _: &Path) -> Result<String, Failure> {
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
    let path = named.unwrap_or_else(|| folder.join(MACHINE_FILE.file));
    match path.exists() {
        true => Ok(sweep_file::template(folder, &path)?),
        false => Err(Failure::input(format!(
            "{}: there is no such file: `crosshead init machine` writes one, --machine names another",
            path.display()
        ))),
    }
}

/// Options that the file does not have.
fn refuse_others(arguments: &Arguments) -> Result<(), Failure> {
    let is = |kind: FileKind| arguments.file.0.name == kind.name;
    let of_machine = arguments.throws.is_some()
        || arguments.double_acting
        || arguments.like.is_some()
        || arguments.from_bundle.is_some();
    if of_machine && !is(MACHINE_FILE) {
        return Err(Failure::input(
            "--throws, --double-acting, --like and --from-bundle are options of init machine",
        ));
    }
    match arguments.machine.is_some() && !is(SWEEP_FILE) {
        true => Err(Failure::input("--machine is an option of init sweep")),
        false => Ok(()),
    }
}
