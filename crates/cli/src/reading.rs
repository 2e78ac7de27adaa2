//! How recordings are read: what their files do not say of themselves.

use crate::Failure;
use crate::bundle::AllowOutside;
use ::features::recorded::{CrankReference, KnownMachine, Said, Unit, WindowLength};
use clap::Args;
use input::quantity::{AboveZero, Angle, Frequency, Quantity, Speed};
use recordings::measured::Options;
use std::path::PathBuf;

/// What the arguments say of recordings.
#[derive(Args, Debug)]
pub(crate) struct Reading {
    /// Take this column only; may be repeated [default: every column of numbers]
    #[arg(long, value_name = "NAME")]
    column: Vec<String>,
    /// Sample rate, if neither a column of time nor a heading has it; a plain number is in Hz
    #[arg(long, value_name = "HZ", allow_hyphen_values = true)]
    sample_rate: Option<String>,
    /// Lines of a text file that stand before its table; usually found without it
    #[arg(
        long,
        value_name = "LINES",
        default_value_t = 0,
        hide_default_value = true
    )]
    skip: u64,
    /// Unit of the columns that have none, or what 1 in the file is (in a WAV file: full scale)
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Speed of the crank, if neither a crank angle nor the file has it
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    speed: Option<String>,
    /// Crank angle, where its column is not called crank_angle_rad or crank_angle_deg; the unit in
    /// brackets where the file has none: 'encoder [deg]'
    #[arg(long, value_name = "COLUMN", conflicts_with = "tacho")]
    crank_angle: Option<String>,
    /// Pulses, one per revolution
    #[arg(long, value_name = "COLUMN")]
    tacho: Option<String>,
    /// Reading of the crank angle at top dead centre; with a tacho, how far the crank turns from the
    /// pulse to there
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    top_dead_centre: Option<String>,
    /// The machine, for the indicated power of its cylinder pressures [default: the machine section of a
    /// bundle]
    #[arg(long, value_name = "MACHINE.yaml")]
    machine: Option<PathBuf>,
    /// Length of a window: '2 s' or '10 revolutions' [default: the whole file up to 10 s (or
    /// 100000 samples), windows of that length of a longer one; rows of a table are one window each]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    window: Option<String>,
    /// Whether regime, exponents and entropies are computed, which takes most of the time
    #[arg(long, value_name = "BOOL", default_value_t = true, action = clap::ArgAction::Set)]
    chaos: bool,
    #[command(flatten)]
    outside: AllowOutside,
}

impl Reading {
    /// What they say of all files.
    ///
    /// # Errors
    /// An argument that is wrong, or a machine file that is.
    pub(crate) fn said(&self) -> Result<Said, Failure> {
        let speed = |text: &str| {
            let speed = Quantity::<Speed, AboveZero>::named("--speed", text);
            speed.map(|speed| speed * 30.0 / std::f64::consts::PI)
        };
        let angle = |text: &str| Quantity::<Angle>::named("--top-dead-centre", text);
        Ok(Said {
            unit: parsed(&self.unit, unit)?,
            options: Options {
                columns: self.column.clone(),
                sample_rate_hz: parsed(&self.sample_rate, sample_rate)?,
                skipped_lines: self.skip,
            },
            speed_rpm: parsed(&self.speed, speed)?,
            crank: CrankReference {
                crank_angle: self.crank_angle.clone(),
                tacho: self.tacho.clone(),
                top_dead_centre: parsed(&self.top_dead_centre, angle)?,
            },
            machine: (self.machine.as_deref().map(KnownMachine::read)).transpose()?,
            allow_outside: self.outside.allow_outside,
            motion: self.chaos,
        })
    }

    /// How long the windows are.
    ///
    /// # Errors
    /// Something else than a length.
    pub(crate) fn window(&self) -> Result<WindowLength, Failure> {
        Ok(parsed(&self.window, window)?.unwrap_or(WindowLength::Default))
    }
}

/// An argument that may be left out.
fn parsed<T>(
    text: &Option<String>,
    parse: impl FnOnce(&str) -> Result<T, String>,
) -> Result<Option<T>, Failure> {
    let value = text.as_deref().map(parse).transpose();
    value.map_err(Failure::input)
}

fn window(text: &str) -> Result<WindowLength, String> {
    WindowLength::parse(text).map_err(|found| {
        format!("--window: found {found}, expected a duration, e.g. '2 s', or '10 revolutions'")
    })
}

fn unit(text: &str) -> Result<Unit, String> {
    Unit::parse(text).ok_or_else(|| {
        let text = text.trim();
        format!(
            "--unit: found '{text}', expected a unit, e.g. 'm/s^2', or what 1 in the file is, e.g. \
             '100 m/s^2'"
        )
    })
}

/// A plain number is in Hz.
fn sample_rate(text: &str) -> Result<f64, String> {
    type Rate = Quantity<Frequency, AboveZero>;
    let refused = || {
        format!(
            "--sample-rate: found '{text}', expected {}",
            Rate::expected()
        )
    };
    match text.trim().parse() {
        Ok(rate) => Rate::new(rate).map(|rate| rate.si()).ok_or_else(refused),
        Err(_) => Rate::named("--sample-rate", text),
    }
}
