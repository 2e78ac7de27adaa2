//! The columns that have a meaning, and the words for them.

use mechanism::declaration::Quantity;
use simulate::sensors::{Entry, SENSORS};

/// What a known column is.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Time,
    CrankAngle,
    Tacho,
    Measured(Quantity),
}

/// A column that has a meaning, with the words for it.
pub(super) type Known = (String, Vec<String>, Kind);

/// The columns that have a meaning: those of the shaft, of the machine, and of each throw.
pub(super) fn known(throws: &[&str]) -> Vec<Known> {
    let angles = SENSORS.iter().filter(|sensor| is_angle(sensor));
    let others = SENSORS.iter().filter(|sensor| !is_angle(sensor));
    let of_machine = others.filter(|sensor| !sensor.is_of_throw());
    let mut all = vec![known_as("t_s", &["time", "t"], Kind::Time)];
    all.extend(angles.flat_map(|sensor| known_sensor(sensor, "")));
    all.push(known_as(
        "tacho",
        &["tacho", "tachometer", "keyphasor", "once per revolution"],
        Kind::Tacho,
    ));
    all.extend(of_machine.flat_map(|sensor| known_sensor(sensor, "")));
    all.extend(throws.iter().flat_map(|throw| known_of_throw(throw)));
    all
}

/// The columns of the throw of this name that have a meaning.
pub(super) fn known_of_throw(throw: &str) -> impl Iterator<Item = Known> {
    let others = SENSORS.iter().filter(|sensor| !is_angle(sensor));
    let of_throw = others.filter(|sensor| sensor.is_of_throw());
    of_throw.flat_map(move |sensor| known_sensor(sensor, throw))
}

fn is_angle(sensor: &Entry) -> bool {
    sensor.declaration.quantity == Quantity::Angle
}

fn known_as(column: &str, names: &[&str], kind: Kind) -> Known {
    let names = names.iter().map(|name| (*name).to_owned());
    (column.to_owned(), names.collect(), kind)
}

/// The channels of a sensor on the throw of this name; the name is empty in a machine of one.
fn known_sensor(sensor: &'static Entry, throw: &str) -> impl Iterator<Item = Known> + use<> {
    let (column_of, of) = (throw.to_owned(), words(throw));
    let declared = &sensor.declaration;
    let kind = match is_angle(sensor) {
        true => Kind::CrankAngle,
        false => Kind::Measured(declared.quantity),
    };
    declared.channels.iter().map(move |channel| {
        let names = channel.words.iter().map(|name| match of.is_empty() {
            true => (*name).to_owned(),
            false => format!("{of} {name}"),
        });
        (channel.column(&column_of), names.collect(), kind)
    })
}

/// The SI unit of a column that the model has: that of its sensor; empty for any other column.
pub fn unit_of_column(column: &str) -> &'static str {
    let column = column.rsplit('.').next().unwrap_or(column);
    let has_column = |sensor: &&Entry| {
        let mut channels = sensor.declaration.channels.iter();
        channels.any(|channel| channel.column == column)
    };
    let sensor = SENSORS.iter().find(has_column);
    sensor.map_or("", |sensor| sensor.declaration.unit)
}

/// Lower case, words apart, without a unit in brackets or at the end of a column's name.
pub(super) fn words(text: &str) -> String {
    const ENDINGS: [&str; 17] = [
        " m s2", " mm s", " in s", " m s", " ips", " kpa", " mpa", " pa", " mbar", " bar", " psig",
        " psia", " psi", " rad", " deg", " g", " s",
    ];
    let lower = text.to_lowercase();
    let joined = parts(&lower).collect::<Vec<_>>().join(" ");
    let ending = ENDINGS
        .iter()
        .find_map(|ending| joined.strip_suffix(ending));
    ending.map_or(joined.clone(), str::to_owned)
}

/// The words of a text before a unit in brackets.
pub(super) fn parts(text: &str) -> impl Iterator<Item = &str> {
    let text = text.split(['[', '(']).next().unwrap_or(text);
    let apart = |c: char| c.is_whitespace() || "_-.,:/".contains(c);
    text.split(apart).filter(|part| !part.is_empty())
}
