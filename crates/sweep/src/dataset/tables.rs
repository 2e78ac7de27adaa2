//! The tables of a dataset: their columns, and the rows of a case.

use std::collections::BTreeMap;

use features::Cell;
use recordings::{Column, Kind, Role, Schema, Value};
use signal::channel::Channel;
use simulate::Chamber;

use super::judged::{judged_columns, judged_values};
use super::recording::CRANK_ANGLE;
use crate::Plan;
use crate::fault_words::{fault_location, fault_type};
use crate::plan::Case;

/// The columns of both tables.
#[derive(Clone, Debug)]
pub struct Tables {
    /// One row per window: the recorded channels.
    pub signals: Schema,
    /// One row per window: its features.
    pub features: Schema,
}

impl Tables {
    /// The columns of the dataset of `plan`.
    ///
    /// # Errors
    /// Where two columns have one name.
    pub fn new(plan: &Plan) -> Result<Self, recordings::Error> {
        let channels = plan.channels();
        let about = about(plan);
        let mut signals = about.clone();
        signals.extend(channels.iter().map(|(name, unit)| {
            let column = Column::new(name, Kind::Samples, "the recorded channel");
            column.unit(*unit).role(Role::Signal)
        }));
        signals.extend(sampling(plan));
        let mut summed_up = about;
        let names = channels.iter().map(|(name, unit)| (name.as_str(), *unit));
        summed_up.extend(
            features::columns(names, plan.chaos)
                .into_iter()
                .map(features::column),
        );
        let metadata = plan.metadata();
        let mut of_signals = metadata.clone();
        of_signals.extend(plan.over_angle.map(|over_angle| {
            let samples = over_angle.samples_per_revolution.to_string();
            ("samples_per_revolution".to_owned(), samples)
        }));
        Ok(Self {
            signals: Schema::new(signals)?.with_metadata(of_signals),
            features: Schema::new(summed_up)?.with_metadata(metadata),
        })
    }
}

/// How the channels of a row are sampled.
fn sampling(plan: &Plan) -> Vec<Column> {
    let column =
        |name: &str, kind, meaning: &str| Column::new(name, kind, meaning).role(Role::Condition);
    if plan.over_angle.is_none() {
        let meaning = "samples per second of the channels";
        return vec![column("sample_rate_hz", Kind::Real, meaning).unit("Hz")];
    }
    vec![
        column(
            "samples_per_revolution",
            Kind::Integer,
            "samples of the channels in a revolution, at equal steps of the crank angle",
        ),
        column(
            "start_angle_rad",
            Kind::Real,
            "crank angle of the first sample",
        )
        .unit("rad"),
    ]
}

/// What both tables say about a case before they part: names, labels, operating point, parameters.
fn about(plan: &Plan) -> Vec<Column> {
    let text = |name: &str, meaning: &str| Column::new(name, Kind::Text, meaning);
    let integer = |name: &str, meaning: &str| Column::new(name, Kind::Integer, meaning);
    let real = |name: String, unit: &str, meaning: String| {
        Column::new(name, Kind::Real, meaning).unit(unit)
    };
    let mut columns = vec![
        text("case_id", "name of the case").role(Role::Identifier),
        integer("window", "which window of the case's recording, from 0").role(Role::Identifier),
        integer(
            "repeat",
            "which repeat, from 0; repeats differ in noise alone",
        )
        .role(Role::Identifier),
        text(
            "group",
            "the same for cases that differ in noise and sensors alone",
        )
        .role(Role::Identifier),
        text(
            "split",
            "train, validation or test; a group is in one split only",
        )
        .role(Role::Identifier),
        text(
            "fault",
            "the joints whose clearance exceeds the normal one and the varied effects that are \
             there, joined by +, or none",
        )
        .role(Role::Label),
        integer("faulty_joints", "how many joints those are").role(Role::Label),
    ];
    columns.extend(plan.joints.iter().map(|joint| {
        let meaning = format!(
            "radial clearance of the joint {}; 0 where it is ideal",
            joint.name
        );
        let column = real(format!("clearance_{}_m", joint.name), "m", meaning);
        column.role(Role::Label)
    }));
    columns.extend([
        text(
            "fault_type",
            "the faults in the words of bearing-datasets, joined by +: bearing for a joint but the guide and an effect on \
             one, unbalance, misalignment, other; normal for none",
        )
        .role(Role::Label),
        text(
            "fault_location",
            "the joint or part of the machine of each fault of fault_type, in its order, joined by +; none for none",
        )
        .role(Role::Label),
        integer(
            "fault_severity_level",
            "rank of the size of the fault among those of its joint or effect in the dataset, of the most severe where \
             there are several: 0 for none, then 1, 2, ... from the mildest",
        )
        .role(Role::Label),
    ]);
    let speed = real("speed_rpm".into(), "rpm", "speed of the crank".into());
    columns.push(speed.role(Role::Condition));
    for throw in plan.throws() {
        for side in ["suction", "discharge"] {
            let name = prefixed(throw, &format!("{side}_pressure_pa"));
            let pressure = real(name, "Pa", format!("{side} pressure, absolute"));
            columns.push(pressure.role(Role::Condition));
        }
    }
    let load = "gas load of the piston rod: discharge less suction pressure times the area of the piston, of the throw \
                where that is largest";
    columns.push(real("load".into(), "N", load.into()).role(Role::Condition));
    columns.extend(plan.parameters.iter().map(|parameter| {
        let kind = if parameter.is_number {
            Kind::Real
        } else {
            Kind::Text
        };
        let meaning = format!("{} of the machine file", parameter.path);
        let column = Column::new(&parameter.column, kind, meaning).optional();
        let column = column.role(parameter.role);
        match &parameter.unit {
            Some(unit) if unit != "%" => column.unit(unit),
            _ => column,
        }
    }));
    let judged = plan.judgement.iter().flat_map(judged_columns);
    columns.extend(judged.map(|column| column.role(Role::Label)));
    columns
}

pub(crate) fn prefixed(throw: &str, name: &str) -> String {
    match throw {
        "" => name.to_owned(),
        throw => format!("{throw}.{name}"),
    }
}

/// The values of the columns that both tables begin with, for one window of `case`.
fn about_row(plan: &Plan, case: &Case, window: usize) -> Vec<Value> {
    let mut row: Vec<Value> = vec![
        case.id.as_str().into(),
        (window as i64).into(),
        (case.repeat as i64).into(),
        format!("{:016x}", case.group).into(),
        case.split.name().into(),
        case.labels.fault.as_str().into(),
        (case.labels.faulty_joints as i64).into(),
    ];
    row.extend(case.labels.clearances_m.iter().map(|&c| Value::from(c)));
    row.extend([
        fault_type(&case.labels.faults).into(),
        fault_location(&case.labels.faults).into(),
        (plan.severity_level(&case.labels) as i64).into(),
    ]);
    row.push(case.operating_point.speed_rpm.into());
    let pressures = case.operating_point.pressures_pa.iter().flatten();
    row.extend(pressures.map(|&p| Value::from(p)));
    row.push(case.operating_point.gas_load_n.into());
    row.extend(plan.parameters.iter().map(|p| p.value(&case.tree)));
    if let Some(judgement) = &plan.judgement {
        row.extend(judged_values(judgement, case.motion.as_ref()));
    }
    row
}

/// The row of `signals` for a window with these channels.
pub(super) fn signals_row(
    plan: &Plan,
    case: &Case,
    window: usize,
    channels: Vec<Channel>,
    sample_rate_hz: f64,
) -> Vec<Value> {
    let mut row = about_row(plan, case, window);
    row.extend(channels.into_iter().map(|c| Value::from(c.samples)));
    match plan.over_angle {
        None => row.push(sample_rate_hz.into()),
        Some(over_angle) => row.extend([
            i64::from(over_angle.samples_per_revolution).into(),
            over_angle.angle(over_angle.start_of(case)).into(),
        ]),
    }
    row
}

/// The row of `features` for a window with these channels.
pub(super) fn features_row(
    plan: &Plan,
    case: &Case,
    window: usize,
    channels: &[Channel],
    sample_rate_hz: f64,
) -> Vec<Value> {
    let crank_angle = channels.iter().find(|c| c.name == CRANK_ANGLE);
    let mut row = about_row(plan, case, window);
    let window = features::Window {
        sample_rate: sample_rate_hz,
        speed_rpm: Some(case.operating_point.speed_rpm),
        crank_angle: crank_angle.map(|c| features::CrankAngles {
            angles: &c.samples,
            from_top_dead_centre: true,
        }),
        channels,
        chambers: &Chamber::of_machine(&case.resolved.machine),
    };
    let cells = features::row(&window, plan.chaos);
    row.extend(cells.into_iter().map(|cell| match cell {
        Some(Cell::Number(number)) => number.into(),
        Some(Cell::Text(text)) => text.into(),
        None => Value::Missing,
    }));
    row
}

/// What an MCAP file says about its case: the columns before the channels, as text.
pub(super) fn labels(plan: &Plan, case: &Case) -> BTreeMap<String, String> {
    let columns = about(plan).into_iter().zip(about_row(plan, case, 0));
    let text = |value| match value {
        Value::Text(text) => Some(text),
        Value::Integer(number) => Some(number.to_string()),
        Value::Real(number) => Some(number.to_string()),
        Value::Flag(flag) => Some(flag.to_string()),
        Value::Samples(numbers) => {
            let numbers: Vec<String> = numbers.iter().map(f32::to_string).collect();
            Some(numbers.join(" "))
        }
        Value::Missing => None,
    };
    columns
        .filter(|(column, _)| column.name != "window")
        .filter_map(|(column, value)| Some((column.name, text(value)?)))
        .collect()
}
