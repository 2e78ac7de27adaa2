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
/// Logarithms of factors that differ by less are the same.
const SAME_FACTOR: f64 = 1e-6;
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

/// Refuses a range that another unit or zero brings to the lines, where it is outside of them or never reaches the suction line.
fn refuse_unit(range: [f64; 2], lines: [f64; 2]) -> Result<(), String> {
    if !is_impossible(range, lines) && range[0] <= (1.0 + REACHES) * lines[0] {
        return Ok(());
    }
    let fits = |factor: f64, zero: f64| {
        let [least, greatest] = range.map(|p| factor * p + zero);
        // Of a small factor little but the zero is left, which fits by itself where the suction pressure is the ambient one.
        let full = meet(greatest, lines[1]) || factor == 1.0 || zero == 0.0;
        let fits = meet(least, lines[0]) && !is_impossible([least, greatest], lines) && full;
        fits.then(|| (least / lines[0]).ln().abs() + (greatest / lines[1]).ln().abs())
    };
    let mut found: Vec<(f64, String)> = Vec::new();
    let gauge = "count from the ambient pressure";
    found.extend(fits(1.0, ATMOSPHERE).map(|off| (off, gauge.to_owned())));
    for (read, size) in UNITS {
        for (meant, true_size) in UNITS.into_iter().filter(|(meant, _)| *meant != read) {
            let units = format!("are in {meant} and not in {read}");
            let factor = true_size / size;
            let raised = fits(factor, ATMOSPHERE).map(|off| (off, format!("{units} and {gauge}")));
            found.extend(fits(factor, 0.0).map(|off| (off, units)));
            found.extend(raised);
        }
    }
    let nearest = found.iter().map(|(off, _)| *off).min_by(f64::total_cmp);
    if let Some(nearest) = nearest {
        // Pairs of units that differ by the same factor are equally near.
        found.retain(|(off, _)| *off - nearest < SAME_FACTOR);
        let said: Vec<String> = found.into_iter().map(|(_, said)| said).collect();
        return Err(format!(
            "its values, {:.4} to {:.4} Pa, fit the stated pressures, {:.4} to {:.4} Pa, if they {}: check its unit and the \
             run's load, which are absolute",
            range[0],
            range[1],
            lines[0],
            lines[1],
            said.join(", or ")
        ));
    }
    if range[0] < -REACHES * lines[0] {
        return Err(format!(
            "its least value is {:.4} Pa, and no absolute pressure is below 0: check its unit and its zero",
            range[0]
        ));
    }
    Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};
    use std::path::Path;

    const COLUMN: &str = "cylinder_pressure_pa";
    /// The lines of the single-stage machine, and its exponent.
    const LINES: [f64; 2] = [105e3, 393e3];
    const EXPONENT: f64 = 1.4;

    fn machine(name: &str) -> Machine {
        let file = format!("{}/../../data/machines/{name}", env!("CARGO_MANIFEST_DIR"));
        let file = input::machine_file::read(Path::new(&file)).unwrap();
        file.resolve().unwrap().machine
    }

    /// A pressure over the distance from the cover and whether the chamber grows.
    fn recorded(chamber: &Chamber, pressure: impl Fn(f64, bool) -> f64) -> Recorded {
        let angles: Vec<f64> = (0..360).map(|i| TAU * f64::from(i) / 360.0).collect();
        let of = |angle: &f64| pressure(chamber.distance(*angle), chamber.is_growing(*angle));
        Recorded {
            pressures: angles.iter().map(of).collect(),
            angles,
            forward: true,
        }
    }

    /// Ideal valves between these lines.
    fn cycle(chamber: &Chamber, [suction, discharge]: [f64; 2]) -> Recorded {
        let smallest = chamber.clearance;
        let greatest = smallest + chamber.stroke();
        recorded(chamber, |distance, grows| {
            let closed = match grows {
                true => discharge * (smallest / distance).powf(EXPONENT),
                false => suction * (greatest / distance).powf(EXPONENT),
            };
            closed.clamp(suction, discharge)
        })
    }

    /// Gas that is shut in, with this pressure where the chamber is largest.
    fn blocked_in(chamber: &Chamber, pressure: f64) -> Recorded {
        let greatest = chamber.clearance + chamber.stroke();
        recorded(chamber, |distance, _| {
            pressure * (greatest / distance).powf(EXPONENT)
        })
    }

    fn scaled(recorded: &Recorded, factor: f64, zero: f64) -> Recorded {
        let pressures = recorded.pressures.iter();
        Recorded {
            pressures: pressures.map(|p| factor * p + zero).collect(),
            ..recorded.clone()
        }
    }

    fn valves(recorded: &Recorded) -> Result<Vec<Valve>, String> {
        let found = shut_valves(&machine("single-stage.yaml"), COLUMN, recorded)?;
        Ok(found.into_iter().map(|(valve, _)| valve).collect())
    }

    fn chamber() -> Chamber {
        Chamber::of_column(&machine("single-stage.yaml"), COLUMN).unwrap()
    }

    #[test]
    fn what_a_machine_may_do_is_accepted() {
        let chamber = chamber();
        assert_eq!(valves(&cycle(&chamber, LINES)), Ok(Vec::new()));
        let shut = Ok(vec![Valve::Discharge]);
        // Unloaded, throttled either way at most as the catalogue has it, and motored without valves.
        for loss in [0.0, 0.05, 0.3, 0.5] {
            let unloaded = recorded(&chamber, |distance, grows| {
                let sign = if grows { -1.0 } else { 1.0 };
                let middle = (distance - chamber.clearance) / chamber.stroke();
                LINES[0] * (1.0 + sign * loss * 4.0 * middle * (1.0 - middle))
            });
            assert_eq!(valves(&unloaded), shut, "{loss}");
        }
        // Closed late: the compression starts near the dead centre.
        for filled in [1.1, 1.3, 1.6, 2.0] {
            let late = recorded(&chamber, |distance, grows| match grows {
                true => LINES[0],
                false => {
                    LINES[0]
                        * (filled * chamber.clearance / distance)
                            .max(1.0)
                            .powf(EXPONENT)
                }
            });
            assert_eq!(valves(&late), shut, "{filled}");
        }
        // Shut in with less gas than the suction line would give, and where both lines are far away.
        let mut high = machine("single-stage.yaml");
        high.throws[0].cylinder.discharge = 1e7;
        for (pressure, expected) in [
            (LINES[0], vec![Valve::Discharge]),
            (1.4 * LINES[0], vec![Valve::Discharge, Valve::Suction]),
        ] {
            let found = shut_valves(&high, COLUMN, &blocked_in(&chamber, pressure)).unwrap();
            let found: Vec<Valve> = found.into_iter().map(|(valve, _)| valve).collect();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn every_other_unit_is_refused_in_a_machine_at_work_and_in_an_unloaded_one() {
        let chamber = chamber();
        let unloaded = recorded(&chamber, |_, _| LINES[0]);
        for ((read, size), (meant, true_size)) in UNITS
            .iter()
            .flat_map(|read| UNITS.map(|meant| (*read, meant)))
        {
            if read == meant {
                continue;
            }
            for right in [&cycle(&chamber, LINES), &unloaded] {
                let said = valves(&scaled(right, size / true_size, 0.0)).unwrap_err();
                assert!(
                    said.contains(&format!("are in {meant} and not in {read}")),
                    "{said}"
                );
            }
        }
        // 1 bar is 0 in barg.
        for right in [&cycle(&chamber, LINES), &unloaded] {
            let said = valves(&scaled(right, 1.0, -ATMOSPHERE)).unwrap_err();
            assert!(said.contains("count from the ambient pressure"), "{said}");
            let said = valves(&scaled(right, 1e-5, -1.01325)).unwrap_err();
            assert!(said.contains("count from the ambient pressure"), "{said}");
        }
        let said = valves(&scaled(&unloaded, 1.0, -3e5)).unwrap_err();
        assert!(said.contains("no absolute pressure is below 0"), "{said}");
    }

    #[test]
    fn a_valve_that_opens_at_another_pressure_is_refused() {
        let chamber = chamber();
        for (lines, expected) in [
            (
                [LINES[0], 0.5 * LINES[1]],
                "never reaches the discharge pressure",
            ),
            (
                [1.6 * LINES[0], LINES[1]],
                "never reaches the suction pressure",
            ),
        ] {
            let said = valves(&cycle(&chamber, lines)).unwrap_err();
            assert!(
                said.contains(expected) && said.contains("valve opens"),
                "{said}"
            );
        }
    }

    #[test]
    fn the_pressure_of_another_throw_is_refused() {
        let machine = machine("two-stage.yaml");
        let columns = ["throw1.cylinder_pressure_pa", "throw2.cylinder_pressure_pa"];
        for (own, other) in [(0, 1), (1, 0)] {
            let right = cycle(
                &Chamber::of_column(&machine, columns[own]).unwrap(),
                lines(&machine.throws[own]),
            );
            assert_eq!(shut_valves(&machine, columns[own], &right), Ok(Vec::new()));
            let said = shut_valves(&machine, columns[other], &right).unwrap_err();
            assert!(said.contains("swapped"), "{said}");
        }
    }

    #[test]
    fn a_crank_that_turns_the_other_way_has_its_strokes_the_other_way_round() {
        let chamber = chamber();
        let forward = cycle(&chamber, [LINES[0], 0.5 * LINES[1]]);
        let mirrored = Recorded {
            angles: forward.angles.iter().map(|a| -a).collect(),
            forward: false,
            ..forward.clone()
        };
        assert!(forward.opens(Valve::Discharge, &chamber));
        assert!(mirrored.opens(Valve::Discharge, &chamber));
        assert!(
            !Recorded {
                forward: true,
                ..mirrored
            }
            .opens(Valve::Discharge, &chamber)
        );
        assert!((chamber.distance(PI) - chamber.clearance - chamber.stroke()).abs() < 1e-9);
    }
}
