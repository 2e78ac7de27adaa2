//! `crosshead estimate-wear`: which joints are worn, and how much, from recordings.

use crate::bundle::AllowOutside;
use crate::calibrate::{Bar, check_complete, existing};
use crate::result_format::ResultFormat;
use crate::{Failure, interrupt};
use ::calibrate::Settings;
use ::calibrate::run_condition::CRANK_ANGLE_OFFSET;
use ::calibrate::wear::{Asked, prepare};
use ::report::folder_kind::{FolderKind, REPORT};
use clap::Args;
use input::calibration::{Calibration, Parameters};
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
#[command(after_help = "\
MACHINE.yaml is the healthy machine, as calibrate writes it or from the data sheet. BUNDLE is a
folder of recordings of the same machine in one state: accelerations of the crosshead or the frame,
with or without pressures. Clearances that the bundle states are not used. Each joint is healthy,
worn, unclear or not identifiable, with its clearance and a 95 % interval where one holds.

Examples:
  crosshead calibrate healthy-recordings --out calibrated
  crosshead estimate-wear new-recordings --machine calibrated/machine.yaml --out wear

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong; 130 interrupted.")]
pub struct Arguments {
    /// Folder of recordings
    bundle: PathBuf,
    /// The healthy machine
    #[arg(long, value_name = "MACHINE.yaml")]
    machine: PathBuf,
    /// Folder to write into: wear.json, machine.yaml, report.html
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// A joint counts as worn from this many times its normal clearance
    #[arg(long, value_name = "TIMES", default_value_t = 1.5, value_parser = times)]
    worn_from: f64,
    /// Do not use this run; may be repeated
    #[arg(long, value_name = "RUN")]
    leave_out: Vec<String>,
    #[command(flatten)]
    outside: AllowOutside,
    /// Continue an estimation that was stopped
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Replace an earlier estimation
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    format: ResultFormat,
}

/// A number above 1.
fn times(text: &str) -> Result<f64, String> {
    let number = text
        .parse::<f64>()
        .ok()
        .filter(|times| *times > 1.0 && times.is_finite());
    number.ok_or_else(|| "a number above 1 is expected, 1.5 for example".to_owned())
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    let machine = input::machine_file::read(&arguments.machine)?;
    let mut calibration = Calibration::with_defaults(vec![arguments.bundle.clone()]);
    calibration.parameters = Parameters(vec![(CRANK_ANGLE_OFFSET.to_owned(), None)]);
    calibration.hold_out = Some(Vec::new());
    calibration.leave_out.clone_from(&arguments.leave_out);
    let asked = Asked {
        settings: Settings {
            calibration: &calibration,
            base: Path::new(""),
            machine: Some(machine.to_tree()),
            allow_outside: arguments.outside.allow_outside,
            clearances_unknown: true,
            locate: &|error| error,
        },
        worn_from: arguments.worn_from,
    };
    let cancel = interrupt::flag()?;
    let existing = existing(arguments.resume, arguments.overwrite);
    let prepared = prepare(&asked, out, existing).map_err(Failure::input)?;
    let done = prepared.finish(&mut Bar::new(&cancel));
    let done = done.map_err(Failure::work)?;
    let page = out.join(REPORT);
    if !done.reused {
        FolderKind::Wear.write(out, &page)?;
    }
    let files = [done.machine.as_path(), &page];
    (arguments.format).print_found(&done.results, done.reused, files)?;
    check_complete(done.results.complete, out)
}
