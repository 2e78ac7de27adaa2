//! The shown cases, simulated again as the sweep has them, without sensors.

use super::shown::Shown;
use crate::chaos::cases::CaseChaos;
use crate::{Error, classes};
use simulate::poincare::{Joint, SectionSettings, Sections, sections};
use simulate::{JointTrace, Settings, Transient, simulate};
use std::collections::BTreeMap;
use std::sync::Mutex;
use sweep::reader::Dataset;
use sweep::{Case, Plan};

/// Motions that stand in one row of every figure.
#[derive(Clone, Debug)]
pub struct MotionRow {
    /// What they have in common: the joints with clearance.
    pub heading: String,
    /// The motions, left to right; none where the sweep lacks the case.
    pub motions: Vec<Option<Motion>>,
}

/// The motion of one case, as no sensor sees it.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// What sets it apart from the others of its row: its clearance.
    pub title: String,
    /// The case.
    pub case_id: String,
    /// Crank angle, starting again at every revolution.
    pub crank_angle_rad: Vec<f64>,
    /// Velocity of the crosshead at these angles.
    pub velocity_m_s: Vec<f64>,
    /// Its acceleration.
    pub acceleration_m_s2: Vec<f64>,
    /// The joints with clearance.
    pub joints: Vec<Orbit>,
    /// Velocity and acceleration of the crosshead once a revolution, at crank angle 0.
    pub strobe: Vec<[f64; 2]>,
}

/// The motion in one joint.
#[derive(Clone, Debug, Default)]
pub struct Orbit {
    /// Name in the data, for instance `big_end`.
    pub name: String,
    /// Radial clearance.
    pub clearance_m: f64,
    /// The journal's centre from the bearing's.
    pub x_m: Vec<f64>,
    /// The same across `x_m`.
    pub y_m: Vec<f64>,
    /// Where the journal meets the bearing: crank angle in rad and speed of approach in m/s.
    pub impacts: Vec<[f64; 2]>,
}

/// Revolutions of a portrait or an orbit, as many as the page draws.
const DRAWN: u32 = 10;
/// Most revolutions of a section.
const MOST: u32 = 400;

/// The rows of the page. The cases are simulated side by side.
///
/// # Errors
/// A case that cannot be simulated again.
pub fn rows(
    dataset: &Dataset,
    known: &[CaseChaos],
    shown: &Shown,
) -> Result<Vec<MotionRow>, Error> {
    let wanted: Vec<usize> = shown
        .rows
        .iter()
        .flat_map(|(_, row)| row)
        .flatten()
        .copied()
        .collect();
    let mut made = side_by_side(&wanted, |i| {
        motion(
            &dataset.plan,
            &known[i],
            throw(&dataset.plan, &known[i].joints),
        )
    })?;
    let rows = shown.rows.iter().map(|(heading, row)| {
        let motions = row.iter().map(|case| {
            let mut motion = made.remove(&(*case)?)?;
            if heading.is_empty() {
                let joints = text::capitalised(&classes::name(&known[(*case)?].joints));
                motion.title = format!("{joints}, {}", motion.title);
            }
            Some(motion)
        });
        MotionRow {
            heading: heading.clone(),
            motions: motions.collect(),
        }
    });
    Ok(rows.collect())
}

/// The motion of each case by its number, as many at a time as there are processors.
fn side_by_side(
    cases: &[usize],
    motion: impl Fn(usize) -> Result<Motion, Error> + Sync,
) -> Result<BTreeMap<usize, Motion>, Error> {
    let threads = std::thread::available_parallelism().map_or(1, Into::into);
    let (next, made) = (Mutex::new(cases.iter()), Mutex::new(BTreeMap::new()));
    let work = || {
        loop {
            let case = next.lock().ok().and_then(|mut next| next.next().copied());
            let Some(case) = case else { break };
            let motion = motion(case);
            if let Ok(mut made) = made.lock() {
                made.insert(case, motion);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads.min(cases.len()) {
            scope.spawn(work);
        }
    });
    let made = made.into_inner().unwrap_or_default();
    made.into_iter()
        .map(|(case, motion)| Ok((case, motion?)))
        .collect()
}

/// The throw whose crosshead the figures show, from 0: the first of the joints with clearance.
fn throw(plan: &Plan, joints: &str) -> usize {
    let named = joints.split('+').filter_map(|joint| joint.split_once('.'));
    let places = named.filter_map(|(name, _)| plan.throws().iter().position(|throw| throw == name));
    places.min().unwrap_or(0)
}

fn motion(plan: &Plan, known: &CaseChaos, throw: usize) -> Result<Motion, Error> {
    let failed = |error: &dyn std::fmt::Display| Error::Motion {
        case_id: known.case_id.clone(),
        reason: error.to_string(),
    };
    let Some(index) = plan.case_index(&known.case_id) else {
        return Err(failed(&"no case of this name in sweep.yaml"));
    };
    let case = plan.case(index).map_err(|error| failed(&error))?;
    let settings = Settings {
        revolutions: case.settings.revolutions.min(DRAWN),
        ..case.settings
    };
    let record =
        simulate(&case.resolved.machine, &[], &settings, true).map_err(|error| failed(&error))?;
    let trace = record.trace.unwrap_or_default();
    let sections = once_a_revolution(&case).map_err(|error| failed(&error))?;
    let prefix = match plan.throws().get(throw).map(String::as_str) {
        None | Some("") => String::new(),
        Some(name) => format!("{name}."),
    };
    let mut motion = Motion {
        title: text::clearance(known.clearance_m),
        case_id: known.case_id.clone(),
        crank_angle_rad: trace.crank_angle,
        ..Motion::default()
    };
    let mut orbit = |name: String, joint: Joint, trace: Option<JointTrace>| {
        motion.joints.extend(trace.map(|trace| {
            Orbit {
                name,
                clearance_m: trace.clearance,
                x_m: trace.x,
                y_m: trace.y,
                impacts: sections
                    .impacts(joint)
                    .map(|impact| [impact.angle, impact.approach])
                    .collect(),
            }
        }));
    };
    orbit("main".to_owned(), Joint::Main, trace.main);
    if let Some(trace) = trace.throws.into_iter().nth(throw) {
        orbit(
            format!("{prefix}big_end"),
            Joint::BigEnd(throw),
            trace.big_end,
        );
        orbit(
            format!("{prefix}small_end"),
            Joint::SmallEnd(throw),
            trace.small_end,
        );
        motion.velocity_m_s = trace.velocity;
        motion.acceleration_m_s2 = trace.acceleration;
    }
    let points = sections
        .revolutions
        .iter()
        .filter_map(|revolution| revolution.throws.get(throw));
    motion.strobe = points
        .map(|point| [point.velocity, point.acceleration])
        .collect();
    Ok(motion)
}

/// The sections over the recorded revolutions; none of a free crank that stalls.
fn once_a_revolution(case: &Case) -> Result<Sections, simulate::Error> {
    let settings = SectionSettings {
        transient: match case.settings.transient {
            Transient::Revolutions(count) => count,
            Transient::Settled { at_most, .. } => at_most,
        },
        revolutions: case.settings.revolutions.min(MOST),
        tolerance: case.settings.tolerance,
        ..SectionSettings::default()
    };
    match sections(&case.resolved.machine, &settings) {
        Err(simulate::Error::Stalled { .. }) => Ok(Sections {
            joints: Vec::new(),
            revolutions: Vec::new(),
        }),
        other => other,
    }
}
