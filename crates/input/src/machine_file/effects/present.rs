//! The effects of a file.

use super::act::Draft;
use super::section::EffectSection;
use crate::error::{Error, Problem};
use mechanism::{Machine, Throw};
use simulate::Sensor;

impl EffectSection {
    /// Whether nothing is left of it: all its amplitudes are where it vanishes.
    fn is_absent(&self) -> bool {
        let values = self.values();
        let parameters = self.entry.parameters.iter().zip(values);
        let mut amplitudes = parameters.filter_map(|(p, value)| Some((p.absent?, value)));
        self.entry.amplitudes().next().is_some() && amplitudes.all(|(absent, v)| absent == v)
    }

    /// An effect must say how large it is.
    fn check(&self) -> Result<(), Error> {
        let parameters = self.entry.parameters.iter().zip(&self.stated);
        let mut amplitudes = parameters.filter(|(p, _)| p.absent.is_some());
        match self.entry.amplitudes().next() {
            Some(first) if amplitudes.all(|(_, stated)| stated.is_none()) => {
                let expected = None;
                Err(Error::new(first.key, Problem::Missing { expected }))
            }
            _ => Ok(()),
        }
    }
}

/// The effects of a file, each at most once at its place.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Effects(Vec<(usize, EffectSection)>);

impl Effects {
    /// Those of the list `sections` that are there at all.
    pub fn new(sections: &[EffectSection]) -> Result<Self, Error> {
        for (i, effect) in sections.iter().enumerate() {
            effect
                .check()
                .map_err(|e| e.under(effect.entry.name).under(i))?;
            let alike = |other: &EffectSection| {
                let same_place = effect.entry == other.entry && effect.place == other.place;
                same_place && effect.orders() == other.orders()
            };
            if let Some(first) = sections[..i].iter().position(alike) {
                let found = format_args!("the effect of effects.{first} again");
                let expected = "each effect at most once at its place";
                let error = Error::unexpected(i.to_string(), found, expected);
                return Err(error.against("/effects.*.*.*"));
            }
        }
        let present = sections.iter().cloned().enumerate();
        Ok(Self(
            present.filter(|(_, effect)| !effect.is_absent()).collect(),
        ))
    }

    /// Changes what the file says, before the machine is made of it.
    pub fn prepare(&self, file: &mut dyn Draft) -> Result<(), Error> {
        for (i, effect) in &self.0 {
            let prepared = effect.effect().prepare(file, &effect.place);
            prepared.map_err(|e| e.under(effect.entry.name).under(i))?;
        }
        Ok(())
    }

    /// Changes the machine, but for the effects at these positions of the list.
    pub fn act(&self, machine: &mut Machine, idle: &[usize]) -> Result<(), Error> {
        let acting = self.0.iter().filter(|(i, _)| !idle.contains(i));
        for (i, effect) in acting {
            let place = effect.place.resolve(&machine.throws);
            let acted = place.and_then(|place| effect.effect().act(machine, &place));
            acted.map_err(|e| e.under(effect.entry.name).under(i))?;
        }
        Ok(())
    }

    /// Changes a sensor of a machine with these throws.
    pub fn sense(&self, sensor: &mut Sensor, throws: &[Throw]) {
        let names: Vec<&str> = throws.iter().map(|t| t.name.as_str()).collect();
        for (_, effect) in &self.0 {
            effect.effect().sense(sensor, &effect.place, &names);
        }
    }
}

/// Positions of the effects of the list `sections` that cannot act in `machine`, as their joint is ideal.
///
/// # Errors
/// A place that the machine does not have.
pub(crate) fn idle(sections: &[EffectSection], machine: &Machine) -> Result<Vec<usize>, Error> {
    let mut idle = Vec::new();
    for (i, effect) in sections.iter().enumerate() {
        let place = effect.place.resolve(&machine.throws);
        let place = place.map_err(|e| e.under(effect.entry.name).under(i))?;
        if !place.has_play(machine) {
            idle.push(i);
        }
    }
    Ok(idle)
}
