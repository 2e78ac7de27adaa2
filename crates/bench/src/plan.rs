//! The cases of a test bench, in rounds.

use crate::error::Error;
use crate::machine::Machine;
use crate::outside::Outside;
use crate::settings::HiddenEffects;
use input::effects::{CATALOGUE, Entry};
use rand::seq::IndexedRandom;
use scalar::random::{Purpose, stream};
use std::ops::RangeInclusive;

/// What a case without a hidden effect is called.
pub const NOTHING: &str = "nothing";

/// A case: what is hidden in recordings of which machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// From 1 on; all random numbers of the case follow from it and the seed.
    pub number: u64,
    /// Index among the machines of the file.
    pub machine: usize,
    /// Noise of the accelerations, of their RMS.
    pub noise: f64,
    /// Amplitudes over the usual ones.
    pub size: f64,
    /// The effects that are hidden: none, one or two.
    pub hidden: Vec<&'static Entry>,
    /// What is hidden that no catalogue has.
    pub outside: Option<Outside>,
}

impl Case {
    /// What is hidden, in a word.
    pub fn label(&self) -> String {
        let names: Vec<&str> = self.hidden.iter().map(|entry| entry.name).collect();
        match (self.outside, names.is_empty()) {
            (Some(outside), _) => outside.name().to_owned(),
            (None, true) => NOTHING.to_owned(),
            (None, false) => names.join("+"),
        }
    }

    /// What its folder is called.
    pub fn id(&self) -> String {
        format!("{:04}-{}", self.number, self.label())
    }

    /// Whether `name` is hidden in it, or nothing is and `name` says so.
    pub fn hides(&self, name: &str) -> bool {
        match (self.outside, self.hidden.is_empty()) {
            (Some(outside), _) => name == outside.name(),
            (None, true) => name == NOTHING,
            (None, false) => self.hidden.iter().any(|entry| entry.name == name),
        }
    }
}

/// The cases that hide one of the effects `only`, or any where there are none, and whose number is one of `numbers`.
///
/// # Errors
/// A name that no effect has, or no case that is left.
pub fn chosen(
    cases: Vec<Case>,
    only: &[String],
    numbers: Option<&RangeInclusive<u64>>,
) -> Result<Vec<Case>, Error> {
    let others = Outside::ALL.map(Outside::name).into_iter().chain([NOTHING]);
    let names: Vec<&str> = CATALOGUE.iter().map(|e| e.name).chain(others).collect();
    if let Some(unknown) = only.iter().find(|name| !names.contains(&name.as_str())) {
        let nearest = input::nearest(unknown, names.iter().copied());
        let hint = nearest.map_or(".".into(), |near| format!("; did you mean {near}?"));
        return Err(Error::Cases(format!(
            "--only {unknown}: there is no such effect{hint} They are {}.",
            names.join(", ")
        )));
    }
    let count = cases.len();
    let is_chosen = |case: &Case| {
        numbers.is_none_or(|numbers| numbers.contains(&case.number))
            && (only.is_empty() || only.iter().any(|name| case.hides(name)))
    };
    let chosen: Vec<Case> = cases.into_iter().filter(is_chosen).collect();
    match chosen.is_empty() {
        true => Err(Error::Cases(format!(
            "none of the {count} cases is asked for by --cases and --only"
        ))),
        false => Ok(chosen),
    }
}

/// A line for each case, with its machine.
pub fn listed(cases: &[Case], machines: &[Machine]) -> String {
    let line = |case: &Case| {
        let machine = &machines[case.machine];
        format!(
            "{:4}  {} ({} runs), noise {:.1} %, size {}: {}\n",
            case.number,
            machine.name,
            machine.runs.len(),
            100.0 * case.noise,
            case.size,
            case.label()
        )
    };
    cases.iter().map(line).collect()
}

/// All cases. In each round every effect is hidden once, then nothing, then pairs, then what is in
/// no catalogue. The combination of machine, noise and size changes from case to case and from
/// round to round, so each round has all combinations about equally often.
pub fn cases(settings: &HiddenEffects) -> Vec<Case> {
    let effects = settings.entries();
    let seed = u64::from(settings.seed.map_or(0, |seed| seed.get()));
    let nothing = settings.nothing.map_or(1, |count| count.get()) as usize;
    let pairs = settings.pairs.map_or(0, |count| count.get()) as usize;
    let outside = settings.outside.map_or(0, |count| count.get()) as usize;
    let [machines, noises, sizes] = [
        settings.machines.len(),
        settings.noises.len(),
        settings.sizes.len(),
    ];
    let combinations = machines * noises * sizes;
    let rounds = settings
        .rounds
        .map_or(combinations, |rounds| rounds.get() as usize);
    let within = effects.len() + nothing + pairs;
    let slots = within + outside;
    let of = |index: usize| {
        let [round, slot] = [index / slots, index % slots];
        let combination = (round + slot) % combinations;
        let number = index as u64 + 1;
        let hidden = match slot {
            single if single < effects.len() => vec![effects[single]],
            empty if empty < effects.len() + nothing || empty >= within => Vec::new(),
            _ => {
                let mut random = stream(seed, number, Purpose::Split);
                effects.sample(&mut random, 2).copied().collect()
            }
        };
        Case {
            number,
            machine: combination % machines,
            noise: settings.noises[combination / machines % noises].si(),
            size: settings.sizes[combination / (machines * noises)].get(),
            hidden,
            // One after another, over the rounds too.
            outside: slot
                .checked_sub(within)
                .map(|i| Outside::ALL[(round * outside + i) % Outside::ALL.len()]),
        }
    };
    (0..rounds * slots).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::yaml::Document;
    use std::collections::BTreeSet;

    fn settings(text: &str) -> HiddenEffects {
        Document::parse(text, "h.yaml").unwrap().read().unwrap()
    }

    #[test]
    fn every_effect_meets_every_combination_once() {
        let text = "machines: [{name: a, bundle: a}, {name: b, bundle: b}]\n\
                    sizes: [1, 3]\nnoises: [2 %, 5 %]\nnothing: 2\npairs: 1\n\
                    effects: [valve_loss, ring_friction, mains_hum]\n";
        let cases = cases(&settings(text));
        assert_eq!(cases.len(), 8 * 6);
        for name in ["valve_loss", "ring_friction", "mains_hum"] {
            let single = cases.iter().filter(|c| c.label() == name);
            let met: BTreeSet<String> = single
                .map(|c| format!("{} {} {}", c.machine, c.noise, c.size))
                .collect();
            assert_eq!(met.len(), 8, "{met:?}");
        }
        assert_eq!(cases.iter().filter(|c| c.hides(NOTHING)).count(), 16);
        let pairs: Vec<&Case> = cases.iter().filter(|c| c.hidden.len() == 2).collect();
        assert_eq!(pairs.len(), 8);
        assert!(pairs.iter().all(|c| c.hidden[0].name != c.hidden[1].name));
        assert_eq!(cases[6].id(), "0007-valve_loss");
    }

    #[test]
    fn what_no_catalogue_has_comes_last_and_in_turns() {
        let text = "machines: [{name: a, bundle: a}]\nsizes: [1]\nnoises: [2 %]\n\
                    effects: [valve_loss]\nnothing: 1\noutside: 2\nrounds: 2\n";
        let cases = cases(&settings(text));
        let labels: Vec<String> = cases.iter().map(Case::label).collect();
        let expected = ["valve_loss", "nothing", "contact_law", "compression"];
        assert_eq!(labels[..4], expected);
        assert_eq!(labels[6..], ["data_sheet", "contact_law"]);
        assert!(cases[2].hides("contact_law") && !cases[2].hides(NOTHING));
    }

    #[test]
    fn more_rounds_leave_the_first_as_they_are() {
        let text = "machines: [{name: a, bundle: a}]\nsizes: [1, 3]\nnoises: [2 %]\npairs: 2\n";
        let few = cases(&settings(&format!("{text}rounds: 1\n")));
        let many = cases(&settings(&format!("{text}rounds: 5\n")));
        assert_eq!(few[..], many[..few.len()]);
    }
}
