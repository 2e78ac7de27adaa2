//! Whether a recorded pressure can be that of its chamber between the lines that are stated for it.
//!
//! Valves connect a chamber with its lines whatever the machine does. Unloaded, motored or blocked in, it may reach
//! neither line: that is a finding, a [`ShutValve`]. A recording is refused where a mistake explains what no state of a
//! machine does: another unit, gauge for absolute, another throw, another load.

use crate::chamber::{Chamber, place};
use crate::shut_valve::Valve;
use input::effects::entry;
use mechanism::{Machine, Throw};

/// Share of a line's pressure within which a recording reaches it.
const REACHES: f64 = 0.25;
/// Units of pressure that are taken for one another, and their size, Pa.
const UNITS: [(&str, f64); 6] = [
    ("Pa", 1.0),
    ("mbar", 1e2),
    ("kPa", 1e3),
    ("psi", 6894.757),
    ("bar", 1e5),
    ("MPa", 1e6),
];
/// Standard atmosphere, from which gauge pressures count, Pa.
const ATMOSPHERE: f64 = 101_325.0;
/// A valve that is open holds the pressure within this share while the chamber's volume changes by this factor. With
/// both valves shut the pressure changes at least as much as the volume.
const STEADY: f64 = 0.1;
const VOLUME: f64 = 2.0;

/// A pressure over one revolution.
#[derive(Clone, Debug)]
pub(crate) struct Recorded {
    /// Crank angles, rad.
    pub angles: Vec<f64>,
    /// The pressure there, Pa.
    pub pressures: Vec<f64>,
    /// Whether the crank turns with the angle.
    pub forward: bool,
}

impl Recorded {
    /// Least and greatest pressure, Pa.
    fn range(&self) -> [f64; 2] {
        let all = self.pressures.iter();
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(*x), high.max(*x)]
        })
    }

    /// Whether the valve is open for a part of its stroke, at a pressure that is nearly the same.
    fn opens(&self, valve: Valve, chamber: &Chamber) -> bool {
        let [low, high] = self.range();
        let smallest = chamber.clearance;
        let greatest = smallest + chamber.stroke();
        let samples = self.angles.iter().zip(&self.pressures);
        let mut in_stroke = samples.filter(|(angle, _)| {
            let grows = chamber.is_growing(**angle) == self.forward;
            let distance = chamber.distance(**angle);
            match valve {
                Valve::Suction => grows && distance * VOLUME >= greatest,
                Valve::Discharge => !grows && distance <= smallest * VOLUME,
            }
        });
        in_stroke.all(|(_, pressure)| match valve {
            Valve::Suction => *pressure <= (1.0 + STEADY) * low,
            Valve::Discharge => *pressure >= (1.0 - STEADY) * high,
        })
    }
}

/// The valves that a recorded pressure does not open, with the pressure that it reaches and that of the line, Pa.
///
/// # Errors
/// The mistake that explains a pressure which no state of the machine shows.
pub(crate) fn shut_valves(
    machine: &Machine,
    column: &str,
    recorded: &Recorded,
) -> Result<Vec<(Valve, [f64; 2])>, String> {
    let Some((throw, _)) = place(machine, column) else {
        return Ok(Vec::new());
    };
    let Some(chamber) = Chamber::of_column(machine, column) else {
        return Ok(Vec::new());
    };
    let range = recorded.range();
    let lines = lines(&machine.throws[throw]);
    refuse_throw(machine, throw, range)?;
    refuse_gauge(range, lines)?;
    refuse_unit(range, lines)?;
    let [shown, stated] = [range, lines];
    let mut shut = Vec::new();
    if shown[1] < (1.0 - REACHES) * stated[1] {
        let above_suction = shown[1] > (1.0 + REACHES) * stated[0];
        if above_suction && recorded.opens(Valve::Discharge, &chamber) {
            return Err(of_another_load(
                "greatest",
                Valve::Discharge,
                shown[1],
                stated[1],
            ));
        }
        shut.push((Valve::Discharge, [shown[1], stated[1]]));
    }
    if shown[0] > (1.0 + REACHES) * stated[0] {
        let below_greatest = shown[0] < (1.0 - REACHES) * shown[1];
        if below_greatest && recorded.opens(Valve::Suction, &chamber) {
            return Err(of_another_load(
                "least",
                Valve::Suction,
                shown[0],
                stated[0],
            ));
        }
        shut.push((Valve::Suction, [shown[0], stated[0]]));
    }
    Ok(shut)
}

/// Suction and discharge pressure of a throw, Pa.
fn lines(throw: &Throw) -> [f64; 2] {
    [throw.cylinder.suction, throw.cylinder.discharge]
}

/// Whether two pressures are within reach of each other.
fn meet(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() <= REACHES
}

/// By what share a valve's loss takes the pressure beyond its line at most, as the catalogue has it.
fn greatest_loss() -> f64 {
    let loss = entry("valve_loss").and_then(|entry| entry.parameter("suction"));
    loss.map_or(0.0, |parameter| parameter.bounds[1])
}

/// Whether no state of a machine shows such a range between these lines: a valve would have opened.
fn is_impossible([least, greatest]: [f64; 2], [suction, discharge]: [f64; 2]) -> bool {
    let loss = greatest_loss();
    least < (1.0 - loss) * suction || greatest > (1.0 + loss) * discharge
}

fn refuse_gauge(range: [f64; 2], lines: [f64; 2]) -> Result<(), String> {
    let [least, greatest] = range;
    let raised = range.map(|p| p + ATMOSPHERE);
    let gauge = least < (1.0 - greatest_loss()) * lines[0]
        && meet(raised[0], lines[0])
        && !is_impossible(raised, lines);
    if gauge {
        return Err(format!(
            "its values, {least:.4} to {greatest:.4} Pa, fit the stated pressures, {:.4} to {:.4} Pa, if they count from \
             the ambient pressure: state a gauge unit (barg, psig) and the ambient pressure as its offset",
            lines[0], lines[1]
        ));
    }
    if least < -REACHES * lines[0] {
        return Err(format!(
            "its least value is {least:.4} Pa, and no absolute pressure is below 0: check its unit and its zero"
        ));
    }
    Ok(())
}

/// Refuses a range that another unit brings to the lines, where it is outside of them or never reaches the suction line.
fn refuse_unit(range: [f64; 2], lines: [f64; 2]) -> Result<(), String> {
    if !is_impossible(range, lines) && range[0] <= (1.0 + REACHES) * lines[0] {
        return Ok(());
    }
    let pairs = UNITS
        .iter()
        .flat_map(|read| UNITS.map(|meant| (*read, meant)));
    let mut found: Vec<(f64, String)> = Vec::new();
    for ((read, size), (meant, true_size)) in pairs.filter(|(read, meant)| read.0 != meant.0) {
        let factor = true_size / size;
        for (zero, gauge) in [
            (0.0, ""),
            (ATMOSPHERE, " and count from the ambient pressure"),
        ] {
            let [least, greatest] = range.map(|p| factor * p + zero);
            if meet(least, lines[0]) && !is_impossible([least, greatest], lines) {
                let off = (least / lines[0]).ln().abs() + (greatest / lines[1]).ln().abs();
                found.push((off, format!("are in {meant} and not in {read}{gauge}")));
            }
        }
    }
    let Some(nearest) = found.iter().map(|(off, _)| *off).min_by(f64::total_cmp) else {
        return Ok(());
    };
    // Pairs of units that differ by the same factor are equally near.
    found.retain(|(off, _)| *off - nearest < 1e-6);
    let said: Vec<String> = found.into_iter().map(|(_, said)| said).collect();
    Err(format!(
        "its values, {:.4} to {:.4} Pa, fit the stated pressures, {:.4} to {:.4} Pa, if they {}: check its unit and the run's load, \
         which are absolute",
        range[0],
        range[1],
        lines[0],
        lines[1],
        said.join(", or ")
    ))
}

/// Refuses a range that is that of another throw's lines, and not of its own.
fn refuse_throw(machine: &Machine, own: usize, range: [f64; 2]) -> Result<(), String> {
    let is_of = |throw: &Throw| {
        let [suction, discharge] = lines(throw);
        meet(range[0], suction) && meet(range[1], discharge)
    };
    let mut others = machine.throws.iter().enumerate();
    let other = others.find(|(i, throw)| *i != own && is_of(throw));
    match other {
        Some((_, other)) if !is_of(&machine.throws[own]) => {
            let [own, stated] = [&machine.throws[own], other].map(lines);
            Err(format!(
                "its values, {:.4} to {:.4} Pa, are those of {}, {:.4} to {:.4} Pa, and not its own, {:.4} to {:.4} Pa: are the two \
                 throws swapped?",
                range[0], range[1], other.name, stated[0], stated[1], own[0], own[1]
            ))
        }
        _ => Ok(()),
    }
}

fn of_another_load(which: &str, valve: Valve, shown: f64, stated: f64) -> String {
    let line = valve.name();
    format!(
        "its {which} value is {shown:.4} Pa and never reaches the {line} pressure, {stated:.4} Pa, although the {line} valve opens: \
         check its unit and the run's load, which are absolute"
    )
}
