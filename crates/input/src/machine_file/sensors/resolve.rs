//! The sensors of a machine, from their sections.

use super::section::{Axis, End, SensorSection};
use crate::error::{Error, Problem};
use mechanism::Machine;
use mechanism::declaration::Quantity;
use simulate::sensor::{Range, Sensor};
use simulate::sensors::{self, ChamberEnd, Place};
use std::f64::consts::TAU;

/// The sensors on `machine`.
///
/// # Errors
/// The first sensor that does not go together with the machine, or that measures what another does.
pub(crate) fn resolve(sections: &[SensorSection], machine: &Machine) -> Result<Vec<Sensor>, Error> {
    let names = machine.throw_names();
    let mut sensors: Vec<Sensor> = Vec::new();
    for (i, section) in sections.iter().enumerate() {
        let sensor = section.resolve(machine, &names).map_err(|e| e.under(i))?;
        if let Some(first) = sensors.iter().position(|s| s.measured == sensor.measured) {
            let found = format_args!("what sensors.{first} measures already");
            let error = Error::unexpected(i.to_string(), found, "each quantity at most once");
            return Err(error.against("/sensors.*.*"));
        }
        sensors.push(sensor);
    }
    Ok(sensors)
}

impl SensorSection {
    fn resolve(&self, machine: &Machine, names: &[&str]) -> Result<Sensor, Error> {
        let entry = self.entry();
        let place = self.place(names)?;
        let checked = (entry.declaration.check)(machine, &place);
        checked.map_err(|clash| Error::clash(clash.key, clash.expected))?;
        let mut chain = self.chain.clone();
        // The range of an encoder is its turn.
        if entry.declaration.quantity == Quantity::Angle && chain.bits.is_some() {
            chain.range.get_or_insert(Range::Fixed(TAU));
        }
        if let (Some(bits), None) = (chain.bits, chain.range) {
            let found = format_args!("{bits} without a range");
            return Err(Error::unexpected("bits", found, "a key range beside it"));
        }
        let measured = (entry.measured)(place);
        chain.structure = measured.structure(machine);
        Ok(Sensor { measured, chain })
    }

    fn place(&self, names: &[&str]) -> Result<Place, Error> {
        Ok(Place {
            throw: match self.entry().is_of_throw() {
                true => throw(&self.throw, names)?,
                false => 0,
            },
            axis: match self.axis {
                Some(Axis::Y) => sensors::Axis::Y,
                Some(Axis::X) | None => sensors::Axis::X,
            },
            end: match self.end {
                End::Head => ChamberEnd::Head,
                End::Crank => ChamberEnd::Crank,
            },
        })
    }
}

/// The index of the throw called `name`, or of the only one.
fn throw(name: &Option<String>, names: &[&str]) -> Result<usize, Error> {
    match name {
        None if names.len() == 1 => Ok(0),
        None => {
            let expected = Some(format!("one of {}", names.join(", ")));
            Err(Error::new("throw", Problem::Missing { expected }))
        }
        Some(name) => names
            .iter()
            .position(|known| known == name)
            .ok_or_else(|| Error::unknown_name("throw", name, named(names))),
    }
}

/// The names to choose from: none in a machine whose only throw has no name.
fn named<'a, 'b>(names: &'a [&'b str]) -> &'a [&'b str] {
    match names {
        [""] => &[],
        names => names,
    }
}
