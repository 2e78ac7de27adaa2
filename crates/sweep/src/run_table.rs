//! One run as a table.

use crate::dataset::prefixed;
use recordings::{Column, Data, Kind, Schema, Table};
use signal::channel::Channel;
use simulate::{Record, ThrowTrace, Trace};

/// The channels of a run over time, and where a trace is given the motion itself.
///
/// # Errors
/// Channels of two lengths, or two of one name.
pub fn run_table(
    record: &Record,
    channels: &[Channel],
    trace: Option<&Trace>,
    throws: &[&str],
) -> Result<Table, recordings::Error> {
    let mut columns = vec![Column::new("t_s", Kind::Real, "time since the first sample").unit("s")];
    let count = channels.first().map_or_else(
        || record.series.first().map_or(0, Vec::len),
        |channel| channel.samples.len(),
    );
    let times = (0..count).map(|i| Some(i as f64 / record.sample_rate));
    let mut data = vec![Data::Real(times.collect())];
    let mut add = |name: &str, unit: &str, about: &str, values: Vec<Option<f64>>| {
        columns.push(Column::new(name, Kind::Real, about).unit(unit));
        data.push(Data::Real(values));
    };
    for channel in channels {
        let values = channel
            .samples
            .iter()
            .map(|x| Some(f64::from(*x)))
            .collect();
        add(
            &channel.name,
            &channel.unit,
            "as the sensor reads it",
            values,
        );
    }
    let stride = trace.map_or(1, |trace| trace.stride);
    for (trace, name) in trace.iter().flat_map(|t| t.throws.iter().zip(throws)) {
        for (column, unit, values) in motion_columns(trace) {
            let values = values.iter().step_by(stride).copied().map(Some).collect();
            add(&prefixed(name, &column), unit, "the motion itself", values);
        }
    }
    Table::from_columns(Schema::new(columns)?, data)
}

/// The motion of a throw as columns with their units.
fn motion_columns(throw: &ThrowTrace) -> Vec<(String, &'static str, &[f64])> {
    let mut columns: Vec<(String, &'static str, &[f64])> = vec![
        ("true_crosshead_position_m".into(), "m", &throw.position),
        ("true_crosshead_velocity_m_s".into(), "m/s", &throw.velocity),
        (
            "true_crosshead_acceleration_m_s2".into(),
            "m/s^2",
            &throw.acceleration,
        ),
        ("true_cylinder_pressure_pa".into(), "Pa", &throw.pressure),
    ];
    for (name, joint) in [("big_end", &throw.big_end), ("small_end", &throw.small_end)] {
        if let Some(joint) = joint {
            columns.extend([
                (format!("true_{name}_offset_x_m"), "m", joint.x.as_slice()),
                (format!("true_{name}_offset_y_m"), "m", joint.y.as_slice()),
                (
                    format!("true_{name}_normal_force_n"),
                    "N",
                    joint.normal_force.as_slice(),
                ),
                (
                    format!("true_{name}_friction_force_n"),
                    "N",
                    joint.friction_force.as_slice(),
                ),
            ]);
        }
    }
    columns
}
