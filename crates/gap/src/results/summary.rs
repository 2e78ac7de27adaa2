//! What an explanation found, in words.

use crate::results::{Other, Results};
use std::fmt;

/// The verdict, and a line for each effect, correction, run and sensor.
impl fmt::Display for Results {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{}", self.verdict.name())?;
        for effect in &self.effects {
            writeln!(
                f,
                "{} ({:.2}): {}",
                effect.label, effect.probability, effect.sentence
            )?;
            if let Some(expression) = &effect.expression {
                writeln!(f, "  F = {expression}")?;
            }
            for (key, unit, parameter) in effect.stated() {
                writeln!(f, "  {key}: {}", quantity(parameter.value, unit))?;
            }
            for other in &effect.rivals {
                writeln!(f, "  rival: {}, {}", other.label, rival(other))?;
            }
        }
        for wrong in &self.corrections {
            writeln!(
                f,
                "{} ({:.2}): {} in place of {}",
                wrong.path,
                wrong.probability,
                quantity(wrong.value, &wrong.unit),
                quantity(wrong.nominal, &wrong.unit)
            )?;
        }
        let gap = &self.gap;
        let held_out = gap.heldout_after.map_or(String::new(), |after| {
            let before = gap.heldout_before.unwrap_or(f64::NAN);
            format!("; of runs held out {before:.2} before, {after:.2} after")
        });
        writeln!(
            f,
            "gap: {:.2} before, {:.2} after{held_out}; noise is 1",
            gap.before, gap.after
        )?;
        for (run, content) in self.runs.iter() {
            if let Some(rms) = content.pressure_rms_pa.both() {
                let [before, after] = rms.map(|pa| pa / 1e3);
                writeln!(
                    f,
                    "{run}: {before:.1} kPa RMS from the recorded pressure before, {after:.1} after"
                )?;
            }
        }
        for note in &self.notes {
            writeln!(f, "{note}")?;
        }
        for refused in &self.refused {
            let [before, after] = refused.evidence.misfit;
            writeln!(
                f,
                "refused: {}: {before:.2} before, {after:.2} after",
                refused.label
            )?;
        }
        for (column, sensor) in &self.noise {
            writeln!(f, "sensor {column}: {sensor}")?;
        }
        Ok(())
    }
}

/// How probable a rival is, and what it leaves.
fn rival(other: &Other) -> String {
    format!("{:.2}, leaves {:.2}", other.probability, other.leaves)
}

/// A value of this SI unit in words; a share is in percent, as a machine file has it.
fn quantity(value: f64, unit: &str) -> String {
    let factor = if unit == "%" { 100.0 } else { 1.0 };
    let text = format!("{} {unit}", number(factor * value));
    text.trim_end().to_owned()
}

/// A number to five digits, with an exponent where zeros would be many.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    match rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) {
        true => format!("{rounded}"),
        false => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_in_percent() {
        assert_eq!(quantity(0.01462, "%"), "1.462 %");
        assert_eq!(quantity(1.78e-8, "m/N"), "1.78e-8 m/N");
        assert_eq!(quantity(1.0, ""), "1");
    }
}
