//! Where the crank stands: by the angle or the pulses that a recording has of it.

use super::Error;
use super::units::{Role, Scaled, scaled};
use input::bundle_channel::{Meaning, ToSi};
use recordings::measured::{MeasuredChannel, MeasuredFile, stem};
use signal::crank_angle::{CrankAngle, runs_backwards};
use signal::tacho;
use std::f64::consts::TAU;
use std::path::Path;

/// A stated speed may differ by so much from that of the crank angle: the slip of an induction motor
/// at full load is at most 5 %.
const SLIP: f64 = 0.05;

/// What the arguments say about the crank.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// Column of the crank angle.
    pub crank_angle: Option<String>,
    /// Column of pulses, one per revolution.
    pub tacho: Option<String>,
    /// The reading at top dead centre, rad; with a tacho, the angle from its pulse to there.
    pub top_dead_centre: Option<f64>,
}

impl Asked {
    fn column(&self) -> Option<&str> {
        self.crank_angle.as_deref().or(self.tacho.as_deref())
    }

    /// The column that is asked for, without a unit in brackets that is said beside it.
    pub(super) fn bare_column(&self) -> Option<String> {
        let name = self.column()?;
        Some(unit_beside(name).map_or(name, |(name, _)| name).to_owned())
    }
}

/// The channel that gives the crank angle, and how: the one asked for, else that of the bundle,
/// else the column `crank_angle_rad` or `crank_angle_deg`.
pub(super) fn reference(
    path: &Path,
    file: &MeasuredFile,
    asked: &Asked,
    meaning: impl Fn(&MeasuredChannel) -> Option<Meaning>,
) -> Result<Option<(usize, Scaled)>, Error> {
    let channels = file.channels();
    if let Some(name) = asked.column() {
        let (index, unit) = named(path, channels, name)?;
        let role = match asked.tacho {
            Some(_) => Role::Tacho {
                top_dead_centre: asked.top_dead_centre,
            },
            None => Role::CrankAngle {
                top_dead_centre: asked.top_dead_centre.or(by_name(&channels[index])),
            },
        };
        let to_si = match role {
            Role::Tacho { .. } => AS_IT_IS,
            _ => angle_unit(path, &channels[index], unit.as_deref())?,
        };
        return Ok(Some((index, Scaled::reference(role, to_si))));
    }
    let mut pulses = None;
    for (i, channel) in channels.iter().enumerate() {
        match meaning(channel) {
            Some(Meaning::CrankAngle(to_si)) => {
                let role = Role::CrankAngle {
                    top_dead_centre: asked.top_dead_centre.or(Some(0.0)),
                };
                return Ok(Some((i, Scaled::reference(role, to_si))));
            }
            Some(Meaning::Tacho { at }) => {
                let role = Role::Tacho {
                    top_dead_centre: asked.top_dead_centre.or(at.map(|at| -at)),
                };
                pulses = Some((i, Scaled::reference(role, AS_IT_IS)));
            }
            _ => {}
        }
    }
    let named = channels.iter().position(|c| by_name(c).is_some());
    match (pulses, named) {
        (Some(pulses), _) => Ok(Some(pulses)),
        (None, None) => Ok(None),
        (None, Some(i)) => {
            let angle = scaled(&channels[i], None);
            let mut angle = angle.map_err(|reason| Error::in_file(path, reason))?;
            angle.role = Role::CrankAngle {
                top_dead_centre: asked.top_dead_centre.or(Some(0.0)),
            };
            Ok(Some((i, angle)))
        }
    }
}

pub(super) const AS_IT_IS: ToSi = ToSi {
    offset: 0.0,
    scale: 1.0,
};

/// Whether a column is called `crank_angle_rad` or `crank_angle_deg`.
pub(super) fn is_crank_angle(channel: &MeasuredChannel) -> bool {
    stem(&channel.name).eq_ignore_ascii_case("crank_angle")
}

/// A column of that name counts from top dead centre.
fn by_name(channel: &MeasuredChannel) -> Option<f64> {
    is_crank_angle(channel).then_some(0.0)
}

/// `angle` and `deg` of `angle [deg]`.
fn unit_beside(name: &str) -> Option<(&str, &str)> {
    let (name, unit) = name.strip_suffix(']')?.rsplit_once('[')?;
    Some((name.trim(), unit.trim()))
}

/// The channel of this name, which may carry a unit in brackets that the file does not have.
fn named(
    path: &Path,
    channels: &[MeasuredChannel],
    name: &str,
) -> Result<(usize, Option<String>), Error> {
    let find = |name: &str| channels.iter().position(|c| c.is_called(name));
    if let Some(index) = find(name) {
        return Ok((index, channels[index].unit.clone()));
    }
    if let Some((bare, unit)) = unit_beside(name)
        && let Some(index) = find(bare)
    {
        return Ok((index, Some(unit.to_owned())));
    }
    let error = recordings::Error::NoColumn {
        name: name.to_owned(),
        among: channels.iter().map(|c| c.column.clone()).collect(),
    };
    Err(Error::of_file(path, error))
}

fn angle_unit(path: &Path, channel: &MeasuredChannel, unit: Option<&str>) -> Result<ToSi, Error> {
    let scale = match unit {
        Some("rad") => 1.0,
        Some("deg" | "°" | "degree" | "degrees") => TAU / 360.0,
        Some("rev") => TAU,
        _ => {
            let found = unit.map_or("none".to_owned(), |unit| format!("'{unit}'"));
            let column = &channel.column;
            let reason = format!(
                "column `{column}`: the unit of a crank angle is rad, deg or rev, but found {found}; \
                 write it in brackets: --crank-angle '{column} [deg]'"
            );
            return Err(Error::in_file(path, reason));
        }
    };
    Ok(ToSi { offset: 0.0, scale })
}

/// Where the crank stands at each sample of a window.
pub(super) struct Crank {
    /// In [0, 2π), rad.
    pub(super) angles: Vec<f32>,
    pub(super) from_top_dead_centre: bool,
}

/// The crank of a window by its channel `by`; none where that is no reference.
pub(super) fn crank(samples: &[f64], by: &Scaled) -> Option<Result<Crank, signal::Error>> {
    let from = |angles: Vec<f64>, top: Option<f64>| Crank {
        angles: angles
            .into_iter()
            .map(|angle| (angle - top.unwrap_or(0.0)).rem_euclid(TAU) as f32)
            .collect(),
        from_top_dead_centre: top.is_some(),
    };
    match by.role {
        Role::CrankAngle { top_dead_centre } => {
            let angles = samples.iter().map(|x| by.to_si.apply(*x));
            Some(Ok(from(angles.collect(), top_dead_centre)))
        }
        Role::Tacho { top_dead_centre } => {
            Some(tacho::from_pulses(samples).map(|angles| from(angles, top_dead_centre)))
        }
        Role::Measured | Role::Unused => None,
    }
}

/// The mean speed by the crank angle, rpm.
pub(super) fn speed_rpm(crank: &Crank, sample_rate_hz: f64) -> Result<f64, signal::Error> {
    let readings: Vec<f64> = crank.angles.iter().map(|a| f64::from(*a)).collect();
    let angle = CrankAngle::from_encoder(&readings)?;
    Ok(60.0 * sample_rate_hz / angle.samples_per_revolution())
}

/// What looks wrong with the crank of a window.
pub(super) fn warning(
    crank: Option<&Result<Crank, signal::Error>>,
    speed: Option<&Result<f64, signal::Error>>,
    stated_rpm: Option<f64>,
    sample_rate_hz: f64,
) -> Option<String> {
    if let Some(Err(error)) = crank {
        let instead = stated_rpm.map_or(String::new(), |speed| {
            format!(": the stated speed of {speed:.4} rpm is taken")
        });
        return Some(format!("{error}{instead}"));
    }
    match (speed?, stated_rpm) {
        (Err(signal::Error::AngleNotIncreasing { index, step_rad }), _) => {
            let at = *index as f64 / sample_rate_hz;
            let place = format!("sample {index} ({at:.6} s after the window begins)");
            let readings = crank.and_then(|crank| crank.as_ref().ok())?;
            let readings: Vec<f64> = readings.angles.iter().map(|a| f64::from(*a)).collect();
            Some(match runs_backwards(&readings) {
                true => format!(
                    "the crank angle runs backwards, first at {place}: is the encoder reversed?"
                ),
                false => format!(
                    "the crank angle does not increase at {place}: it changes by {step_rad:.3e} rad"
                ),
            })
        }
        (Err(error), _) => Some(format!("crank angle: {error}")),
        (Ok(speed), Some(stated)) if (speed / stated - 1.0).abs() > SLIP => Some(format!(
            "the crank turns at {speed:.2} rpm, but {stated:.2} rpm are stated"
        )),
        _ => None,
    }
}
